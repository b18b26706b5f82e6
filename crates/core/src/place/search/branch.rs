//! Branch and bound over headings and shifts.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::field::{CELL_M, Field, FieldPoint, LEVELS};
use crate::geometry::{Point, Pose, wrap_rad};

/// The poses to search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    /// Middle of the window.
    pub centre: Pose,
    /// Half its width, metres, along x and y.
    pub half_m: f64,
    /// Half its range of headings, radians; π for all.
    pub half_rad: f64,
    /// Distinct poses wanted.
    pub wanted: usize,
    /// Smallest score worth reporting, 0..=1.
    pub min_score: f64,
}

/// A pose and the mean of the field at the scan's points, 0..=1.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub map_from_scan: Pose,
    #[allow(
        dead_code,
        reason = "alignment judges anew; tests hold it against the naive search"
    )]
    pub score: f64,
}

/// Angle between headings tried, radians (1.5°): points at 4 m move by a cell.
const HEADING_STEP_RAD: f64 = 0.026;
/// Poses nearer than this in place and heading are the same answer.
const SAME_M: f64 = 0.5;
const SAME_RAD: f64 = 0.18;
/// Blocks looked at before the search gives up on more answers: bounds the time where everything looks alike.
const MOST_BLOCKS: usize = 60_000;

struct Heading {
    heading_rad: f64,
    /// Turned and moved to the window's centre.
    points: Vec<FieldPoint>,
}

#[derive(PartialEq, Eq)]
struct Block {
    bound: u32,
    level: usize,
    heading: usize,
    x: i32,
    y: i32,
}

impl Ord for Block {
    fn cmp(&self, other: &Self) -> Ordering {
        // Best bound first; then finer blocks; then a fixed order.
        let key = |b: &Self| (b.bound, std::cmp::Reverse((b.level, b.heading, b.x, b.y)));
        key(self).cmp(&key(other))
    }
}

impl PartialOrd for Block {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The best distinct poses of the window, best first. `points`: place and side direction, scan frame.
pub(crate) fn search(field: &Field, points: &[(Point, Point)], window: &Window) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    if points.is_empty() {
        return found;
    }
    let headings = headings(field, points, window);
    let most = 255 * points.len() as u32;
    let least = (window.min_score * f64::from(most)) as u32;
    let half = (window.half_m / CELL_M).ceil() as i32;
    let top = LEVELS - 1;
    let mut hunt = Hunt {
        field,
        headings: &headings,
        half,
        least,
        queue: BinaryHeap::new(),
    };
    for heading in 0..headings.len() {
        for y in (-half..=half).step_by(2 << top) {
            for x in (-half..=half).step_by(2 << top) {
                hunt.divide(top, heading, x, y);
            }
        }
    }
    let mut looked_at = 0;
    while let Some(block) = hunt.queue.pop() {
        looked_at += 1;
        if looked_at > MOST_BLOCKS || found.len() >= window.wanted {
            break;
        }
        let pose = pose_of(&block, &headings, window);
        let size_m = f64::from((1 << block.level) - 1) * CELL_M;
        let same = |c: &Candidate| {
            wrap_rad(c.map_from_scan.theta_rad - pose.theta_rad).abs() < SAME_RAD
                && c.map_from_scan.distance(pose) + size_m * std::f64::consts::SQRT_2 < SAME_M
        };
        if found.iter().any(same) {
            continue;
        }
        if block.level == 0 {
            let near = |c: &Candidate| c.map_from_scan.is_within(SAME_M, SAME_RAD, pose);
            if !found.iter().any(near) {
                found.push(Candidate {
                    map_from_scan: pose,
                    score: f64::from(block.bound) / f64::from(most),
                });
            }
            continue;
        }
        hunt.divide(block.level - 1, block.heading, block.x, block.y);
    }
    found
}

fn headings(field: &Field, points: &[(Point, Point)], window: &Window) -> Vec<Heading> {
    let count = (window.half_rad.min(std::f64::consts::PI) / HEADING_STEP_RAD).ceil() as i32;
    let bearings_rad: Vec<f64> = points.iter().map(|(_, d)| d.bearing_rad()).collect();
    (-count..=count)
        .map(|k| {
            let heading_rad = window.centre.theta_rad + f64::from(k) * HEADING_STEP_RAD;
            let pose = Pose::new(window.centre.x, window.centre.y, heading_rad);
            let (sin, cos) = heading_rad.sin_cos();
            let points = points
                .iter()
                .zip(&bearings_rad)
                .map(|(&(p, _), bearing_rad)| {
                    let turned = Point::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y);
                    field.point(turned + pose.translation(), bearing_rad + heading_rad)
                })
                .collect();
            Heading { heading_rad, points }
        })
        .collect()
}

