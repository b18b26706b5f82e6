//! Places of the scanner for a given heading, by voting.
//!
//! In: walls of scan and reference, a heading, a window. Out: translations, best first. Each pair of walls
//! that run alike at this heading votes for the line of translations that puts one on the other,
//! as far as they overlap: walls of different directions cross where the scanner was.

use super::walls::Wall;
use crate::geometry::{Point, Pose, wrap_rad};

/// Size of a cell, metres: the error of direction of a wall (1° to 2°) at a few metres.
const CELL_M: f64 = 0.2;
/// Walls that differ by more than this do not run alike: the error of direction of a side of 0.4 m (4°)
/// twice.
const ALIKE_RAD: f64 = 8.0 * std::f64::consts::PI / 180.0;
/// A pair's vote grows with its overlap up to this, metres. Beyond it the vote is flat, so that sliding along
/// a corridor changes nothing and its doors decide.
const FULL_VOTE_M: f64 = 1.0;
/// Peaks nearer than this are one, in cells (0.4 m): refinement brings them together.
const APART_CELLS: i64 = 2;

/// The translations looked at: a square around a centre.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub centre: Point,
    pub half_m: f64,
}

/// A grid of votes over translations.
struct Votes {
    origin: Point,
    cells: usize,
    votes: Vec<f64>,
}

/// Up to `count` translations with their votes, best first.
pub(super) fn translations(
    scan: &[Wall],
    reference: &[Wall],
    heading_rad: f64,
    window: Window,
    count: usize,
) -> Vec<(Point, f64)> {
    let cells = (2.0 * window.half_m / CELL_M).ceil() as usize + 1;
    let mut votes = Votes {
        origin: window.centre - Point::new(1.0, 1.0) * (0.5 * (cells - 1) as f64 * CELL_M),
        cells,
        votes: vec![0.0; cells * cells],
    };
    let turn = Pose::new(0.0, 0.0, heading_rad);
    for s in scan {
        let a = turn.rotate(s.segment.a);
        let turned_rad = s.bearing_rad + heading_rad;
        for r in reference {
            if wrap_rad(r.bearing_rad - turned_rad).abs() < ALIKE_RAD {
                votes.cast(a, turn.rotate(s.segment.b), r);
            }
        }
    }
    votes.peaks(count)
}

impl Votes {
    /// The vote of a scan's wall from `a` to `b` (turned, not yet shifted) for lying on `wall`.
    fn cast(&mut self, a: Point, b: Point, wall: &Wall) {
        let middle = (a + b) * 0.5;
        let offset_m = wall.normal.dot(wall.segment.a - middle);
        let at_m = wall.direction.dot(middle - wall.segment.a);
        let half_m = 0.5 * wall.direction.dot(b - a).abs();
        // Shifts along the wall at which the two overlap: from end before start to start behind end.
        let (from_m, to_m) = (-half_m - at_m, wall.length_m + half_m - at_m);
        let full_m = wall.length_m.min(2.0 * half_m).min(FULL_VOTE_M);
        // Walk the line of translations cell by cell along its longer axis; share each step across the other.
        let line = wall.normal * offset_m - self.origin;
        let along_x = wall.direction.x.abs() >= wall.direction.y.abs();
        let axis = |p: Point| if along_x { (p.x, p.y) } else { (p.y, p.x) };
        let ((start, start_across), (slope, across)) = (axis(line), axis(wall.direction));
        let (step_m, across) = (CELL_M / slope, across / slope);
        let (low, high) = if slope > 0.0 {
            (from_m, to_m)
        } else {
            (to_m, from_m)
        };
        let first = ((start + slope * low) / CELL_M).ceil().max(0.0) as usize;
        let last = ((start + slope * high) / CELL_M)
            .floor()
            .min(self.cells as f64 - 1.0);
        if last < 0.0 {
            return;
        }
        for k in first..=last as usize {
            let shift_m = (k as f64 - start / CELL_M) * step_m;
            let overlap_m = (shift_m - from_m).min(to_m - shift_m).min(full_m);
            let place = start_across / CELL_M + across * (k as f64 - start / CELL_M);
            if place >= 0.0 && place < (self.cells - 1) as f64 && overlap_m > 0.0 {
                let (cell, share) = (place as usize, place.fract());
                self.add(along_x, k, cell, overlap_m * (1.0 - share));
                self.add(along_x, k, cell + 1, overlap_m * share);
            }
        }
    }

    fn add(&mut self, along_x: bool, along: usize, across: usize, vote: f64) {
        let (column, row) = if along_x { (along, across) } else { (across, along) };
        self.votes[row * self.cells + column] += vote;
    }

    fn peaks(&self, count: usize) -> Vec<(Point, f64)> {
        let n = self.cells as i64;
        let mut order: Vec<usize> = (0..self.votes.len()).filter(|&k| self.votes[k] > 0.0).collect();
        order.sort_by(|&a, &b| self.votes[b].total_cmp(&self.votes[a]).then(a.cmp(&b)));
        let mut kept: Vec<(i64, i64)> = Vec::new();
        let mut peaks = Vec::new();
        for cell in order {
            if kept.len() >= count {
                break;
            }
            let (column, row) = (cell as i64 % n, cell as i64 / n);
            if kept
                .iter()
                .all(|&(c, r)| (c - column).abs().max((r - row).abs()) > APART_CELLS)
            {
                kept.push((column, row));
                let place = self.origin + Point::new(column as f64, row as f64) * CELL_M;
                peaks.push((place, self.votes[cell]));
            }
        }
        peaks
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polyline;
    use crate::matching::walls::walls_of;

    #[test]
    fn walls_of_two_directions_meet_where_the_scanner_was() {
        let points = [(3.0, -2.0), (3.0, 2.0), (-1.0, 2.0)];
        let room = Polyline::new(points.iter().map(|&(x, y)| Point::new(x, y)).collect()).unwrap();
        let truth = Pose::new(0.9, -0.5, 0.7);
        let scan = walls_of(&[room.transformed(truth.inverse())]);
        let window = Window {
            centre: Point::default(),
            half_m: 3.0,
        };
        let found = translations(&scan, &walls_of(&[room]), truth.theta_rad, window, 5);
        assert!(found[0].0.distance(truth.translation()) < CELL_M, "{found:?}");
        assert!(found.len() > 1 && found[0].1 > 1.2 * found[1].1);
    }
}
