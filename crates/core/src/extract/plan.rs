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
use crate::geometry::Point;

/// Chains of positions into the list of returns; neighbours in a chain are joined by a side.
pub(super) type Chains = Vec<Vec<usize>>;

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
    /// Begins a chain.
    begun_least: f64,
}

impl Plan<'_> {
    /// The best chains with at most `budget` vertices.
    pub(super) fn solve(&self, budget: usize) -> Chains {
        let m = self.candidates.len();
        let width = budget + 1;
        let mut vertices = vec![
            Vertex {
                ended: NEVER,
                from: 0,
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
            let Some(side) = self.side(s, t) else { continue };
            let first_bend = self.own_bend(s);
            let first_at = 1.0 / self.points[s].norm();
            for v in 1..width - 1 {
                let vertex = &earlier[j * width + v];
                let start = if vertex.begun_least < vertex.ended.least {
                    Parabola {
                        least: vertex.begun_least,
                        at: first_at,
                        bend: first_bend,
                    }
                } else {
                    vertex.ended
                };
                let so_far = &mut here[v + 1];
                if start.least + side.least >= so_far.ended.least {
                    continue;
                }
                let ended = through(start, first_at, &side, own_at, own_bend);
                if ended.least < so_far.ended.least {
                    so_far.ended = ended;
                    so_far.from = j;
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
    fn side(&self, s: usize, t: usize) -> Option<Side> {
        let crossing_m2 = self.crossing_m2[t] - self.crossing_m2[s];
        let inner = s + 1..t;
        let limit = self.unused_m2 * inner.len() as f64;
        if crossing_m2 > limit || self.sums.range_cost(&inner) + crossing_m2 > limit {
            return None;
        }
        let mut side = self.sums.side(self.points[s], self.points[t], &inner)?;
        side.at_returns += crossing_m2;
        side.least = self.sums.range_cost(&inner) + crossing_m2;
        Some(side)
    }

    /// The chains of the least total cost.
    fn trace(&self, vertices: &[Vertex], closed: &[f64], width: usize) -> Chains {
        let m = self.candidates.len();
        let mut v = (0..width)
            .min_by(|&a, &b| closed[m * width + a].total_cmp(&closed[m * width + b]))
            .unwrap_or(0);
        let mut chains = Chains::new();
        let mut k = m;
        while k > 0 {
            if closed[k * width + v] < vertices[(k - 1) * width + v].ended.least {
                k -= 1;
                continue;
            }
            let mut at = k - 1;
            let mut chain = vec![self.candidates[at]];
            loop {
                at = vertices[at * width + v].from;
                v -= 1;
                chain.push(self.candidates[at]);
                let vertex = &vertices[at * width + v];
                if vertex.begun_least < vertex.ended.least {
                    break;
                }
            }
            v -= 1;
            k = at;
            chain.reverse();
            chains.push(chain);
        }
        chains.reverse();
        chains
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
