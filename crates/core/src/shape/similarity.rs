//! S(C, D): the best correspondence of maximal arcs, by dynamic programming (paper section 3.2).
//!
//! In: two shapes. Out: S in rad² and the pairs of parts that lie on each other.
//!
//! A pair holds groups of consecutive arcs, one of them a single arc:
//! `M[i][j] = min( min_{k≥1} M[i−1][j−k] + D(a_i, b_{j−k+1..j}), min_{k≥2} M[i−k][j−1] + D(a_{i−k+1..i}, b_j) )`.
//! Occlusion cuts polylines, so at either end one of the two may have arcs that stay unmatched, priced by their length.
//! Not both: where both go on, they have to go on alike.
//! S is the sum over the mean length of the two shapes.

use super::fit::{Fit, Open, Span, UNMATCHED_RAD2, fit};
use super::{Part, Shape};

/// No pair joins more arcs than this: a group of many arcs against one is never cheap, and the bound keeps long
/// ragged polylines from costing O(n³).
const LONGEST_GROUP: usize = 4;

/// A part of C that lies on a part of D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartPair {
    /// Stretch of C.
    pub c: Part,
    /// Stretch of D.
    pub d: Part,
    /// Share of S, rad², with what was trimmed at open ends.
    pub cost_rad2: f64,
}

/// How unlike two polylines are, and where one lies on the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Similarity {
    /// S(C, D), rad²; 0 for the same shape.
    pub cost_rad2: f64,
    /// The pairs, in order along both.
    pub pairs: Vec<PartPair>,
}

/// The best correspondence of two shapes; `None` if each costs more than `limit_rad2`.
#[must_use]
pub fn similarity(c: &Shape, d: &Shape, limit_rad2: f64) -> Option<Similarity> {
    let mean_m = 0.5 * (c.length_m() + d.length_m());
    let mut table = Table::new(c, d, limit_rad2 * mean_m);
    table.fill();
    table.best(mean_m)
}

#[derive(Clone, Copy)]
struct Step {
    /// Cost up to here, m·rad².
    total: f64,
    /// Arcs used before the pair; the pair is the first one if `first`.
    before: (usize, usize),
    first: bool,
    fit: Fit,
}

struct Table<'a> {
    c: &'a Shape,
    d: &'a Shape,
    limit: f64,
    /// Best step that ends with arcs i and j used up and another pair to come; (n+1)·(m+1) of them.
    inner: Vec<Option<Step>>,
    /// Best last step of all.
    last: Option<Step>,
}

impl<'a> Table<'a> {
    fn new(c: &'a Shape, d: &'a Shape, limit: f64) -> Self {
        let cells = (c.arcs().len() + 1) * (d.arcs().len() + 1);
        Self {
            c,
            d,
            limit,
            inner: vec![None; cells],
            last: None,
        }
    }

    fn cell(&self, i: usize, j: usize) -> usize {
        i * (self.d.arcs().len() + 1) + j
    }

    fn fill(&mut self) {
        let (n, m) = (self.c.arcs().len(), self.d.arcs().len());
        for i in 1..=n {
            for j in 1..=m {
                for k in 1..=j.min(LONGEST_GROUP) {
                    self.extend((i - 1, j - k), (i, j));
                }
                for k in 2..=i.min(LONGEST_GROUP) {
                    self.extend((i - k, j - 1), (i, j));
                }
            }
        }
    }

    /// Tries the pair of the arcs between two cells as the first one and as a later one.
    fn extend(&mut self, before: (usize, usize), after: (usize, usize)) {
        let first = (before.0 == 0 || before.1 == 0).then(|| self.price_before(before));
        let inner = self.inner[self.cell(before.0, before.1)].map(|s| s.total);
        for (total, first) in [(first, true), (inner, false)] {
            if let Some(total) = total.filter(|&t| t <= self.bound()) {
                self.add(total, before, after, first);
            }
        }
    }

    /// Nothing dearer than this can become part of the answer.
    fn bound(&self) -> f64 {
        self.last.map_or(self.limit, |s| s.total)
    }

