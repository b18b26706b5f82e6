//! Discrete curve evolution: remove the least relevant vertex, again and again (paper section 3.1).
//!
//! In: a chain of vertices and a removal cost of (u, v, w), v between its neighbours u and w. Out: the vertices that
//! stay. End points are fixed. A heap over a doubly linked list makes it O(n log n); of equal costs the earlier vertex
//! goes first, so that the answer is one.
//!
//! The paper's cost is K(u,v,w) = |d(u,v) + d(v,w) − d(u,w)|, metres; its levels 1, 5, 10, 15 (Fig. 2) are
//! millimetres. K ≈ (h²/2)(1/a + 1/b) for a vertex of height h between legs a and b, hence knows nothing of the
//! noise: [`super::extract`] does not stop by it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::geometry::Point;

/// How long the evolution goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// Until every vertex that is left costs this much or more.
    AtCost(f64),
    /// Until this many vertices are left (never fewer than the two ends).
    AtVertices(usize),
}

/// The paper's relevance K(u,v,w) = |d(u,v) + d(v,w) − d(u,w)|, metres.
#[must_use]
pub fn relevance_m(u: Point, v: Point, w: Point) -> f64 {
    (u.distance(v) + v.distance(w) - u.distance(w)).abs()
}

/// The paper's evolution of one chain of points: positions of the vertices that stay, in order.
#[must_use]
pub fn evolve(points: &[Point], stop: Stop) -> Vec<usize> {
    evolve_by(points.len(), stop, |u, v, w| {
        relevance_m(points[u], points[v], points[w])
    })
}

/// Evolution of a chain of `n` vertices by any removal cost of (before, vertex, after); a cost that is NaN is
/// infinite. Returns the positions that stay, in order.
#[must_use]
pub fn evolve_by(n: usize, stop: Stop, mut cost: impl FnMut(usize, usize, usize) -> f64) -> Vec<usize> {
    if n <= 2 {
        return (0..n).collect();
    }
    let mut chain = Chain::new(n);
    let mut heap = BinaryHeap::with_capacity(n);
    let mut current = vec![Cost(f64::INFINITY); n];
    for (v, now) in current.iter_mut().enumerate().take(n - 1).skip(1) {
        *now = Cost::new(cost(v - 1, v, v + 1));
        heap.push(Reverse((*now, v)));
    }
    while let Some(Reverse((c, v))) = heap.pop() {
        if chain.removed[v] || c != current[v] {
            continue;
        }
        let done = match stop {
            Stop::AtCost(limit) => c.0 >= limit,
            Stop::AtVertices(count) => chain.left <= count.max(2),
        };
        if done {
            break;
        }
        let (u, w) = chain.remove(v);
        for side in [u, w] {
            if side > 0 && side < n - 1 {
                current[side] = Cost::new(cost(chain.before[side], side, chain.after[side]));
                heap.push(Reverse((current[side], side)));
            }
        }
    }
    (0..n).filter(|&v| !chain.removed[v]).collect()
}

/// A cost with a total order; NaN counts as infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cost(f64);

impl Cost {
    fn new(cost: f64) -> Self {
        Self(if cost.is_nan() { f64::INFINITY } else { cost })
    }
}

impl Eq for Cost {}

impl PartialOrd for Cost {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cost {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// Doubly linked list over 0..n.
struct Chain {
    before: Vec<usize>,
    after: Vec<usize>,
    removed: Vec<bool>,
    left: usize,
}

impl Chain {
    fn new(n: usize) -> Self {
        Self {
            before: (0..n).map(|k| k.saturating_sub(1)).collect(),
            after: (0..n).map(|k| (k + 1).min(n - 1)).collect(),
            removed: vec![false; n],
            left: n,
        }
    }

    /// Takes out an inner vertex and gives its former neighbours.
    fn remove(&mut self, v: usize) -> (usize, usize) {
        let (u, w) = (self.before[v], self.after[v]);
        self.after[u] = w;
        self.before[w] = u;
        self.removed[v] = true;
        self.left -= 1;
        (u, w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same by looking at every vertex at every removal: O(n²).
    fn evolve_naive(n: usize, stop: Stop, cost: impl Fn(usize, usize, usize) -> f64) -> Vec<usize> {
        let mut left: Vec<usize> = (0..n).collect();
        while left.len() > 2 {
            let (at, least) = (1..left.len() - 1)
                .map(|k| (k, cost(left[k - 1], left[k], left[k + 1])))
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            let done = match stop {
                Stop::AtCost(limit) => least >= limit,
                Stop::AtVertices(count) => left.len() <= count.max(2),
            };
            if done {
                break;
            }
            left.remove(at);
        }
        left
    }

    /// A wavy chain with repeated points and exact ties, from a small congruential sequence.
    fn chain(n: usize, mut seed: u64) -> Vec<Point> {
        (0..n)
            .map(|k| {
                seed = seed
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                Point::new((k / 2) as f64, ((seed >> 60) % 4) as f64)
            })
            .collect()
    }

    #[test]
    fn the_heap_gives_what_looking_at_every_vertex_gives() {
        for seed in 0..40 {
            let points = chain(60, seed);
            let cost = |u: usize, v: usize, w: usize| relevance_m(points[u], points[v], points[w]);
            for stop in [
                Stop::AtCost(0.5),
                Stop::AtCost(3.0),
                Stop::AtVertices(17),
                Stop::AtVertices(0),
            ] {
                assert_eq!(
                    evolve(&points, stop),
                    evolve_naive(60, stop, cost),
                    "seed {seed} {stop:?}"
                );
            }
        }
    }

    #[test]
    fn a_corner_outlives_the_points_on_its_walls() {
        let points: Vec<Point> = (0..=10)
            .map(|k| Point::new(f64::from(k), 0.0))
            .chain((1..=10).map(|k| Point::new(10.0, f64::from(k))))
            .collect();
        assert_eq!(evolve(&points, Stop::AtCost(0.001)), [0, 10, 20]);
    }

    #[test]
    fn short_chains_are_left_alone() {
        assert_eq!(evolve(&[], Stop::AtVertices(2)), Vec::<usize>::new());
        assert_eq!(evolve(&[Point::default()], Stop::AtVertices(2)), [0]);
    }
}
