//! What polylines look like from the origin of their frame: the nearest wall in each direction.
//!
//! In: walls seen from the origin. Out: whether the view goes past a point: a wall that a pose puts clearly before the
//! place where the other view ends was looked through.

use std::f64::consts::TAU;

use super::walls::Wall;
use crate::geometry::Point;

const BINS: usize = 360;
const BIN_RAD: f64 = TAU / BINS as f64;
/// A wall must lie this much before the end of the view to count as looked through, metres: twice the reach of
/// a fit, so that what fits badly is not punished twice.
const CLEAR_M: f64 = 0.3;

/// How far the view has been looked through, for each degree.
#[derive(Debug)]
pub(super) struct Outline {
    /// What is nearer than this stands before the nearest wall of a bin and its two neighbours: walls at a grazing angle change
    /// range by metres a degree. Nothing is where the view shows no wall.
    through_m: Vec<f64>,
    /// The farthest of them.
    farthest_m: f64,
}

impl Outline {
    pub fn new(walls: &[Wall]) -> Self {
        let mut ranges_m = vec![f64::INFINITY; BINS];
        for wall in walls {
            let (a, b) = (wall.segment.a.bearing_rad(), wall.segment.b.bearing_rad());
            // The way round that is shorter: a side spans less than half a turn.
            let turn_rad = crate::geometry::wrap_rad(b - a);
            let (from_rad, span_rad) = if turn_rad >= 0.0 {
                (a, turn_rad)
            } else {
                (b, -turn_rad)
            };
            let first = (from_rad / BIN_RAD).floor();
            let count = ((from_rad + span_rad) / BIN_RAD).floor() - first;
            for k in 0..=count as usize {
                let bin = first as i64 + k as i64;
                let middle_rad = ((bin as f64 + 0.5) * BIN_RAD).clamp(from_rad, from_rad + span_rad);
                let direction = Point::from_polar(1.0, middle_rad);
                if let Some((range_m, _)) = wall.segment.meet_ray(Point::default(), direction) {
                    let cell = &mut ranges_m[bin.rem_euclid(BINS as i64) as usize];
                    *cell = cell.min(range_m);
                }
            }
        }
        let around = |k: usize| ranges_m[(k + BINS - 1) % BINS].min(ranges_m[(k + 1) % BINS]);
        let through_m: Vec<f64> = (0..BINS)
            .map(|k| {
                if ranges_m[k].is_finite() {
                    ranges_m[k].min(around(k)) - CLEAR_M
                } else {
                    0.0
                }
            })
            .collect();
        Self {
            farthest_m: through_m.iter().copied().fold(0.0, f64::max),
            through_m,
        }
    }

    /// Whether the view goes past a point: a wall there was looked through.
    pub fn is_through(&self, point: Point) -> bool {
        let range_m = point.norm();
        // The bearing costs more than all the rest.
        range_m < self.farthest_m && {
            let bin = (point.bearing_rad() / BIN_RAD).floor() as i64;
            range_m < self.through_m[bin.rem_euclid(BINS as i64) as usize]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polyline;
    use crate::matching::walls::walls_of;

    #[test]
    fn a_room_ends_the_view_all_round() {
        // Counter-clockwise round the origin, across the ±180° seam.
        let corners = [(2.0, -2.0), (2.0, 2.0), (-3.0, 2.0), (-3.0, -2.0), (2.0, -2.0)];
        let room = Polyline::new(corners.iter().map(|&(x, y)| Point::new(x, y)).collect()).unwrap();
        let outline = Outline::new(&walls_of(&[room]));
        assert!(outline.is_through(Point::new(-1.0, 0.01)));
        assert!(
            !outline.is_through(Point::new(-3.1, -0.01)),
            "where the view ends"
        );
        assert!(!outline.is_through(Point::new(0.0, 5.0)), "behind a wall");
        assert!((0..360).all(|d| outline.is_through(Point::from_polar(1.0, f64::from(d).to_radians()))));
    }

    #[test]
    fn where_nothing_was_seen_nothing_is_known() {
        let wall = Polyline::new(vec![Point::new(2.0, -1.0), Point::new(2.0, 1.0)]).unwrap();
        let outline = Outline::new(&walls_of(&[wall]));
        assert!(!outline.is_through(Point::new(-1.0, 0.0)));
        assert!(outline.is_through(Point::new(1.0, 0.0)));
    }
}
