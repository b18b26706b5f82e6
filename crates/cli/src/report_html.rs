//! `report.html`: the figures of a build with sizes to compare with, put into the page.

use std::io::Write;
use std::path::Path;

use polymapper_core::map::Map;
use polymapper_io::out::{AtomicFile, Report};
use polymapper_view::report_page::report_html;
use serde_json::{Value, json};

use crate::record::Recorded;
use crate::scans::short_name;

/// Name of the file.
pub const FILE: &str = "report.html";

/// Side of a cell of the grid that the map is compared with, metres.
const CELL_M: f64 = 0.05;
/// Two numbers of 32 bits.
const POINT_BYTES: usize = 8;

/// Writes the report. `returns` is how many points all scans hold together.
pub fn write(
    folder: &Path,
    report: &Report,
    map: &Map,
    returns: usize,
    recorded: Recorded,
) -> anyhow::Result<()> {
    let mut figures = serde_json::to_value(report)?;
    figures["sizes"] = sizes(map, returns);
    // The report is made to be sent: where the log lay is nobody's business.
    let name = short_name(&report.input.name);
    figures["input"]["name"] = Value::String(name.clone());
    let title = format!("{name} – polymapper");
    let html = report_html(&title, &recorded.0, &figures);
    AtomicFile::write(&folder.join(FILE), |f| f.write_all(html.as_bytes()))?;
    Ok(())
}

/// What the same would take as points, and as a grid.
fn sizes(map: &Map, returns: usize) -> Value {
    let points = || map.polylines.iter().flat_map(|p| &p.vertices).map(|v| v.point);
    let extent_m = |along: fn(&polymapper_core::geometry::Point) -> f64| {
        let (min, max) = points().fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), p| {
            (min.min(along(&p)), max.max(along(&p)))
        });
        (max - min).max(0.0)
    };
    let cells = (extent_m(|p| p.x) / CELL_M).ceil() * (extent_m(|p| p.y) / CELL_M).ceil();
    json!([
        {"name": "5 cm grid, a byte a cell", "bytes": cells as u64,
         "how": "width times height of the map in cells of 5 cm"},
        {"name": "All returns as points", "bytes": returns * POINT_BYTES,
         "how": "two 32-bit numbers a return"},
    ])
}