/// The blocks that wait to be divided.
struct Hunt<'a> {
    field: &'a Field,
    headings: &'a [Heading],
    /// Half the window, cells.
    half: i32,
    /// Bound above which a block is worth keeping.
    least: u32,
    queue: BinaryHeap<Block>,
}

impl Hunt<'_> {
    /// Bounds the four blocks of `level` that make up the block of the level above at (`x`, `y`), and queues those that
    /// are worth it.
    fn divide(&mut self, level: usize, heading: usize, x: i32, y: i32) {
        let bounds = self.field.sum_four(level, &self.headings[heading].points, (x, y));
        let step = 1 << level;
        let places = [(x, y), (x + step, y), (x, y + step), (x + step, y + step)];
        for (bound, (x, y)) in bounds.into_iter().zip(places) {
            if bound > self.least && x <= self.half && y <= self.half {
                self.queue.push(Block {
                    bound,
                    level,
                    heading,
                    x,
                    y,
                });
            }
        }
    }
}

fn pose_of(block: &Block, headings: &[Heading], window: &Window) -> Pose {
    Pose::new(
        window.centre.x + f64::from(block.x) * CELL_M,
        window.centre.y + f64::from(block.y) * CELL_M,
        headings[block.heading].heading_rad,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Segment;

    fn room() -> Vec<Segment> {
        let corners = [
            (-2.0, -2.0),
            (4.0, -2.0),
            (4.0, 3.0),
            (1.0, 3.0),
            (1.0, 2.0),
            (-2.0, 2.0),
            (-2.0, -2.0),
        ];
        corners
            .windows(2)
            .map(|w| Segment::new(Point::new(w[0].0, w[0].1), Point::new(w[1].0, w[1].1)))
            .collect()
    }

    fn seen_from(map_from_scan: Pose) -> Vec<(Point, Point)> {
        let scan_from_map = map_from_scan.inverse();
        let mut out = Vec::new();
        for side in room() {
            let n = (side.length_m() / 0.25) as i32;
            let direction = scan_from_map.rotate(side.direction().unwrap());
            out.extend((0..n).map(|k| {
                (
                    scan_from_map * side.at((f64::from(k) + 0.5) / f64::from(n)),
                    direction,
                )
            }));
        }
        out
    }

    #[test]
    fn a_turned_scan_is_found_without_a_guess() {
        let truth = Pose::new(1.2, -0.7, 2.1);
        let field = Field::new(room().into_iter(), Point::default(), 50.0).unwrap();
        let window = Window {
            centre: Pose::IDENTITY,
            half_m: 2.0,
            half_rad: 3.2,
            wanted: 4,
            min_score: 0.3,
        };
        let found = search(&field, &seen_from(truth), &window);
        let best = found[0];
        assert!(best.map_from_scan.distance(truth) < 0.2, "{best:?}");
        assert!(wrap_rad(best.map_from_scan.theta_rad - truth.theta_rad).abs() < 0.03);
        assert!(found.windows(2).all(|w| w[0].score >= w[1].score));
    }

    #[test]
    fn the_bound_dismisses_nothing_better() {
        let field = Field::new(room().into_iter(), Point::default(), 50.0).unwrap();
        let points = seen_from(Pose::new(0.3, 0.4, 0.5));
        let window = Window {
            centre: Pose::IDENTITY,
            half_m: 1.0,
            half_rad: 0.7,
            wanted: 1,
            min_score: 0.0,
        };
        let best = search(&field, &points, &window)[0];
        let mut naive = 0.0_f64;
        for heading in headings(&field, &points, &window) {
            for x in -10..=10 {
                for y in -10..=10 {
                    let sum: u32 = heading.points.iter().map(|p| field.value(0, p.moved(x, y))).sum();
                    naive = naive.max(f64::from(sum) / (255.0 * points.len() as f64));
                }
            }
        }
        assert!(
            (best.score - naive).abs() < 1e-12,
            "{} against {naive}",
            best.score
        );
    }
}
