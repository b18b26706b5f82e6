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
