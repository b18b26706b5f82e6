//! `map.yaml` and `map.pgm` for Nav2's and ROS's `map_server`.
//!
//! | cell | pixel | as `map_server` reads it, `(255 − pixel) / 255` |
//! |---|---|---|
//! | occupied | 0 | 1.0 > `occupied_thresh` 0.65 |
//! | free | 254 | 0.004 ≤ `free_thresh` |
//! | unknown | 205 | 0.19608, between the two: `free_thresh` has to be 0.196, since at Nav2's own default of 0.25 unknown loads as free |
//!
//! The first row of the picture is the topmost. `origin` is the lower left corner of the lower left pixel; its
//! yaw is 0, since many programs do not look at it. The path of the picture is relative to the YAML file.

use std::io::{self, Write};

use super::grid::{Cell, Grid};
use super::{ExportError, Place, Subject};

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let grid = Grid::of(subject, place)?;
    let picture = place.file_name(".pgm");
    // JSON strings are YAML strings: a name with quotes or colons stays one.
    let picture = serde_json::Value::from(picture);
    place.write(1, |f| write_pgm(f, &grid))?;
    place.write(0, |f| {
        writeln!(
            f,
            "image: {picture}\nmode: trinary\nresolution: {}\norigin: [{}, {}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
             free_thresh: 0.196",
            grid.resolution_m,
            corner(grid.origin.x),
            corner(grid.origin.y)
        )
    })
}

/// The multiple of the resolution without the last digits of its product.
fn corner(value: f64) -> String {
    format!("{:?}", (value * 1e6).round() / 1e6 + 0.0)
}

fn write_pgm(out: &mut impl Write, grid: &Grid) -> io::Result<()> {
    write!(out, "P5\n{} {}\n255\n", grid.width, grid.height)?;
    let mut line = vec![0; grid.width];
    for row in (0..grid.height).rev() {
        for (column, pixel) in line.iter_mut().enumerate() {
            *pixel = match grid.at(column, row) {
                Cell::Occupied => 0,
                Cell::Free => 254,
                Cell::Unknown => 205,
            };
        }
        out.write_all(&line)?;
    }
    Ok(())
}
