//! Ends of polylines drawn out by a hair.
//!
//! An end point on its own ray is hit by that ray or missed by it, as rounding has it. A hundredth of the beam step further
//! (2 mm at 10 m and 1°), every beam hits the side that it measured.

use crate::geometry::Point;

/// How far, in beam steps.
const OVERHANG_STEPS: f64 = 0.01;

/// Draws out both ends of a chain of vertices along their sides. A side that points nearly at the scanner is
/// lengthened by no more than ten times what a side square to the beam is.
pub(super) fn draw_out(vertices: &mut [Point], step_rad: f64) {
    let n = vertices.len();
    if n < 2 {
        return;
    }
    vertices[0] = beyond(vertices[0], vertices[1], -OVERHANG_STEPS * step_rad);
    vertices[n - 1] = beyond(vertices[n - 1], vertices[n - 2], OVERHANG_STEPS * step_rad);
}

/// Where the side to `end` from `inner` meets the ray through `end` turned by `turn_rad`.
fn beyond(end: Point, inner: Point, turn_rad: f64) -> Point {
    let side = end - inner;
    let ray = end + end.left() * turn_rad;
    // end + t · side is on the ray where (end + t · side) × ray = 0.
    let t = -end.cross(ray) / side.cross(ray);
    let longest = 10.0 * end.norm() * turn_rad.abs() / side.norm();
    if t.is_finite() && t > 0.0 {
        end + side * t.min(longest)
    } else {
        end
    }
}
