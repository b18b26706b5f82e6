//! Drawings of polymapper: the map, and the figures of the paper, as SVG and PNG.
//!
//! What goes in: a [`Scene`] in metres, made by hand or by [`map_picture`] and the functions of [`figures`].
//! What comes out: text ([`to_svg`]) or bytes ([`to_png`]); nothing is written to disk here.
//!
//! Scene (metres, y up) → layout → plate (pixels, y down) → SVG or PNG. Everything that is decided about a
//! picture (scale, clipping, thinning of point clouds, places of labels) is decided once, in the layout; the
//! two writers only spell out the plate, so that SVG and PNG show the same.
//!
//! ```
//! use polymapper_core::geometry::Point;
//! use polymapper_draw::{Layer, Panel, Scene, Stroke, palette, to_png, to_svg};
//!
//! let room = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)].map(|(x, y)| Point::new(x, y));
//! let mut walls = Layer::new("walls");
//! walls.line(room, Stroke::new(palette::INK, 4.0));
//! let scene = Scene::of(Panel::new("").with(walls)).with_caption("A room of 4 m by 3 m.");
//! assert!(to_svg(&scene).starts_with("<svg"));
//! assert!(to_png(&scene)?.starts_with(b"\x89PNG"));
//! # Ok::<(), polymapper_draw::PngError>(())
//! ```

mod bounds;
mod clip;
mod colour;
pub mod figures;
mod font;
mod layout;
mod map_picture;
mod plate;
mod png;
mod round;
mod scene;
mod shade;
mod svg;

pub use bounds::Bounds;
pub use colour::{Colour, palette};
pub use map_picture::{TrajectoryPoint, map_picture};
pub use png::{PngError, to_png};
pub use scene::{
    Dash, Extent, Face, Fill, Grid, Label, Layer, LegendEntry, Mark, Panel, Radius, Sample, ScaleRule, Scene,
    Stroke,
};
pub use svg::to_svg;
