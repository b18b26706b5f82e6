//! All poses of a map from which a scan may have been taken, without a guess.
//!
//! In: points of a scan with the direction of their sides, the field of a map. Out: distinct poses, best first. The score
//! of a pose is the mean of the field over the points; best first branch and bound over headings and blocks of
//! places (Olson 2009; Hess et al. 2016), so that nothing better is missed.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::field::{Field, LEVELS, sector};
use crate::geometry::{Point, Pose, wrap_rad};

/// Angle between headings tried, radians (1.5°): points at 4 m move by a cell.
const HEADING_STEP_RAD: f64 = std::f64::consts::TAU / 240.0;
const HEADINGS: usize = 240;
/// Poses nearer than this in place and heading are the same answer.
const SAME_M: f64 = 0.5;
const SAME_RAD: f64 = 0.18;
/// Blocks divided before the search gives up on more answers: bounds the time where everything looks alike.
const MOST_BLOCKS: usize = 150_000;
/// Points between two looks whether a block can still be worth it.
const POINTS_AT_ONCE: usize = 24;

/// A pose and the mean of the field at the scan's points, 0..=1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub map_from_scan: Pose,
    #[cfg_attr(
        not(test),
        expect(
            dead_code,
            reason = "alignment judges anew; tests hold it against the naive search"
        )
    )]
    pub score: f64,
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
        let key = |b: &Self| (b.bound, Reverse((b.level, b.heading, b.x, b.y)));
        key(self).cmp(&key(other))
    }
}

impl PartialOrd for Block {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Cell and sector of every point, turned by a heading, the scanner in cell (0, 0).
type Turned = Vec<(i32, i32, usize)>;

/// Up to `wanted` distinct poses with a score of `min_score` or more, best first.
pub(super) fn search(
    field: &Field,
    points: &[(Point, Point)],
    wanted: usize,
    min_score: f64,
) -> Vec<Candidate> {
    if points.is_empty() {
        return Vec::new();
    }
    let turned: Vec<Turned> = (0..HEADINGS)
        .map(|k| turn(field, points, heading_rad(k)))
        .collect();
    let most = 255 * points.len() as u32;
    let mut hunt = Hunt {
        field,
        turned: &turned,
        least: (min_score * f64::from(most)) as u32,
        queue: BinaryHeap::new(),
    };
    hunt.push_all();
    let mut found: Vec<Candidate> = Vec::new();
    let mut divided = 0;
    while let Some(block) = hunt.queue.pop() {
        if found.len() >= wanted || divided > MOST_BLOCKS {
            break;
        }
        let pose = pose_of(field, &block);
        let size_m = f64::from((1 << block.level) - 1) * field.cell_m;
        if found
            .iter()
            .any(|c| is_same(c, pose, size_m * std::f64::consts::SQRT_2))
        {
            continue;
        }
        if block.level == 0 {
            found.push(Candidate {
                map_from_scan: pose,
                score: f64::from(block.bound) / f64::from(most),
            });
            continue;
        }
        divided += 1;
        hunt.divide(&block);
    }
    found
}

struct Hunt<'a> {
    field: &'a Field,
    turned: &'a [Turned],
    /// Sum of the field below which a block is not worth keeping.
    least: u32,
    queue: BinaryHeap<Block>,
}

impl Hunt<'_> {
    fn push_all(&mut self) {
        let level = LEVELS - 1;
        for heading in 0..HEADINGS {
            for y in (0..self.field.height).step_by(1 << level) {
                for x in (0..self.field.width).step_by(1 << level) {
                    self.push(level, heading, x, y);
                }
            }
        }
    }

    fn divide(&mut self, block: &Block) {
        let level = block.level - 1;
        let step = 1 << level;
        for (dx, dy) in [(0, 0), (step, 0), (0, step), (step, step)] {
            self.push(level, block.heading, block.x + dx, block.y + dy);
        }
    }

    fn push(&mut self, level: usize, heading: usize, x: i32, y: i32) {
        let points = &self.turned[heading];
        let mut bound = 0;
        let mut rest = points.len() as u32;
        for chunk in points.chunks(POINTS_AT_ONCE) {
            bound += chunk
                .iter()
                .map(|&(px, py, sector)| self.field.value(level, sector, x + px, y + py))
                .sum::<u32>();
            rest -= chunk.len() as u32;
            if bound + 255 * rest <= self.least {
                return;
            }
        }
        self.queue.push(Block {
            bound,
            level,
            heading,
            x,
            y,
        });
    }
}

fn turn(field: &Field, points: &[(Point, Point)], heading_rad: f64) -> Turned {
    let heading = Pose::new(0.0, 0.0, heading_rad);
    let cell = |v: f64| (v / field.cell_m).floor() as i32;
    points
        .iter()
        .map(|&(p, direction)| {
            let p = heading.rotate(p);
            (cell(p.x), cell(p.y), sector(heading.rotate(direction)))
        })
        .collect()
}

fn heading_rad(heading: usize) -> f64 {
    heading as f64 * HEADING_STEP_RAD
}

fn pose_of(field: &Field, block: &Block) -> Pose {
    Pose::new(
        field.origin.x + f64::from(block.x) * field.cell_m,
        field.origin.y + f64::from(block.y) * field.cell_m,
        heading_rad(block.heading),
    )
}

/// Whether a whole block that begins at `pose` and is `size_m` across is the same answer as `found`.
fn is_same(found: &Candidate, pose: Pose, size_m: f64) -> bool {
    let other = found.map_from_scan;
    wrap_rad(other.theta_rad - pose.theta_rad).abs() < SAME_RAD && other.distance(pose) + size_m < SAME_M
}