    fn add(&mut self, so_far: f64, before: (usize, usize), after: (usize, usize), first: bool) {
        let c = Span::of_arcs(self.c, before.0, after.0);
        let d = Span::of_arcs(self.d, before.1, after.1);
        let step = |open: Open, budget: f64| {
            let fit = fit(c, d, open, budget);
            Step {
                total: so_far + fit.cost,
                before,
                first,
                fit,
            }
        };
        let price_behind = self.price_behind(after);
        let (more_c, more_d) = (after.0 < self.c.arcs().len(), after.1 < self.d.arcs().len());
        if !(more_c && more_d) && so_far + price_behind <= self.bound() {
            let budget = self.bound() - so_far - price_behind;
            let mut last = step(
                Open {
                    start: first,
                    end: true,
                },
                budget,
            );
            last.total += price_behind;
            if last.total <= self.limit && self.last.is_none_or(|s| last.total < s.total) {
                self.last = Some(last);
            }
        }
        if more_c && more_d {
            let bound = self.bound();
            let inner = step(
                Open {
                    start: first,
                    end: false,
                },
                bound - so_far,
            );
            let cell = self.cell(after.0, after.1);
            if inner.total <= bound && self.inner[cell].is_none_or(|s| inner.total < s.total) {
                self.inner[cell] = Some(inner);
            }
        }
    }

    fn price_before(&self, (i, j): (usize, usize)) -> f64 {
        let before_m = |s: &Shape, k: usize| s.arcs().get(k).map_or(s.length_m(), |a| a.part.from_m);
        UNMATCHED_RAD2 * (before_m(self.c, i) + before_m(self.d, j))
    }

    fn price_behind(&self, (i, j): (usize, usize)) -> f64 {
        let behind_m = |s: &Shape, k: usize| s.arcs().get(k).map_or(0.0, |a| s.length_m() - a.part.from_m);
        UNMATCHED_RAD2 * (behind_m(self.c, i) + behind_m(self.d, j))
    }

    fn best(&self, mean_m: f64) -> Option<Similarity> {
        let mut step = self.last?;
        let cost_rad2 = step.total / mean_m;
        let mut pairs = Vec::new();
        loop {
            pairs.push(PartPair {
                c: step.fit.c,
                d: step.fit.d,
                cost_rad2: step.fit.cost / mean_m,
            });
            match self.inner[self.cell(step.before.0, step.before.1)] {
                Some(previous) if !step.first => step = previous,
                _ => break,
            }
        }
        pairs.reverse();
        Some(Similarity { cost_rad2, pairs })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Polyline};

    fn shape(points: &[(f64, f64)]) -> Shape {
        let points = points.iter().map(|&(x, y)| Point::new(x, y)).collect();
        Shape::new(&Polyline::new(points).unwrap()).unwrap()
    }

    fn s(c: &Shape, d: &Shape) -> Similarity {
        similarity(c, d, f64::INFINITY).unwrap()
    }

