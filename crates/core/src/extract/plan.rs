//! The vertices of a scan under a budget: which returns carry a vertex, which sides join them, which returns are left out.
//!
//! In: the returns of a whole scan, candidate positions of vertices, a budget. Out: chains of candidates that minimise
//! Σ (range residual)² + (cost of a return in no chain) · (their number), over all groups together, with at most
//! so many vertices. Splitting a chain costs no vertex where two candidates are neighbours, so a jump of the range
//! is free.
//!
//! A side between vertices on beams s and t predicts inverse ranges that are linear in the two inverse ranges x, y of
//! its vertices, hence its squared range residuals (first order in the residual) are a quadratic form of x and y, closed form
//! over prefix sums ([`Sums`]). Dynamic programming over candidates carries, for every number of vertices, the least cost as a
//! parabola of the last vertex's inverse range; minimising over the previous vertex keeps it a parabola. So vertices are not
//! bound to noisy returns (those of Schaefer et al., "A maximum likelihood approach to extract polylines from 2-D laser range
//! scans", IROS 2018, are, until their final optimisation). Only the parabola with the lowest minimum is kept.

use super::fit::{Side, Sums};
use super::front::Front;
use crate::geometry::Point;

/// A chain of positions in the list of returns; neighbours are joined by a side.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    /// Where the vertices are.
    pub(super) vertices: Vec<usize>,
    /// Things in front of its sides (positions in [`Front::things`]): they have chains of their own.
    pub(super) things: Vec<usize>,
}

/// Widest side, radians: a straight side spans less than half a turn.
const WIDEST_SIDE_RAD: f64 = 2.8;

/// The problem.
pub(super) struct Plan<'a> {
    /// All returns, counter-clockwise.
    pub(super) points: &'a [Point],
    /// Their sums for range residuals, weight r².
    pub(super) sums: &'a Sums,
    /// Bearings, radians, rising.
    pub(super) bearings_rad: &'a [f64],
    /// Positions that may carry a vertex, rising.
    pub(super) candidates: &'a [usize],
    /// Things in front of others.
    pub(super) front: &'a Front,
    /// Cost of a return in no chain, m².
    pub(super) unused_m2: f64,
    /// Cost of a side that crosses from return k−1 to k, summed from the start of the list, m².
    pub(super) crossing_m2: &'a [f64],
}

/// Least cost as a function of the inverse range z of the last vertex: least + bend · (z − at)².
#[derive(Clone, Copy, Debug)]
struct Parabola {
    least: f64,
    at: f64,
    bend: f64,
}

const NEVER: Parabola = Parabola {
    least: f64::INFINITY,
    at: 0.0,
    bend: 1.0,
};

/// What is known of a vertex at a candidate, for one number of vertices.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    /// Ends a side; comes from this candidate.
    ended: Parabola,
    from: usize,
    /// Things in front of that side, each with two vertices of its own.
    things: usize,
    /// Begins a chain.
    begun_least: f64,
}

