//! Things that stand in front of something: runs of returns that are nearer than both neighbours.
//!
//! A wall behind a chair leg is one wall. Seen that way, it needs two vertices fewer than a wall that ends at the leg and begins
//! again behind it, and the prediction is the same: a beam hits the nearer of two polylines.

use std::ops::Range;

use super::fit::Sums;
use crate::geometry::Point;

/// A range that falls or rises by more than this from beam to beam is an edge, metres (the paper's gap, section 2).
const EDGE_M: f64 = 0.2;

/// Returns of the widest thing: what is wider hides too much of the wall to say that it goes on.
const WIDEST: usize = 24;

/// Things in front, and sums over the returns that are in none.
pub(super) struct Front {
    /// Runs of returns, in order.
    pub(super) things: Vec<Range<usize>>,
    /// Sums with weight 0 for the returns of things.
    pub(super) behind: Sums,
    /// Whether a return is in a thing.
    pub(super) inside: Vec<bool>,
    /// Number of things that begin before a return.
    begun: Vec<usize>,
    /// Cost of one side through each thing, summed from the start.
    cost_m2: Vec<f64>,
}

impl Front {
    pub(super) fn new(points: &[Point], sums: &Sums) -> Self {
        let things = things(points);
        let n = points.len();
        let mut inside = vec![false; n];
        let mut begun = vec![0; n + 1];
        let mut cost_m2 = vec![0.0];
        for thing in &things {
            inside[thing.clone()].fill(true);
            begun[thing.start + 1] = 1;
            cost_m2.push(cost_m2[cost_m2.len() - 1] + sums.range_cost(thing));
        }
        for k in 0..n {
            begun[k + 1] += begun[k];
        }
        let weight = |k: usize, p: Point| if inside[k] { 0.0 } else { p.dot(p) };
        let behind = Sums::new(points.iter().enumerate().map(|(k, &p)| (p, weight(k, p))));
        Self {
            things,
            behind,
            inside,
            begun,
            cost_m2,
        }
    }

    /// The things between returns s and t, and the cost of a side through each; `None` where there are none or
    /// where s or t is itself in one.
    pub(super) fn between(&self, s: usize, t: usize) -> Option<(Range<usize>, f64)> {
        let things = self.begun[s]..self.begun[t];
        (!things.is_empty() && !self.inside[s] && !self.inside[t]).then(|| {
            (
                things.clone(),
                self.cost_m2[things.end] - self.cost_m2[things.start],
            )
        })
    }
}

/// Runs between a fall of the range and the next rise.
fn things(points: &[Point]) -> Vec<Range<usize>> {
    let mut things = Vec::new();
    let mut fall = None;
    for k in 1..points.len() {
        let rise_m = points[k].norm() - points[k - 1].norm();
        if rise_m < -EDGE_M {
            fall = Some(k);
        } else if rise_m > EDGE_M {
            if let Some(start) = fall.take().filter(|start| k - start <= WIDEST) {
                things.push(start..k);
            }
        }
    }
    things
}
