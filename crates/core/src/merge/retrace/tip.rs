//! The end of a wall at a gap, and how far it goes on.

use super::returns::Returns;
use crate::extract::Sums;
use crate::geometry::Point;
use crate::merge::growing_map::Vertex;
use crate::merge::on_sides::MIN_COS;

/// Vertices of the straight end that are tried, the longest first.
const COUNTS: [usize; 4] = [8, 6, 4, 3];
/// The vertex next to a gap lies half on what is wrong.
const LEFT_OUT: usize = 1;
/// How far a vertex may lie off a straight end, metres.
const STRAIGHT_M: f64 = 0.012;
/// A straight end is at least this long, metres.
const LEAST_LENGTH_M: f64 = 0.06;
/// Returns that carry a wall on, at the least, and how far apart they may lie beside what each stands for, metres.
const LEAST_RETURNS: usize = 3;
const APART_M: f64 = 0.04;
/// Walls whose lines are no farther apart than this are one wall, metres.
const IN_LINE_M: f64 = 0.1;
/// Sine of the least angle at which two walls meet: 10°.
const LEAST_SINE: f64 = 0.17;
/// Walls meet when neither must be drawn on by more than this beyond its last return, metres.
const BEYOND_M: f64 = 0.1;
/// Nor one be cut by more than this, metres.
const CUT_M: f64 = 0.02;

/// The straight end of a wall.
pub(super) struct Tip {
    /// Where the straight begins that is drawn on.
    from: Point,
    /// Unit vector outwards.
    direction: Point,
    /// How far returns carry it on, metres.
    reach_m: f64,
}

impl Tip {
    /// Of a wall that ends at a gap with its last vertex; `None` when it does not end straight.
    pub fn of(wall: &[Vertex]) -> Option<Self> {
        let rest = &wall[..wall.len().saturating_sub(LEFT_OUT)];
        let ends = COUNTS.iter().filter(|&&count| count <= rest.len());
        ends.map(|&count| &rest[rest.len() - count..]).find_map(fitted)
    }

    /// Finds how far returns carry it on, up to `most_m`, and not where `is_taken` says that something else stands (place, direction).
    pub fn carry_on(
        &mut self,
        returns: &Returns,
        most_m: f64,
        mut is_taken: impl FnMut(Point, Point) -> bool,
    ) {
        let mut reached_m = 0.0;
        let mut count = 0;
        let on_wall = returns.along(self.from, self.direction, most_m);
        for on in on_wall.into_iter().filter(|on| on.runs_along) {
            let is_apart = on.along_m > reached_m + APART_M + on.spread_m;
            if is_apart || is_taken(self.from + self.direction * on.along_m, self.direction) {
                break;
            }
            reached_m = on.along_m;
            count += 1;
        }
        self.reach_m = if count < LEAST_RETURNS { 0.0 } else { reached_m };
    }

    /// Where it ends.
    pub fn end(&self) -> Point {
        self.from + self.direction * self.reach_m
    }

    /// Ends both where they meet when they are in line, head to head.
    pub fn stop_at(&mut self, other: &mut Self) {
        let apart = other.from - self.from;
        let is_in_line =
            self.direction.dot(other.direction) < -MIN_COS && self.direction.cross(apart).abs() < IN_LINE_M;
        if is_in_line {
            let apart_m = self.direction.dot(apart).max(0.0);
            self.reach_m = self.reach_m.min(apart_m);
            other.reach_m = other.reach_m.min(apart_m - self.reach_m);
        }
    }

    /// Draws both up to their corner, if they have one.
    pub fn meets(&mut self, other: &mut Self) -> bool {
        let sine = self.direction.cross(other.direction);
        if sine.abs() < LEAST_SINE {
            return false;
        }
        let apart = other.from - self.from;
        let (mine_m, others_m) = (
            apart.cross(other.direction) / sine,
            apart.cross(self.direction) / sine,
        );
        let is_near = |corner_m: f64, tip: &Self| corner_m > -CUT_M && corner_m < tip.reach_m + BEYOND_M;
        let meet = is_near(mine_m, self) && is_near(others_m, other);
        if meet {
            (self.reach_m, other.reach_m) = (mine_m, others_m);
        }
        meet
    }

    /// Gives the wall its new end.
    pub fn draw_on(&self, wall: &mut Vec<Vertex>, spacing_m: f64) {
        wall.truncate(wall.len() - LEFT_OUT);
        let Some(&last) = wall.last() else { return };
        let pieces = (self.reach_m / spacing_m).ceil().max(0.0) as usize;
        wall.extend((1..=pieces).map(|k| Vertex {
            point: self.from + self.direction * (self.reach_m * k as f64 / pieces as f64),
            ..last
        }));
    }
}

/// The straight through vertices; `None` when they do not lie on one.
fn fitted(end: &[Vertex]) -> Option<Tip> {
    let (first, last) = (end.first()?.point, end.last()?.point);
    // From the first on: far from the map's origin the sums of squares would lose what makes the direction.
    let line = Sums::new(end.iter().map(|v| (v.point - first, 1.0))).perpendicular_line(&(0..end.len()))?;
    let is_straight = end
        .iter()
        .all(|v| line.distance_m(v.point - first).abs() < STRAIGHT_M);
    let along = line.normal.left();
    let is_ahead = along.dot(last - first) >= 0.0;
    (is_straight && first.distance(last) > LEAST_LENGTH_M).then(|| Tip {
        from: first + line.foot(last - first),
        direction: if is_ahead { along } else { along * -1.0 },
        reach_m: 0.0,
    })
}
