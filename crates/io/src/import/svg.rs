//! SVG → lines.
//!
//! Paths, lines, polylines, polygons and rectangles, with the transforms above them. Where the map's frame is in
//! the drawing is told by the path that the export put into the layer `frame`; in its absence by the scale of the
//! root or of the user, with the origin of the drawing as that of the map.

use polymapper_core::geometry::Point;
use roxmltree::{Document, Node, ParsingOptions};

use super::ImportOptions;
use super::path_data::pieces;
use super::shapes::{Line, Role, Shapes};
use super::transform::Transform;
use crate::out::{FRAME_ID, POLYLINE_ID, UNIT_ATTRIBUTE};

const MOST_NODES: u32 = 2_000_000;
/// Groups within groups; more are no drawing, and every one is a step on the stack.
const MOST_DEPTH: usize = 256;
const MOST_POINTS: usize = 4_000_000;
/// Curves become lines that keep this near, metres.
const TOLERANCE_M: f64 = 5e-4;

/// Things that hold drawings for later use; nothing in them is part of the drawing.
const NOT_DRAWN: [&str; 8] = [
    "defs",
    "symbol",
    "clipPath",
    "mask",
    "marker",
    "pattern",
    "metadata",
    "namedview",
];
/// Things that say something and draw nothing.
const SILENT: [&str; 5] = ["title", "desc", "style", "script", "g"];

pub(super) fn read(text: &str, options: &ImportOptions) -> Result<Shapes, String> {
    let parsing = ParsingOptions {
        allow_dtd: true,
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, parsing).map_err(|e| format!("no XML: {e}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(format!(
            "the root is <{}>, <svg> is expected",
            root.tag_name().name()
        ));
    }
    let mut shapes = Shapes::default();
    let map_from_drawing = frame(root, options, &mut shapes)?;
    let mut reader = Reader {
        shapes,
        tolerance_m: TOLERANCE_M,
        left: MOST_POINTS,
    };
    reader.group(root, map_from_drawing, Role::Wall, 0)?;
    Ok(reader.shapes)
}

/// The map from the coordinates of the root to those of the map.
fn frame(root: Node<'_, '_>, options: &ImportOptions, shapes: &mut Shapes) -> Result<Transform, String> {
    let mark = root.descendants().find(|n| n.attribute("id") == Some(FRAME_ID));
    if let Some(mark) = mark {
        let in_root = above(mark)?;
        let points = pieces(mark.attribute("d").unwrap_or(""), 1.0, &mut 16)?;
        let points: Vec<Point> = points.iter().flatten().map(|&p| in_root.of(p)).collect();
        let &[x, origin, y] = points.as_slice() else {
            return Err(format!(
                "the path \"{FRAME_ID}\" has {} points, 3 are expected",
                points.len()
            ));
        };
        return Transform::to_frame(origin, x, y)
            .ok_or_else(|| format!("the points of the path \"{FRAME_ID}\" lie on a line: it was flattened"));
    }
    let stated = root.attribute(UNIT_ATTRIBUTE).and_then(|text| text.parse().ok());
    let scale = options
        .metres_per_unit
        .or(stated)
        .filter(|k| k.is_finite() && *k > 0.0);
    let scale = scale.ok_or_else(|| {
        format!(
            "it has no path \"{FRAME_ID}\" that tells where the map is, as exported drawings have; for another drawing give \
             --metres-per-unit"
        )
    })?;
    shapes.notes.push(format!(
        "no path \"{FRAME_ID}\": the origin of the drawing is taken as that of the map, {scale} m a unit"
    ));
    Ok(Transform::new([scale, 0.0, 0.0, -scale, 0.0, 0.0]))
}

/// All transforms from the root down to `node`.
fn above(node: Node<'_, '_>) -> Result<Transform, String> {
    let mut whole = Transform::IDENTITY;
    for n in node.ancestors().filter(|n| n.has_attribute("transform")) {
        whole = transform(n)?.after(whole);
    }
    Ok(whole)
}

fn transform(node: Node<'_, '_>) -> Result<Transform, String> {
    let text = node.attribute("transform").unwrap_or("");
    Transform::parse(text).map_err(|fault| located(node, &fault))
}

