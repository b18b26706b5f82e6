//! All poses of a map from which a scan may have been taken, without a guess.
//!
//! In: points of a scan with the direction of their sides, the field of a map. Out: distinct poses, best first. The score
//! of a pose is the mean of the field over the points. Bounds are summed for every block of places at every heading, and
//! the best blocks are divided first (branch and bound; Olson 2009; Hess et al. 2016), so that nothing better is missed.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use super::field::{Field, FieldPoint};
use crate::geometry::{Point, Pose, wrap_rad};

/// Headings tried: 1.5° apart, points at 4 m move by a cell.
const HEADINGS: usize = 240;
/// Poses nearer than this in place and heading are the same answer.
const SAME_M: f64 = 0.5;
const SAME_RAD: f64 = 0.18;
/// Blocks divided before the search gives up on more answers: bounds the time where everything looks alike.
const MOST_DIVIDED: usize = 60_000;
/// Coarse blocks that are taken up at a time, best first.
const BATCH: u32 = 4_000;

/// What is looked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Distinct poses.
    pub poses: usize,
    /// Smallest score, 0..=1,
    pub min_score: f64,
    /// and how far below the best one.
    pub below_best: f64,
}

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
    level: u32,
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

/// Distinct poses, best first. At most 257 points: sums must fit 16 bits.
pub(super) fn search(field: &Field, points: &[(Point, Point)], wanted: &Wanted) -> Vec<Candidate> {
    if points.is_empty() {
        return Vec::new();
    }
    let turned: Vec<Vec<FieldPoint>> = (0..HEADINGS).map(|k| turn(field, points, k)).collect();
    let mut hunt = Hunt::new(field, &turned, points.len(), wanted);
    let coarse = Coarse::new(field, &turned);
    let mut above = u32::MAX;
    while above > hunt.least && !hunt.is_done() {
        let from = coarse.next_batch(above).max(hunt.least);
        coarse.for_each(from, above, |block| hunt.queue.push(block));
        hunt.run(from);
        above = from;
    }
    hunt.found
}

/// Bounds of all coarsest blocks at all headings.
struct Coarse<'a> {
    field: &'a Field,
    /// Heading by heading, row by row.
    bounds: Vec<u16>,
    /// How many there are of each bound / 64.
    counts: Vec<u32>,
}

const BIN: u32 = 64;

impl<'a> Coarse<'a> {
    fn new(field: &'a Field, turned: &[Vec<FieldPoint>]) -> Self {
        let mut bounds = Vec::with_capacity(turned.len() * field.blocks.0 * field.blocks.1);
        let mut counts = vec![0; (u32::from(u16::MAX) / BIN) as usize + 1];
        let mut sums = Vec::new();
        for points in turned {
            field.sum_coarsest(points, &mut sums);
            for &sum in &sums {
                counts[(u32::from(sum) / BIN) as usize] += 1;
            }
            bounds.extend_from_slice(&sums);
        }
        Self {
            field,
            bounds,
            counts,
        }
    }

    /// The bound from which on there are [`BATCH`] blocks below `above`, or a few more.
    fn next_batch(&self, above: u32) -> u32 {
        let mut bin = (above.div_ceil(BIN) as usize).min(self.counts.len());
        let mut count = 0;
        while bin > 0 && count < BATCH {
            bin -= 1;
            count += self.counts[bin];
        }
        bin as u32 * BIN
    }

    /// The blocks with a bound in `from..above`.
    fn for_each(&self, from: u32, above: u32, mut each: impl FnMut(Block)) {
        let (columns, rows) = self.field.blocks;
        for (k, &bound) in self.bounds.iter().enumerate() {
            let bound = u32::from(bound);
            if bound < from || bound >= above {
                continue;
            }
            let (heading, place) = (k / (columns * rows), k % (columns * rows));
            each(Block {
                bound,
                level: self.field.top,
                heading,
                x: ((place % columns) << self.field.top) as i32,
                y: ((place / columns) << self.field.top) as i32,
            });
        }
    }
}

struct Hunt<'a> {
    field: &'a Field,
    turned: &'a [Vec<FieldPoint>],
    wanted: &'a Wanted,
    /// Sum of a perfect score.
    most: u32,
    /// Sum below which a block is not worth keeping.
    least: u32,
    queue: BinaryHeap<Block>,
    divided: usize,
    found: Vec<Candidate>,
}

impl<'a> Hunt<'a> {
    fn new(field: &'a Field, turned: &'a [Vec<FieldPoint>], points: usize, wanted: &'a Wanted) -> Self {
        let most = 255 * points as u32;
        Self {
            field,
            turned,
            wanted,
            most,
            least: (wanted.min_score * f64::from(most)) as u32,
            queue: BinaryHeap::new(),
            divided: 0,
            found: Vec::new(),
        }
    }

