//! Plane geometry: points, poses, segments and polylines.
//!
//! Lengths are metres and angles radians, counter-clockwise positive. A pose is
//! named for the frames it joins: `map_from_scan` turns scan coordinates into
//! map coordinates.

mod angle;
mod cell_lists;
mod cells;
mod curve;
pub(crate) mod matrix;
mod point;
mod polyline;
mod pose;
mod segment;
mod side_grid;

pub use angle::wrap_rad;
pub(crate) use curve::Bends;
pub use point::Point;
pub use polyline::{Polyline, PolylineError};
pub use pose::{Isometry, Pose};
pub use segment::Segment;
pub(crate) use side_grid::{Crossing, GridReader, Near, Side, SideGrid};
