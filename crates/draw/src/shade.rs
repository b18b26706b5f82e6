//! The pale side of the walls.
//!
//! In: the map. Out: a layer to lie under the walls. Polylines have free space on their left, so their right is
//! solid: a band runs along it, and an object that the scanner has gone round (a closed line, clockwise) is
//! filled. It shows at a glance which side of a line has been seen.

use polymapper_core::geometry::{Point, Polyline};
use polymapper_core::map::Map;

use crate::colour::palette;
use crate::scene::{Layer, Mark, Stroke};

/// Width of the band, in widths of a wall.
const BAND_WIDTHS: f64 = 3.2;
/// Ends this close, or a twentieth of the length, close a line.
const CLOSED_WITHIN_M: f64 = 0.3;

/// The solid sides of all walls of a map drawn `wall_px` wide.
pub(crate) fn shade(map: &Map, wall_px: f64, metres_per_px: f64) -> Layer {
    let mut layer = Layer::new("not free");
    let band = Stroke::new(palette::SHADE, BAND_WIDTHS * wall_px).with_flat_ends();
    let shift_m = 0.5 * band.width_px * metres_per_px;
    for polyline in map.polylines.iter().filter_map(|p| p.polyline()) {
        if is_island(&polyline) {
            let corners = polyline.vertices().to_vec();
            layer.marks.push(Mark::Polygon {
                corners,
                colour: palette::SHADE,
            });
        } else {
            layer.line(shifted_right(polyline.vertices(), shift_m), band);
        }
    }
    layer
}

/// Whether the line closes round something solid.
fn is_island(polyline: &Polyline) -> bool {
    let gap_m = polyline.first().distance(polyline.last());
    let twice_area: f64 =
        polyline.sides().map(|s| s.a.cross(s.b)).sum::<f64>() + polyline.last().cross(polyline.first());
    gap_m < CLOSED_WITHIN_M.min(0.05 * polyline.length_m()) && twice_area < 0.0
}

/// The line moved to its right; at a vertex along the mean of both sides' normals, at most twice as far.
fn shifted_right(vertices: &[Point], by_m: f64) -> Vec<Point> {
    let normal = |k: usize| {
        let (a, b) = (vertices.get(k)?, vertices.get(k + 1)?);
        Some(-(*b - *a).unit()?.left())
    };
    let shift = |k: usize| {
        let before = k.checked_sub(1).and_then(normal);
        let after = normal(k);
        let (Some(before), Some(after)) = (before.or(after), after.or(before)) else {
            return Point::default();
        };
        let mean = (before + after).unit().unwrap_or(after);
        mean * (by_m / mean.dot(after).max(0.5))
    };
    vertices.iter().enumerate().map(|(k, p)| *p + shift(k)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polyline(corners: &[(f64, f64)]) -> Polyline {
        Polyline::new(corners.iter().map(|(x, y)| Point::new(*x, *y)).collect()).unwrap()
    }

    #[test]
    fn the_band_lies_on_the_right() {
        let wall = polyline(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]);
        let band = shifted_right(wall.vertices(), 0.1);
        let wanted = [Point::new(0.0, -0.1), Point::new(2.1, -0.1), Point::new(2.1, 2.0)];
        assert!(
            band.iter().zip(wanted).all(|(a, b)| a.distance(b) < 1e-9),
            "{band:?}"
        );
    }

    #[test]
    fn the_band_of_a_wall_that_turns_back_stays_near() {
        let spike = polyline(&[(0.0, 0.0), (1.0, 0.0), (0.0, 0.0), (0.0, 0.0)]);
        let band = shifted_right(spike.vertices(), 0.1);
        assert!(
            band.iter()
                .zip(spike.vertices())
                .all(|(a, b)| a.distance(*b) < 0.21),
            "{band:?}"
        );
    }

    #[test]
    fn a_pillar_is_filled_and_a_room_is_not() {
        let pillar = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0)];
        let room: Vec<(f64, f64)> = pillar.iter().rev().copied().collect();
        assert!(is_island(&polyline(&pillar)));
        assert!(!is_island(&polyline(&room)));
        assert!(!is_island(&polyline(&pillar[..4])));
    }
}