impl Plan<'_> {
    /// The best chains with at most `budget` vertices.
    pub(super) fn solve(&self, budget: usize) -> Vec<Chain> {
        let m = self.candidates.len();
        let width = budget + 1;
        let mut vertices = vec![
            Vertex {
                ended: NEVER,
                from: 0,
                things: 0,
                begun_least: f64::INFINITY,
            };
            m * width
        ];
        // closed[k + 1]: least cost of all returns up to candidate k, no chain open.
        let mut closed = vec![f64::INFINITY; (m + 1) * width];
        closed[..width].fill(0.0);
        for k in 0..m {
            let between = self.unused_m2 * (self.skipped(k)) as f64;
            for v in 1..width {
                vertices[k * width + v].begun_least = closed[k * width + v - 1] + between;
            }
            self.end_sides(k, &mut vertices, width);
            for v in 0..width {
                let dropped = closed[k * width + v] + between + self.unused_m2;
                closed[(k + 1) * width + v] = dropped.min(vertices[k * width + v].ended.least);
            }
        }
        self.trace(&vertices, &closed, width)
    }

    /// Returns between candidate `k` and the one before.
    fn skipped(&self, k: usize) -> usize {
        let before = k.checked_sub(1).map_or(0, |j| self.candidates[j] + 1);
        self.candidates[k] - before
    }

    /// All sides that end at candidate `k`, for every number of vertices.
    fn end_sides(&self, k: usize, vertices: &mut [Vertex], width: usize) {
        let (earlier, here) = vertices.split_at_mut(k * width);
        let t = self.candidates[k];
        let own_bend = self.own_bend(t);
        let own_at = 1.0 / self.points[t].norm();
        for j in (0..k).rev() {
            let s = self.candidates[j];
            if self.bearings_rad[t] - self.bearings_rad[s] > WIDEST_SIDE_RAD {
                break;
            }
            let first = (1.0 / self.points[s].norm(), self.own_bend(s));
            for (side, things) in [self.side(s, t), self.side_behind(s, t)].into_iter().flatten() {
                let spent = 1 + 2 * things;
                for v in 1..width.saturating_sub(spent) {
                    let start = earlier[j * width + v].start(first.0, first.1);
                    let so_far = &mut here[v + spent];
                    if start.least + side.least >= so_far.ended.least {
                        continue;
                    }
                    let ended = through(start, first.0, &side, own_at, own_bend);
                    if ended.least < so_far.ended.least {
                        so_far.ended = ended;
                        so_far.from = j;
                        so_far.things = things;
                    }
                }
            }
        }
    }

    /// Weight of a return's own residual in its inverse range: r⁴.
    fn own_bend(&self, t: usize) -> f64 {
        let r2 = self.points[t].dot(self.points[t]);
        r2 * r2
    }

    /// The side between returns s and t, unless leaving its returns out is cheaper.
    fn side(&self, s: usize, t: usize) -> Option<(Side, usize)> {
        self.side_over(self.sums, s, t, 0.0).map(|side| (side, 0))
    }

    /// The same side behind all things between s and t, with their number.
    fn side_behind(&self, s: usize, t: usize) -> Option<(Side, usize)> {
        let (things, cost_m2) = self.front.between(s, t)?;
        let side = self.side_over(&self.front.behind, s, t, cost_m2)?;
        Some((side, things.len()))
    }

    fn side_over(&self, sums: &Sums, s: usize, t: usize, extra_m2: f64) -> Option<Side> {
        let inner = s + 1..t;
        let extra_m2 = extra_m2 + self.crossing_m2[t] - self.crossing_m2[s];
        let least = sums.range_cost(&inner) + extra_m2;
        if least > self.unused_m2 * inner.len() as f64 {
            return None;
        }
        let mut side = sums.side(self.points[s], self.points[t], &inner)?;
        side.at_returns += extra_m2;
        side.least = least;
        Some(side)
    }

    /// The chains of the least total cost.
    fn trace(&self, vertices: &[Vertex], closed: &[f64], width: usize) -> Vec<Chain> {
        let m = self.candidates.len();
        let mut v = (0..width)
            .min_by(|&a, &b| closed[m * width + a].total_cmp(&closed[m * width + b]))
            .unwrap_or(0);
        let mut chains = Vec::new();
        let mut k = m;
        while k > 0 {
            if closed[k * width + v] < vertices[(k - 1) * width + v].ended.least {
                k -= 1;
                continue;
            }
            let mut at = k - 1;
            let mut chain = Chain::default();
            chain.vertices.push(self.candidates[at]);
            loop {
                let vertex = &vertices[at * width + v];
                let (s, t) = (self.candidates[vertex.from], self.candidates[at]);
                if vertex.things > 0 {
                    chain.things.extend(
                        self.front
                            .between(s, t)
                            .into_iter()
                            .flat_map(|(things, _)| things),
                    );
                }
                v -= 1 + 2 * vertex.things;
                at = vertex.from;
                chain.vertices.push(s);
                if vertices[at * width + v].begins() {
                    break;
                }
            }
            v -= 1;
            k = at;
            chain.vertices.reverse();
            chains.push(chain);
        }
        chains.reverse();
        chains
    }
}

impl Vertex {
    /// Whether beginning a chain here is cheaper than ending a side here.
    fn begins(&self) -> bool {
        self.begun_least < self.ended.least
    }

    /// What a further side starts from; `at` and `bend` of the vertex's own residual.
    fn start(&self, at: f64, bend: f64) -> Parabola {
        if self.begins() {
            Parabola {
                least: self.begun_least,
                at,
                bend,
            }
        } else {
            self.ended
        }
    }
}

/// Carries a parabola over a side: minimum over the inverse range of its first vertex, plus the own residual of its last.
fn through(start: Parabola, first_at: f64, side: &Side, last_at: f64, last_bend: f64) -> Parabola {
    // x, y: deviations of the two inverse ranges from the measured ones.
    let start_x = start.at - first_at;
    let xx = start.bend + side.xx;
    let x0 = side.x - start.bend * start_x;
    let constant = start.least + start.bend * start_x * start_x + side.at_returns - x0 * x0 / xx;
    let linear = side.y - side.xy * x0 / xx;
    let bend = side.yy - side.xy * side.xy / xx + last_bend;
    let y = -linear / bend;
    Parabola {
        least: constant - linear * linear / bend,
        at: last_at + y,
        bend,
    }
}
