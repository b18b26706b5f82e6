//! `polylines.jsonl`: the polylines of every scan, one JSON object a line.

use std::io::{self, Write};

use polymapper_core::geometry::Polyline;
use serde::Serialize;

use super::decimals::rounded_5;

#[derive(Serialize)]
struct Record {
    scan: usize,
    polylines: Vec<Vec<[f64; 2]>>,
}

/// Writes `{"scan": k, "polylines": [[[x, y], ..], ..]}` and a line end; metres, laser frame, 5 decimals.
///
/// # Errors
/// Those of `out`.
pub fn write_polylines<'a>(
    out: &mut impl Write,
    scan: usize,
    polylines: impl IntoIterator<Item = &'a Polyline>,
) -> io::Result<()> {
    let vertices = |p: &Polyline| {
        p.vertices()
            .iter()
            .map(|v| [rounded_5(v.x), rounded_5(v.y)])
            .collect()
    };
    let record = Record {
        scan,
        polylines: polylines.into_iter().map(vertices).collect(),
    };
    serde_json::to_writer(&mut *out, &record)?;
    writeln!(out)
}
