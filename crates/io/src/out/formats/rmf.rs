//! Open-RMF `.building.yaml`: one level, a wall for every side of every polyline.
//!
//! `coordinate_system: cartesian_meters`, so that nothing is scaled and y is up, as in the map. Typed values are
//! `[type, value]`: 1 string, 2 whole number, 3 number, 4 truth. A level without a picture has an empty
//! `drawing`.

use std::io::{self, Write};

use super::text::metres;
use super::{ExportError, Place, Subject};

/// What makes a wall opaque, with the plain texture.
const WALL: &str = "{alpha: [3, 1], texture_name: [1, default]}";

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    place.write(0, |f| write_building(f, subject))
}

fn write_building(out: &mut impl Write, subject: &Subject<'_>) -> io::Result<()> {
    let polylines = &subject.map.polylines;
    writeln!(
        out,
        "name: polymapper\ncoordinate_system: cartesian_meters\nlevels:\n  L1:\n    elevation: 0\n    drawing: {{filename: \"\"}}"
    )?;
    begin(out, "vertices", polylines.is_empty())?;
    for polyline in polylines {
        for v in &polyline.vertices {
            writeln!(
                out,
                "      - [{}, {}, 0, \"\"]",
                metres(v.point.x),
                metres(v.point.y)
            )?;
        }
    }
    begin(out, "walls", polylines.is_empty())?;
    let mut first = 0;
    for polyline in polylines {
        let count = polyline.vertices.len();
        for k in first..first + count.saturating_sub(1) {
            writeln!(out, "      - [{k}, {}, {WALL}]", k + 1)?;
        }
        first += count;
    }
    writeln!(out, "lifts: {{}}")
}

fn begin(out: &mut impl Write, name: &str, empty: bool) -> io::Result<()> {
    writeln!(out, "    {name}:{}", if empty { " []" } else { "" })
}