    /// Every way to cut both into groups, tried out; m·rad².
    fn exhaustive(c: &Shape, d: &Shape, used: (usize, usize), first: bool) -> f64 {
        let (n, m) = (c.arcs().len(), d.arcs().len());
        let mut best = f64::INFINITY;
        for i in used.0 + 1..=n {
            for j in used.1 + 1..=m {
                let (gi, gj) = (i - used.0, j - used.1);
                if gi.min(gj) > 1 || gi.max(gj) > LONGEST_GROUP {
                    continue;
                }
                let spans = (Span::of_arcs(c, used.0, i), Span::of_arcs(d, used.1, j));
                let cost = |end| fit(spans.0, spans.1, Open { start: first, end }, f64::INFINITY).cost;
                let behind = c.length_m() - spans.0.part.to_m + d.length_m() - spans.1.part.to_m;
                if i == n || j == m {
                    best = best.min(cost(true) + UNMATCHED_RAD2 * behind);
                }
                best = best.min(cost(false) + exhaustive(c, d, (i, j), false));
            }
        }
        if !first {
            return best;
        }
        let from_m = |s: &Shape, k: usize| s.arcs()[k].part.from_m;
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            if (i == 0 || j == 0) && (i, j) != (0, 0) && used == (0, 0) {
                let before = UNMATCHED_RAD2 * (from_m(c, i) + from_m(d, j));
                best = best.min(before + exhaustive_from(c, d, (i, j)));
            }
        }
        best
    }

    /// Starts at given arcs without skipping any further.
    fn exhaustive_from(c: &Shape, d: &Shape, start: (usize, usize)) -> f64 {
        let mut best = f64::INFINITY;
        for i in start.0 + 1..=c.arcs().len() {
            for j in start.1 + 1..=d.arcs().len() {
                let (gi, gj) = (i - start.0, j - start.1);
                if gi.min(gj) > 1 || gi.max(gj) > LONGEST_GROUP {
                    continue;
                }
                let spans = (Span::of_arcs(c, start.0, i), Span::of_arcs(d, start.1, j));
                let cost = |end| fit(spans.0, spans.1, Open { start: true, end }, f64::INFINITY).cost;
                let behind = c.length_m() - spans.0.part.to_m + d.length_m() - spans.1.part.to_m;
                if i == c.arcs().len() || j == d.arcs().len() {
                    best = best.min(cost(true) + UNMATCHED_RAD2 * behind);
                }
                best = best.min(cost(false) + exhaustive(c, d, (i, j), false));
            }
        }
        best
    }

    fn ragged(seed: u64, vertices: usize) -> Shape {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        let points: Vec<(f64, f64)> = (0..vertices).map(|k| (k as f64 * 0.5, next())).collect();
        shape(&points)
    }

    #[test]
    fn the_table_finds_what_trying_everything_finds() {
        for seed in 0..12 {
            let (c, d) = (ragged(seed, 4 + seed as usize % 3), ragged(seed + 77, 6));
            let mean_m = 0.5 * (c.length_m() + d.length_m());
            let naive = exhaustive(&c, &d, (0, 0), true) / mean_m;
            let fast = s(&c, &d).cost_rad2;
            assert!((fast - naive).abs() < 1e-9, "seed {seed}: {fast} and {naive}");
        }
    }

    #[test]
    fn a_corner_seen_from_elsewhere_lies_corner_on_corner() {
        let near = shape(&[(0.0, 0.0), (1.0, 0.0), (1.0, 4.0)]);
        let far = shape(&[(-2.0, 0.0), (1.0, 0.0), (1.0, 2.5)]);
        let seen = s(&near, &far);
        assert_eq!(seen.pairs.len(), 1);
        let (c, d) = (seen.pairs[0].c, seen.pairs[0].d);
        assert!((c.from_m - 0.0).abs() < 1e-12 && (c.to_m - 3.5).abs() < 1e-12);
        assert!((d.from_m - 2.0).abs() < 1e-12 && (d.to_m - 5.5).abs() < 1e-12);
        // 3.5 m unmatched of a mean length of 5.25 m.
        assert!((seen.cost_rad2 - UNMATCHED_RAD2 * 3.5 / 5.25).abs() < 1e-12);
    }

    #[test]
    fn a_part_of_a_wall_is_cheap_and_a_corner_on_a_wall_is_not() {
        let wall = shape(&[(0.0, 0.0), (6.0, 0.0)]);
        let part = shape(&[(0.0, 0.0), (2.0, 0.0)]);
        let corner = shape(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]);
        let pillar = shape(&[
            (0., 0.),
            (0.3, 0.),
            (0.3, -0.3),
            (0.6, -0.3),
            (0.6, 0.),
            (0.9, 0.),
        ]);
        let same = s(&wall, &wall).cost_rad2;
        let parts = s(&wall, &part).cost_rad2;
        assert!(same < 1e-12 && parts > same && parts <= UNMATCHED_RAD2);
        assert!(parts < s(&wall, &pillar).cost_rad2);
        assert!(s(&part, &part).cost_rad2 < s(&part, &corner).cost_rad2);
    }

    #[test]
    fn one_arc_lies_on_several_that_noise_made_of_it() {
        let bow = shape(&[(0., 0.), (1., 0.1), (2., 0.5), (3., 1.2), (3.5, 2.0)]);
        let dented = shape(&[
            (0., 0.),
            (1., 0.1),
            (1.5, 0.37),
            (1.6, 0.32),
            (2., 0.5),
            (3., 1.2),
            (3.5, 2.0),
        ]);
        let other = shape(&[(0., 0.), (1., -0.1), (2., -0.5), (3., -1.2), (3.5, -2.0)]);
        assert!(s(&bow, &dented).cost_rad2 < 0.2 * s(&bow, &other).cost_rad2);
    }

    #[test]
    fn a_limit_refuses_what_costs_more() {
        let corner = shape(&[(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]);
        let cut = shape(&[(0.0, 0.0), (1.0, 0.0), (1.0, 2.0)]);
        let cost = s(&corner, &cut).cost_rad2;
        assert!(similarity(&corner, &cut, 1.01 * cost).is_some());
        assert!(similarity(&corner, &cut, 0.99 * cost).is_none());
    }
}
