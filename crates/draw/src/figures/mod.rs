//! The figures of the paper, drawn from the products of the pipeline.
//!
//! Each function takes plain data (points, poses, polylines) and gives a [`Scene`](crate::Scene) with the
//! numbers in its caption.

mod correspondence;
mod levels;
mod overview;
mod vertex_rule;

pub use correspondence::{Apart, correspondence};
pub use levels::{Stage, levels};
pub use overview::{Overlay, Overview, overview};
pub use vertex_rule::{VertexRule, vertex_rule};

use polymapper_core::geometry::{Point, Polyline};

use crate::colour::{Colour, palette};
use crate::scene::{Layer, Stroke};

/// Lines with a dot at every vertex.
fn polylines<'a>(
    name: &str,
    polylines: impl IntoIterator<Item = &'a Polyline>,
    stroke: Stroke,
    dot: Colour,
) -> Layer {
    let mut layer = Layer::new(name);
    let mut vertices = Vec::new();
    for polyline in polylines {
        layer.line(polyline.vertices().iter().copied(), stroke);
        vertices.extend_from_slice(polyline.vertices());
    }
    layer.dots(vertices, 1.2 * stroke.width_px, dot);
    layer
}

/// A cross and ring where the scanner stands.
fn scanner(at: Point) -> Layer {
    let mut layer = Layer::new("scanner");
    layer.marker(at, 8.0, palette::WHITE, Stroke::new(palette::VERMILION, 2.5));
    layer.marker(at, 2.2, palette::VERMILION, Stroke::new(palette::VERMILION, 1.0));
    layer
}
