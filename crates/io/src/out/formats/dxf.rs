//! DXF R12 (AC1009): polylines in metres, y up, a layer for each kind of thing.
//!
//! R12 is what every CAD program reads. Every polyline carries its id as extended data of the application
//! `POLYMAPPER`, which CAD programs keep with the line; `polymapper import` reads it back. Group codes: Autodesk,
//! DXF Reference R12.

use std::io::{self, Write};

use polymapper_core::geometry::Point;

use super::extent::{Extent, corners, drawn};
use super::{ERASER_BOXES, ExportError, Place, Subject, WALLS, WAY};
use crate::out::decimals::rounded_4;

/// Name under which the ids are stored with the lines.
pub(crate) const XDATA_APPLICATION: &str = "POLYMAPPER";

/// Layers with their colours (AutoCAD colour index): white or black, by the background; green; blue.
const LAYERS: [(&str, i32); 3] = [(WALLS, 7), (ERASER_BOXES, 3), (WAY, 5)];

/// `$INSUNITS`: metres.
const METRES: i32 = 6;

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    place.write(0, |f| write_drawing(&mut Tags(f), subject))
}

/// The layer as DXF names it: R12 knows capitals and no spaces.
pub(crate) fn layer_name(layer: &str) -> String {
    layer.to_uppercase().replace(' ', "_")
}

/// Group codes with their values, a line each.
struct Tags<'a, W: Write>(&'a mut W);

impl<W: Write> Tags<'_, W> {
    fn text(&mut self, code: u16, value: &str) -> io::Result<()> {
        write!(self.0, "{code:3}\r\n{value}\r\n")
    }

    fn whole(&mut self, code: u16, value: i32) -> io::Result<()> {
        write!(self.0, "{code:3}\r\n{value:6}\r\n")
    }

    fn point(&mut self, p: Point) -> io::Result<()> {
        for (code, value) in [(10, p.x), (20, p.y), (30, 0.0)] {
            write!(self.0, "{code:3}\r\n{:?}\r\n", rounded_4(value))?;
        }
        Ok(())
    }
}

fn write_drawing<W: Write>(out: &mut Tags<'_, W>, subject: &Subject<'_>) -> io::Result<()> {
    header(out, subject)?;
    tables(out)?;
    out.text(0, "SECTION")?;
    out.text(2, "ENTITIES")?;
    for polyline in &subject.map.polylines {
        let points: Vec<Point> = polyline.vertices.iter().map(|v| v.point).collect();
        line(out, WALLS, &points, false, Some(&format!("id={}", polyline.id)))?;
    }
    for b in &subject.map.eraser_boxes {
        line(out, ERASER_BOXES, &corners(b), true, None)?;
    }
    for piece in subject.way_pieces() {
        line(out, WAY, &piece, false, None)?;
    }
    out.text(0, "ENDSEC")?;
    out.text(0, "EOF")
}

fn header<W: Write>(out: &mut Tags<'_, W>, subject: &Subject<'_>) -> io::Result<()> {
    out.text(0, "SECTION")?;
    out.text(2, "HEADER")?;
    out.text(9, "$ACADVER")?;
    out.text(1, "AC1009")?;
    out.text(9, "$INSUNITS")?;
    out.whole(70, METRES)?;
    let extent = Extent::of(drawn(subject.map));
    let [min, max] = extent.0.unwrap_or([Point::new(0.0, 0.0); 2]);
    out.text(9, "$EXTMIN")?;
    out.point(min)?;
    out.text(9, "$EXTMAX")?;
    out.point(max)?;
    out.text(0, "ENDSEC")
}

fn tables<W: Write>(out: &mut Tags<'_, W>) -> io::Result<()> {
    out.text(0, "SECTION")?;
    out.text(2, "TABLES")?;
    table(out, "LTYPE", 1)?;
    entry(out, "LTYPE", "CONTINUOUS")?;
    out.text(3, "Solid line")?;
    out.whole(72, 65)?;
    out.whole(73, 0)?;
    out.text(40, "0.0")?;
    out.text(0, "ENDTAB")?;
    table(out, "LAYER", 1 + LAYERS.len() as i32)?;
    for (name, colour) in [("0", 7)].into_iter().chain(LAYERS) {
        entry(out, "LAYER", &layer_name(name))?;
        out.whole(62, colour)?;
        out.text(6, "CONTINUOUS")?;
    }
    out.text(0, "ENDTAB")?;
    table(out, "APPID", 2)?;
    entry(out, "APPID", "ACAD")?;
    entry(out, "APPID", XDATA_APPLICATION)?;
    out.text(0, "ENDTAB")?;
    out.text(0, "ENDSEC")
}

fn table<W: Write>(out: &mut Tags<'_, W>, name: &str, entries: i32) -> io::Result<()> {
    out.text(0, "TABLE")?;
    out.text(2, name)?;
    out.whole(70, entries)
}

fn entry<W: Write>(out: &mut Tags<'_, W>, kind: &str, name: &str) -> io::Result<()> {
    out.text(0, kind)?;
    out.text(2, name)?;
    out.whole(70, 0)
}

fn line<W: Write>(
    out: &mut Tags<'_, W>,
    layer: &str,
    points: &[Point],
    closed: bool,
    note: Option<&str>,
) -> io::Result<()> {
    let layer = layer_name(layer);
    out.text(0, "POLYLINE")?;
    out.text(8, &layer)?;
    out.whole(66, 1)?;
    out.point(Point::new(0.0, 0.0))?;
    out.whole(70, i32::from(closed))?;
    if let Some(note) = note {
        out.text(1001, XDATA_APPLICATION)?;
        out.text(1000, note)?;
    }
    for &p in points {
        out.text(0, "VERTEX")?;
        out.text(8, &layer)?;
        out.point(p)?;
    }
    out.text(0, "SEQEND")?;
    out.text(8, &layer)
}