    fn is_done(&self) -> bool {
        self.found.len() >= self.wanted.poses || self.divided > MOST_DIVIDED
    }

    /// Goes on until no block is left with a bound of `from` or more.
    fn run(&mut self, from: u32) {
        while !self.is_done() && self.queue.peek().is_some_and(|b| b.bound >= from.max(self.least)) {
            let Some(block) = self.queue.pop() else { return };
            let pose = self.pose_of(&block);
            let size_m = f64::from((1 << block.level) - 1) * self.field.cell_m;
            if self
                .found
                .iter()
                .any(|c| is_same(c, pose, size_m * std::f64::consts::SQRT_2))
            {
                continue;
            }
            if block.level == 0 {
                self.take(pose, block.bound);
            } else {
                self.divided += 1;
                self.divide(&block);
            }
        }
    }

    fn take(&mut self, map_from_scan: Pose, sum: u32) {
        let score = f64::from(sum) / f64::from(self.most);
        if self.found.is_empty() {
            let least = ((score - self.wanted.below_best) * f64::from(self.most)) as u32;
            self.least = self.least.max(least);
        }
        self.found.push(Candidate { map_from_scan, score });
    }

    fn divide(&mut self, block: &Block) {
        let level = block.level - 1;
        let step = 1 << level;
        let points = &self.turned[block.heading];
        for (dx, dy) in [(0, 0), (step, 0), (0, step), (step, step)] {
            let (x, y) = (block.x + dx, block.y + dy);
            let bound = points
                .iter()
                .map(|p| self.field.value(level, p.sector, x + p.x, y + p.y))
                .sum();
            if bound >= self.least {
                self.queue.push(Block {
                    bound,
                    level,
                    heading: block.heading,
                    x,
                    y,
                });
            }
        }
    }

    fn pose_of(&self, block: &Block) -> Pose {
        Pose::new(
            self.field.origin.x + f64::from(block.x) * self.field.cell_m,
            self.field.origin.y + f64::from(block.y) * self.field.cell_m,
            heading_rad(block.heading),
        )
    }
}

fn turn(field: &Field, points: &[(Point, Point)], heading: usize) -> Vec<FieldPoint> {
    let heading = Pose::new(0.0, 0.0, heading_rad(heading));
    points
        .iter()
        .map(|&(p, direction)| FieldPoint::new(heading.rotate(p), heading.rotate(direction), field.cell_m))
        .collect()
}

fn heading_rad(heading: usize) -> f64 {
    heading as f64 * std::f64::consts::TAU / HEADINGS as f64
}

/// Whether a whole block that begins at `pose` and is `size_m` across is the same answer as `found`.
fn is_same(found: &Candidate, pose: Pose, size_m: f64) -> bool {
    let other = found.map_from_scan;
    wrap_rad(other.theta_rad - pose.theta_rad).abs() < SAME_RAD && other.distance(pose) + size_m < SAME_M
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Segment;

    fn room() -> Vec<Segment> {
        let corners = [
            (0.0, 0.0),
            (5.0, 0.0),
            (5.0, 3.0),
            (2.0, 3.0),
            (2.0, 4.0),
            (0.0, 4.0),
            (0.0, 0.0),
        ];
        corners
            .windows(2)
            .map(|w| Segment::new(Point::new(w[0].0, w[0].1), Point::new(w[1].0, w[1].1)))
            .collect()
    }

    fn seen_from(map_from_scan: Pose) -> Vec<(Point, Point)> {
        let scan_from_map = map_from_scan.inverse();
        let at = |side: &Segment, share: f64| scan_from_map * side.at(share);
        room()
            .iter()
            .flat_map(|side| {
                let direction = scan_from_map.rotate(side.direction().unwrap());
                [0.1, 0.4, 0.7, 0.95].map(|share| (at(side, share), direction))
            })
            .collect()
    }

    #[test]
    fn the_best_pose_is_that_of_a_search_without_bounds() {
        let field = Field::new(room().into_iter()).unwrap();
        let points = seen_from(Pose::new(1.3, 1.1, 2.2));
        let wanted = Wanted {
            poses: 1,
            min_score: 0.1,
            below_best: 1.0,
        };
        let best = search(&field, &points, &wanted)[0];
        assert!(
            best.map_from_scan.distance(Pose::new(1.3, 1.1, 2.2)) < 0.2,
            "{best:?}"
        );
        let mut naive = 0;
        for heading in 0..HEADINGS {
            let turned = turn(&field, &points, heading);
            for y in 0..70 {
                for x in 0..80 {
                    let sum = turned
                        .iter()
                        .map(|p| field.value(0, p.sector, x + p.x, y + p.y))
                        .sum();
                    naive = u32::max(naive, sum);
                }
            }
        }
        let naive = f64::from(naive) / (255.0 * points.len() as f64);
        assert!(
            (best.score - naive).abs() < 1e-12,
            "{} against {naive}",
            best.score
        );
    }
}
