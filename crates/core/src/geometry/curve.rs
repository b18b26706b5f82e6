//! The curve that sides may stand for: round walls are drawn with sides.
//!
//! In: two sides that meet. Out: how each bends into the other. A side's direction is then that of the curve, turning evenly from
//! side to side, like the smooth shading of polyhedra (Phong 1975). A bend reaches only as far from its vertex as the curve can leave
//! the sides by what they may be off: all along the sides of a round wall, a few centimetres where long walls meet.

use super::Point;

/// Sides lie this far off the curve that they draw at the most, metres: twice what it takes for another side to be drawn in
/// scans of 1 cm noise.
const OFF_CURVE_M: f64 = 0.03;
/// Where two sides turn more than this, they meet in a corner (cosine).
const CURVE_MIN_COS: f64 = 0.8;

/// How a side bends at its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Bends {
    start: Bend,
    end: Bend,
}

/// How it bends at one of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bend {
    /// Sine of the angle from the side to the curve at the vertex, counter-clockwise.
    tilt: f64,
    /// Distance from the vertex up to which the curve is off the side's direction, metres.
    reach_m: f64,
}

impl Bends {
    /// Bends the end of `before` and the start of `behind`, sides that meet there: their unit directions and lengths in metres.
    pub fn join(before: (&mut Self, Point, f64), behind: (&mut Self, Point, f64)) {
        let turn = before.1.cross(behind.1);
        if turn == 0.0 || before.1.dot(behind.1) < CURVE_MIN_COS {
            return;
        }
        let most_m = 4.0 * OFF_CURVE_M / turn.abs();
        let (before_m, behind_m) = (most_m.min(0.5 * before.2), most_m.min(0.5 * behind.2));
        let tilt_per_m = turn / (before_m + behind_m);
        before.0.end = Bend {
            tilt: tilt_per_m * before_m,
            reach_m: before_m,
        };
        behind.0.start = Bend {
            tilt: -tilt_per_m * behind_m,
            reach_m: behind_m,
        };
    }

    /// The direction of the curve at a share 0..=1 of a side, which has this `direction` and length.
    pub fn along(&self, direction: Point, length_m: f64, share: f64) -> Point {
        let tilt = self.start.tilt_at(share * length_m) + self.end.tilt_at((1.0 - share) * length_m);
        if tilt == 0.0 {
            return direction;
        }
        direction * (1.0 - tilt * tilt).sqrt() + direction.left() * tilt
    }

    /// How much wall tells the direction of a side of this length: where it bends, its neighbours do so, too, metres.
    pub fn told_by_m(&self, length_m: f64) -> f64 {
        length_m + self.start.reach_m + self.end.reach_m
    }
}

impl Bend {
    fn tilt_at(&self, from_vertex_m: f64) -> f64 {
        if from_vertex_m < self.reach_m {
            self.tilt * (1.0 - from_vertex_m / self.reach_m)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The directions along sides, told every 5 % of each.
    fn directions(corners: &[Point]) -> Vec<(Point, Point)> {
        let straight: Vec<(Point, Point, f64)> = corners
            .windows(2)
            .map(|pair| {
                let side = pair[1] - pair[0];
                (pair[0], side * (1.0 / side.norm()), side.norm())
            })
            .collect();
        let mut bends = vec![Bends::default(); straight.len()];
        for k in 1..straight.len() {
            let (before, behind) = bends.split_at_mut(k);
            let (a, b) = (straight[k - 1], straight[k]);
            Bends::join((&mut before[k - 1], a.1, a.2), (&mut behind[0], b.1, b.2));
        }
        let at = |k: usize, share: f64| {
            let (start, direction, length_m) = straight[k];
            (
                start + direction * (share * length_m),
                bends[k].along(direction, length_m, share),
            )
        };
        (0..straight.len())
            .flat_map(|k| (0..=20).map(move |i| (k, f64::from(i) / 20.0)))
            .map(|(k, share)| at(k, share))
            .collect()
    }

    #[test]
    fn the_sides_of_a_round_wall_have_the_directions_of_the_circle() {
        for (radius_m, side_m) in [(2.5, 0.6), (11.0, 1.2)] {
            // Some sides are half as long again as others.
            let bearing_rad = |k: i32| (f64::from(k) + 0.2 * f64::from(k % 2)) * side_m / radius_m;
            let corners: Vec<Point> = (0..8)
                .map(|k| Point::from_polar(radius_m, bearing_rad(k)))
                .collect();
            let (first, last) = (bearing_rad(1), bearing_rad(6));
            let told = directions(&corners);
            let inner = told
                .iter()
                .filter(|(at, _)| (first..last).contains(&at.bearing_rad()));
            for (at, direction) in inner {
                let off = at.unit().unwrap().dot(*direction).abs();
                // The side itself is off by up to half of what it turns.
                assert!(off < 0.12 * side_m / radius_m, "{off} rad off at {at:?}");
            }
        }
    }

    #[test]
    fn long_walls_keep_their_directions_but_where_they_meet_and_corners_altogether() {
        let bent = [
            Point::new(-5.0, 0.0),
            Point::new(0.0, 0.0),
            Point::from_polar(5.0, 0.3),
        ];
        for (at, direction) in directions(&bent) {
            let straight = if at.x <= 0.0 { 0.0 } else { 0.3 };
            let is_near = at.norm() < 0.42;
            assert!(
                is_near || (direction.bearing_rad() - straight).abs() < 1e-9,
                "{at:?}"
            );
        }
        let corner = [Point::new(-0.5, 0.0), Point::new(0.0, 0.0), Point::new(0.0, 0.5)];
        for (_, direction) in directions(&corner) {
            assert!(direction.x * direction.y == 0.0, "{direction:?}");
        }
    }
}