fn located(node: Node<'_, '_>, fault: &str) -> String {
    let line = node.document().text_pos_at(node.range().start).row;
    format!("line {line}, <{}>: {fault}", node.tag_name().name())
}

struct Reader {
    shapes: Shapes,
    tolerance_m: f64,
    left: usize,
}

impl Reader {
    /// Goes down at most [`MOST_DEPTH`] groups.
    fn group(
        &mut self,
        group: Node<'_, '_>,
        map_from_group: Transform,
        role: Role,
        depth: usize,
    ) -> Result<(), String> {
        if depth > MOST_DEPTH {
            return Err(format!("groups nested more than {MOST_DEPTH} deep"));
        }
        let role = layer_role(group).unwrap_or(role);
        let map_from_here = map_from_group.after(transform(group)?);
        for node in group.children().filter(Node::is_element) {
            let name = node.tag_name().name();
            if name == "g" || name == "svg" || name == "a" {
                self.group(node, map_from_here, role, depth + 1)?;
            } else if role != Role::Nothing && !NOT_DRAWN.contains(&name) && !SILENT.contains(&name) {
                self.shape(node, map_from_here.after(transform(node)?), role)?;
            }
        }
        Ok(())
    }

    fn shape(&mut self, node: Node<'_, '_>, map_from_shape: Transform, role: Role) -> Result<(), String> {
        let tolerance = self.tolerance_m / map_from_shape.stretch().max(1e-12);
        let pieces = match points(node, tolerance, &mut self.left) {
            Ok(Some(pieces)) => pieces,
            Ok(None) => {
                self.shapes.skip(&format!("<{}>", node.tag_name().name()));
                return Ok(());
            }
            Err(fault) => {
                self.shapes.skip(&located(node, &fault));
                return Ok(());
            }
        };
        // Of a path in several pieces the first keeps the id.
        let mut id = polyline_id(node);
        for piece in pieces {
            let points = piece.iter().map(|&p| map_from_shape.of(p)).collect();
            let line = Line {
                id: id.take(),
                points,
                ..Line::default()
            };
            self.shapes
                .add(role, line)
                .map_err(|fault| located(node, &fault))?;
        }
        Ok(())
    }
}

/// The role of a layer, by its label or id; `None` for a group that is no layer.
fn layer_role(group: Node<'_, '_>) -> Option<Role> {
    const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";
    let label = group.attribute((INKSCAPE, "label"));
    let id = group.attribute("id").and_then(|id| id.strip_prefix("layer-"));
    let roles = [label, id].map(|name| name.map(Role::of_layer));
    roles.into_iter().flatten().find(|&role| role != Role::Wall)
}

fn polyline_id(node: Node<'_, '_>) -> Option<u64> {
    node.attribute("id")?.strip_prefix(POLYLINE_ID)?.parse().ok()
}

/// The pieces of a thing that is made of lines; `None` for another.
fn points(node: Node<'_, '_>, tolerance: f64, left: &mut usize) -> Result<Option<Vec<Vec<Point>>>, String> {
    let number = |name: &str| -> Result<f64, String> {
        let text = node.attribute(name).unwrap_or("0").trim();
        text.parse().map_err(|_| {
            format!(
                "{name}=\"{}\" is no number",
                text.chars().take(20).collect::<String>()
            )
        })
    };
    Ok(Some(match node.tag_name().name() {
        "path" => pieces(node.attribute("d").unwrap_or(""), tolerance, left)?,
        "line" => vec![vec![
            Point::new(number("x1")?, number("y1")?),
            Point::new(number("x2")?, number("y2")?),
        ]],
        "rect" => {
            let (x, y, w, h) = (number("x")?, number("y")?, number("width")?, number("height")?);
            let corner = Point::new;
            vec![vec![
                corner(x, y),
                corner(x + w, y),
                corner(x + w, y + h),
                corner(x, y + h),
                corner(x, y),
            ]]
        }
        "polyline" | "polygon" => {
            let data = format!("M{}", node.attribute("points").unwrap_or(""));
            let end = if node.tag_name().name() == "polygon" {
                "Z"
            } else {
                ""
            };
            pieces(&format!("{data}{end}"), tolerance, left)?
        }
        _ => return Ok(None),
    }))
}
