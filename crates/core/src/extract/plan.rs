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
    /// Whether a group begins at a return: no side joins it with the return before.
    pub(super) breaks: &'a [bool],
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

/// What is known of the vertices at all candidates, for every number of vertices so far: row = candidate, column = number.
/// Kept as separate lists, because the inner loop mostly looks at `start_least` and goes on.
struct Table {
    width: usize,
    /// A side ends here: least cost.
    ended: Vec<Parabola>,
    /// Where that side begins (candidate), and the things in front of it, each with two vertices of its own.
    from: Vec<(u16, u16)>,
    /// A chain begins here: least cost.
    begun_least: Vec<f64>,
    /// The lower of both.
    start_least: Vec<f64>,
}

impl Table {
    fn new(candidates: usize, width: usize) -> Self {
        let size = candidates * width;
        let never = Parabola {
            least: f64::INFINITY,
            at: 0.0,
            bend: 1.0,
        };
        Self {
            width,
            ended: vec![never; size],
            from: vec![(0, 0); size],
            begun_least: vec![f64::INFINITY; size],
            start_least: vec![f64::INFINITY; size],
        }
    }

    /// Whether beginning a chain is cheaper than ending a side, at a cell.
    fn begins(&self, cell: usize) -> bool {
        self.begun_least[cell] < self.ended[cell].least
    }
}

impl Plan<'_> {
    /// The best chains with at most `budget` vertices.
    pub(super) fn solve(&self, budget: usize) -> Vec<Chain> {
        let m = self.candidates.len();
        let width = budget + 1;
        let mut table = Table::new(m, width);
        // closed[k + 1]: least cost of all returns up to candidate k, no chain open.
        let mut closed = vec![f64::INFINITY; (m + 1) * width];
        closed[..width].fill(0.0);
        for k in 0..m {
            let row = k * width;
            let between = self.unused_m2 * (self.skipped(k)) as f64;
            for v in 1..width {
                table.begun_least[row + v] = closed[row + v - 1] + between;
            }
            self.end_sides(k, &mut table);
            for v in 0..width {
                let ended = table.ended[row + v].least;
                let dropped = closed[row + v] + between + self.unused_m2;
                closed[row + width + v] = dropped.min(ended);
                table.start_least[row + v] = ended.min(table.begun_least[row + v]);
            }
        }
        self.trace(&table, &closed)
    }

    /// Returns between candidate `k` and the one before.
    fn skipped(&self, k: usize) -> usize {
        let before = k.checked_sub(1).map_or(0, |j| self.candidates[j] + 1);
        self.candidates[k] - before
    }

    /// All sides that end at candidate `k`, for every number of vertices.
    fn end_sides(&self, k: usize, table: &mut Table) {
        let t = self.candidates[k];
        for j in (0..k).rev() {
            let s = self.candidates[j];
            if self.bearings_rad[t] - self.bearings_rad[s] > WIDEST_SIDE_RAD {
                break;
            }
            for (side, things) in [self.side(s, t), self.side_behind(s, t)].into_iter().flatten() {
                self.end_side(table, j, k, &side, things);
            }
        }
    }

    /// One side from candidate `j` to `k`, for every number of vertices.
    fn end_side(&self, table: &mut Table, j: usize, k: usize, side: &Side, things: usize) {
        let width = table.width;
        let (first, last) = (self.own(self.candidates[j]), self.own(self.candidates[k]));
        let spent = 1 + 2 * things;
        for v in 1..width.saturating_sub(spent) {
            let (before, here) = (j * width + v, k * width + v + spent);
            let so_far = table.ended[here].least;
            if table.start_least[before] + side.least >= so_far {
                continue;
            }
            let start = if table.begins(before) {
                Parabola {
                    least: table.begun_least[before],
                    ..first
                }
            } else {
                table.ended[before]
            };
            let ended = through(start, first.at, side, last);
            if ended.least < so_far {
                table.ended[here] = ended;
                table.from[here] = (j as u16, things as u16);
            }
        }
    }

    /// A return's own squared range residual as a parabola: weight r⁴ in the inverse range.
    fn own(&self, t: usize) -> Parabola {
        let r2 = self.points[t].dot(self.points[t]);
        Parabola {
            least: 0.0,
            at: 1.0 / r2.sqrt(),
            bend: r2 * r2,
        }
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
        if inner.is_empty() && self.breaks[t] {
            return None;
        }
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
    fn trace(&self, table: &Table, closed: &[f64]) -> Vec<Chain> {
        let (m, width) = (self.candidates.len(), table.width);
        let mut v = (0..width)
            .min_by(|&a, &b| closed[m * width + a].total_cmp(&closed[m * width + b]))
            .unwrap_or(0);
        let mut chains = Vec::new();
        let mut k = m;
        while k > 0 {
            if closed[k * width + v] < table.ended[(k - 1) * width + v].least {
                k -= 1;
                continue;
            }
            k -= 1;
            let mut chain = Chain::default();
            chain.vertices.push(self.candidates[k]);
            loop {
                let t = self.candidates[k];
                let (from, things) = table.from[k * width + v];
                k = usize::from(from);
                v -= 1 + 2 * usize::from(things);
                let s = self.candidates[k];
                chain.vertices.push(s);
                if things > 0 {
                    chain.things.extend(
                        self.front
                            .between(s, t)
                            .into_iter()
                            .flat_map(|(things, _)| things),
                    );
                }
                if table.begins(k * width + v) {
                    break;
                }
            }
            v -= 1;
            chain.vertices.reverse();
            chains.push(chain);
        }
        chains.reverse();
        chains
    }
}

/// Carries a parabola over a side: minimum over the inverse range of its first vertex, plus the own residual of its last.
fn through(start: Parabola, first_at: f64, side: &Side, last: Parabola) -> Parabola {
    // x, y: deviations of the two inverse ranges from the measured ones.
    let start_x = start.at - first_at;
    let per_xx = 1.0 / (start.bend + side.xx);
    let x0 = side.x - start.bend * start_x;
    let constant = start.least + start.bend * start_x * start_x + side.at_returns - x0 * x0 * per_xx;
    let linear = side.y - side.xy * x0 * per_xx;
    let bend = side.yy - side.xy * side.xy * per_xx + last.bend;
    let y = -linear / bend;
    Parabola {
        least: constant + linear * y,
        at: last.at + y,
        bend,
    }
}
