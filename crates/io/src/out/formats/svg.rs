//! SVG to work on: real measures, a layer for each kind of thing, an id for every line.
//!
//! A unit of the drawing is a millimetre in the building, y down as SVG has it; the page is at 1:100. The layers
//! are Inkscape's (`inkscape:groupmode`), other programs show them as groups. The locked layer `frame` holds two
//! metres, one along each axis of the map: whatever a program does to the page, `polymapper import` finds the
//! frame of the map by them. (The picture that `build` draws is another file: made to be looked at, in the pixels
//! of its page.)

use std::io::{self, Write};

use polymapper_core::geometry::Point;

use super::extent::{Extent, drawn};
use super::{ERASER_BOXES, ExportError, Place, Subject, WALLS, WAY};

/// The id of the path (1 m, 0), (0, 0), (0, 1 m) that shows where the frame of the map is.
pub(crate) const FRAME_ID: &str = "polymapper-frame";
/// How the ids of the map's lines begin; the number of the polyline follows.
pub(crate) const POLYLINE_ID: &str = "polyline-";
/// Attribute of the root: metres in a unit of the drawing.
pub(crate) const UNIT_ATTRIBUTE: &str = "data-metres-per-unit";

const UNITS_PER_METRE: f64 = 1000.0;
/// Millimetres of the page for a metre of the building, at 1:100.
const PAGE_MM_PER_METRE: f64 = 10.0;
/// White round the drawing, metres.
const MARGIN_M: f64 = 1.0;

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    place.write(0, |f| write_drawing(f, subject))
}

fn write_drawing(out: &mut impl Write, subject: &Subject<'_>) -> io::Result<()> {
    root(out, subject)?;
    begin_layer(out, "frame", true)?;
    writeln!(
        out,
        "<path id=\"{FRAME_ID}\" fill=\"none\" stroke=\"#c0392b\" stroke-width=\"20\" d=\"M1000,0 L0,0 L0,-1000\">\
         <title>map frame: 1 m along x and y from the origin; it tells import where the map is</title></path>"
    )?;
    end_layer(out)?;
    begin_layer(out, WAY, true)?;
    for piece in subject.way_pieces() {
        path(out, "", "#2471a3", 20, &piece)?;
    }
    end_layer(out)?;
    begin_layer(out, ERASER_BOXES, false)?;
    for (k, b) in subject.map.eraser_boxes.iter().enumerate() {
        let [x, y] = units(Point::new(b.min.x, b.max.y));
        let [right, bottom] = units(Point::new(b.max.x, b.min.y));
        writeln!(
            out,
            "<rect id=\"eraser-box-{k}\" fill=\"#e67e22\" fill-opacity=\"0.3\" x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\"/>",
            tenths(right - x),
            tenths(bottom - y)
        )?;
    }
    end_layer(out)?;
    begin_layer(out, WALLS, false)?;
    for polyline in &subject.map.polylines {
        let points: Vec<Point> = polyline.vertices.iter().map(|v| v.point).collect();
        path(
            out,
            &format!(" id=\"{POLYLINE_ID}{}\"", polyline.id),
            "#1c1c1c",
            40,
            &points,
        )?;
    }
    end_layer(out)?;
    writeln!(out, "</svg>")
}

fn root(out: &mut impl Write, subject: &Subject<'_>) -> io::Result<()> {
    let way = subject
        .placed_rows()
        .into_iter()
        .map(|row| row.map_from_scan.translation());
    let frame = [Point::new(0.0, 0.0), Point::new(1.0, 1.0)];
    let all = drawn(subject.map).chain(way).chain(frame);
    let [min, max] = Extent::of(all).0.unwrap_or(frame);
    let [left, top] = units(Point::new(min.x - MARGIN_M, max.y + MARGIN_M));
    let [right, bottom] = units(Point::new(max.x + MARGIN_M, min.y - MARGIN_M));
    let (width, height) = (tenths(right - left), tenths(bottom - top));
    let on_page = |units: f64| (units / UNITS_PER_METRE * PAGE_MM_PER_METRE * 100.0).round() / 100.0;
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
         xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\" {UNIT_ATTRIBUTE}=\"{}\" \
         width=\"{}mm\" height=\"{}mm\" viewBox=\"{left} {top} {width} {height}\">",
        1.0 / UNITS_PER_METRE,
        on_page(width),
        on_page(height)
    )?;
    writeln!(
        out,
        "<desc>A map of polymapper at 1:100; a unit is a millimetre in the building. Free space is on the left of every line in its \
         direction. Lines that keep their id keep it in the map.</desc>"
    )
}

fn begin_layer(out: &mut impl Write, label: &str, locked: bool) -> io::Result<()> {
    let locked = if locked {
        " sodipodi:insensitive=\"true\""
    } else {
        ""
    };
    writeln!(
        out,
        "<g id=\"layer-{}\" inkscape:groupmode=\"layer\" inkscape:label=\"{label}\"{locked}>",
        label.replace(' ', "-")
    )
}

fn end_layer(out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "</g>")
}

fn path(out: &mut impl Write, id: &str, colour: &str, width: u32, points: &[Point]) -> io::Result<()> {
    write!(
        out,
        "<path{id} fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" d=\""
    )?;
    for (k, &p) in points.iter().enumerate() {
        let [x, y] = units(p);
        write!(out, "{}{x},{y}", if k == 0 { "M" } else { " L" })?;
    }
    writeln!(out, "\"/>")
}

/// A point of the map in units of the drawing, to 0.1 mm.
fn units(p: Point) -> [f64; 2] {
    [tenths(p.x * UNITS_PER_METRE), tenths(-p.y * UNITS_PER_METRE)]
}

fn tenths(value: f64) -> f64 {
    // Adding 0 turns −0 into 0.
    (value * 10.0).round() / 10.0 + 0.0
}
