//! `map.json`: the map as text that people and programs can read.
//!
//! In goes a [`Map`], out comes JSON with one polyline a line, so that two maps can be compared line by line.

use std::io::{self, Write};

use polymapper_core::geometry::Point;
use polymapper_core::map::{Map, MapPolyline};
use serde::{Deserialize, Serialize};

use super::decimals::{rounded_4, rounded_5};

/// Value of the field `format`.
pub const MAP_FORMAT: &str = "polymapper-map";
/// Version of the format that is written, and the newest that is read.
pub const MAP_VERSION: u64 = 1;
const FRAME: &str = "laser of the first placed scan: x ahead, y left";

/// A map and what is known about how it came to be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapFile {
    /// Walls, objects and eraser boxes.
    pub map: Map,
    /// Why the map does not hold the whole log; `None` when it does.
    pub partial: Option<String>,
    /// How far the frame was turned so that walls lie along the axes: the heading of the first placed scan, radians.
    pub turned_rad: f64,
}

#[derive(Serialize, Deserialize)]
pub(super) struct PolylineRecord {
    pub id: u64,
    pub vertices: Vec<[f64; 2]>,
    #[serde(default)]
    pub observations: Vec<u32>,
    /// `null` where it is not known.
    #[serde(default)]
    pub sigma_m: Vec<Option<f64>>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct BoxRecord {
    pub min: [f64; 2],
    pub max: [f64; 2],
}

/// Writes the map.
///
/// # Errors
/// Those of `out`.
pub fn write_map(out: &mut impl Write, file: &MapFile) -> io::Result<()> {
    writeln!(
        out,
        "{{\"format\": \"{MAP_FORMAT}\",\n\"version\": {MAP_VERSION},"
    )?;
    writeln!(
        out,
        "\"generator\": \"polymapper {}\",",
        env!("CARGO_PKG_VERSION")
    )?;
    writeln!(
        out,
        "\"frame\": {},\n\"units\": \"m\",",
        serde_json::to_string(FRAME)?
    )?;
    if file.turned_rad != 0.0 {
        writeln!(out, "\"turned_rad\": {},", (file.turned_rad * 1e6).round() / 1e6)?;
    }
    writeln!(out, "\"partial\": {},", serde_json::to_string(&file.partial)?)?;
    let polylines = file.map.polylines.iter().map(polyline_record);
    write_array(out, "polylines", polylines)?;
    writeln!(out, ",")?;
    let boxes = file.map.eraser_boxes.iter().map(|b| BoxRecord {
        min: pair(b.min),
        max: pair(b.max),
    });
    write_array(out, "eraser_boxes", boxes)?;
    writeln!(out, "}}")
}

/// `"name": [..]` with one item a line.
fn write_array<T: Serialize>(
    out: &mut impl Write,
    name: &str,
    items: impl Iterator<Item = T>,
) -> io::Result<()> {
    write!(out, "\"{name}\": [")?;
    for (k, item) in items.enumerate() {
        out.write_all(if k == 0 { b"\n" } else { b",\n" })?;
        serde_json::to_writer(&mut *out, &item)?;
    }
    write!(out, "]")
}

fn polyline_record(polyline: &MapPolyline) -> PolylineRecord {
    let vertices = &polyline.vertices;
    PolylineRecord {
        id: polyline.id,
        vertices: vertices.iter().map(|v| pair(v.point)).collect(),
        observations: vertices.iter().map(|v| v.observations).collect(),
        sigma_m: vertices
            .iter()
            .map(|v| v.sigma_m.is_finite().then(|| rounded_5(v.sigma_m)))
            .collect(),
    }
}

fn pair(p: Point) -> [f64; 2] {
    [rounded_4(p.x), rounded_4(p.y)]
}
