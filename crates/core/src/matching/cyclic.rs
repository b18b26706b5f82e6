//! Correspondence of two cyclic vectors of polylines by dynamic programming (paper section 3.3).
//!
//! In: how many polylines there are on either side, and what a pair of groups costs (shape and alignment).
//! Out: the pairs of groups that minimise `Σ S + C (|B| + |B'| − #matched)`, cyclic order respected.
//!
//! As printed, the paper's objective `Σ S + C (2|~| − |B| − |B'|)` is smallest for no pair at all; the sign of
//! the penalty is meant the other way round. A group of two on one side counts as two matched polylines.
//!
//! Cyclic order: the first vector is cut once, where the caller starts it; the second is tried from each of its
//! polylines. That finds every order-preserving correspondence but those with a group of the first vector
//! across its cut. O(n·m) cells, m rotations: O(n³).

/// The longest group of polylines matched to one: one object cut twice by something in front of it.
pub const LONGEST_GROUP: usize = 3;

/// A run of polylines, cyclic: `first`, `first + 1`, .. modulo their number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// Index of its first polyline.
    pub first: usize,
    /// How many, at least 1.
    pub len: usize,
}

impl Group {
    /// The indices of its polylines among `count`.
    pub fn indices(self, count: usize) -> impl Iterator<Item = usize> {
        (0..self.len).map(move |k| (self.first + k) % count)
    }
}

/// A pair of groups, one of them of length 1, and what it costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupPair {
    /// Polylines of the scan.
    pub scan: Group,
    /// Polylines of the reference.
    pub reference: Group,
    /// What the pair costs: S with its alignment term.
    pub cost: f64,
}

/// All pairs of groups worth a thought, by their first polylines.
#[derive(Clone, Debug)]
pub struct GroupCosts {
    scan: usize,
    reference: usize,
    pairs: Vec<Vec<GroupPair>>,
}

impl GroupCosts {
    /// No pair yet, for so many polylines on either side.
    #[must_use]
    pub fn new(scan: usize, reference: usize) -> Self {
        Self {
            scan,
            reference,
            pairs: vec![Vec::new(); scan * reference],
        }
    }

    /// Offers a pair. Pairs that lie outside the vectors, run over the end of the scan's, or cost no number
    /// are left out.
    pub fn offer(&mut self, pair: GroupPair) {
        let fits = pair.scan.first + pair.scan.len <= self.scan
            && pair.reference.first < self.reference
            && pair.reference.len <= self.reference
            && pair.cost.is_finite();
        if fits {
            self.pairs[pair.scan.first * self.reference + pair.reference.first].push(pair);
        }
    }
}

/// The cheapest correspondence: its pairs in the scan's order, and the value of the objective.
#[must_use]
pub fn cyclic_matching(costs: &GroupCosts, penalty: f64) -> (Vec<GroupPair>, f64) {
    let none = penalty * (costs.scan + costs.reference) as f64;
    let mut best = (Vec::new(), none);
    // A cut elsewhere gives the same matchings as the next one that starts a pair.
    let starts_a_pair =
        |cut: &usize| (0..costs.scan).any(|i| !costs.pairs[i * costs.reference + cut].is_empty());
    for cut in (0..costs.reference).filter(starts_a_pair) {
        let table = Table::filled(costs, penalty, cut);
        let total = none + table.gain(0, 0);
        if total < best.1 - 1e-12 {
            best = (table.pairs(costs), total);
        }
    }
    best
}

/// What the polylines from (i, j) on can save, for the reference cut before `cut`.
struct Table {
    /// Lowest sum of `cost − penalty · polylines` from cell (i, j) on, never above 0.
    gains: Vec<f64>,
    /// The pair taken there, as its place in the list of the cell.
    choices: Vec<Choice>,
    reference: usize,
    cut: usize,
}

#[derive(Clone, Copy)]
enum Choice {
    SkipScan,
    SkipReference,
    Take(GroupPair),
}

impl Table {
    fn filled(costs: &GroupCosts, penalty: f64, cut: usize) -> Self {
        let (n, m) = (costs.scan, costs.reference);
        let mut table = Self {
            gains: vec![0.0; (n + 1) * (m + 1)],
            choices: vec![Choice::SkipScan; (n + 1) * (m + 1)],
            reference: m,
            cut,
        };
        for i in (0..n).rev() {
            for j in (0..m).rev() {
                table.fill(costs, penalty, i, j);
            }
        }
        table
    }

    fn fill(&mut self, costs: &GroupCosts, penalty: f64, i: usize, j: usize) {
        let mut best = (self.gain(i + 1, j), Choice::SkipScan);
        if self.gain(i, j + 1) < best.0 {
            best = (self.gain(i, j + 1), Choice::SkipReference);
        }
        let place = i * costs.reference + (self.cut + j) % self.reference;
        for pair in &costs.pairs[place] {
            let (to_i, to_j) = (i + pair.scan.len, j + pair.reference.len);
            if to_j > self.reference {
                continue;
            }
            let matched = (pair.scan.len + pair.reference.len) as f64;
            let gain = pair.cost - penalty * matched + self.gain(to_i, to_j);
            if gain < best.0 {
                best = (gain, Choice::Take(*pair));
            }
        }
        let cell = i * (self.reference + 1) + j;
        (self.gains[cell], self.choices[cell]) = best;
    }

    fn gain(&self, i: usize, j: usize) -> f64 {
        self.gains[i * (self.reference + 1) + j]
    }

    fn pairs(&self, costs: &GroupCosts) -> Vec<GroupPair> {
        let (mut i, mut j) = (0, 0);
        let mut pairs = Vec::new();
        while i < costs.scan && j < self.reference {
            match self.choices[i * (self.reference + 1) + j] {
                Choice::SkipScan => i += 1,
                Choice::SkipReference => j += 1,
                Choice::Take(pair) => {
                    i += pair.scan.len;
                    j += pair.reference.len;
                    pairs.push(pair);
                }
            }
        }
        pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(first: usize) -> Group {
        Group { first, len: 1 }
    }

    fn random_costs(n: usize, m: usize, seed: u64) -> GroupCosts {
        let mut state = seed.wrapping_add(99);
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        let mut costs = GroupCosts::new(n, m);
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            for (a, b) in [(1, 1), (1, 2), (2, 1), (3, 1)] {
                costs.offer(GroupPair {
                    scan: Group { first: i, len: a },
                    reference: Group { first: j, len: b },
                    cost: 3.0 * next(),
                });
            }
        }
        costs
    }

    /// Tries every set of pairs, and asks of each whether it keeps the cyclic order.
    fn exhaustive(costs: &GroupCosts, penalty: f64) -> f64 {
        let all: Vec<GroupPair> = costs.pairs.iter().flatten().copied().collect();
        let mut best = 0.0;
        grow(costs, penalty, &all, &mut Vec::new(), 0.0, &mut best);
        best + penalty * (costs.scan + costs.reference) as f64
    }

    fn grow(
        costs: &GroupCosts,
        penalty: f64,
        all: &[GroupPair],
        taken: &mut Vec<GroupPair>,
        gain: f64,
        best: &mut f64,
    ) {
        *best = f64::min(*best, gain);
        let next = taken.last().map_or(0, |p| p.scan.first + p.scan.len);
        for pair in all.iter().filter(|p| p.scan.first >= next) {
            taken.push(*pair);
            if in_cyclic_order(taken, costs.reference) {
                let matched = (pair.scan.len + pair.reference.len) as f64;
                grow(
                    costs,
                    penalty,
                    all,
                    taken,
                    gain + pair.cost - penalty * matched,
                    best,
                );
            }
            taken.pop();
        }
    }

    /// Once round, from the first pair's group on, every polyline is met at most once.
    fn in_cyclic_order(pairs: &[GroupPair], m: usize) -> bool {
        let start = pairs[0].reference.first;
        let mut end = 0;
        pairs.iter().all(|p| {
            let from = (p.reference.first + m - start) % m;
            let free = from >= end;
            end = from + p.reference.len;
            free && end <= m
        })
    }

    #[test]
    fn the_table_finds_what_trying_everything_finds() {
        for seed in 0..20 {
            let costs = random_costs(4, 5, seed);
            let (pairs, total) = cyclic_matching(&costs, 0.8);
            let naive = exhaustive(&costs, 0.8);
            assert!((total - naive).abs() < 1e-9, "seed {seed}: {total} and {naive}");
            let matched: usize = pairs.iter().map(|p| p.scan.len + p.reference.len).sum();
            let again: f64 = pairs.iter().map(|p| p.cost).sum::<f64>() + 0.8 * (9 - matched) as f64;
            assert!((total - again).abs() < 1e-9, "the pairs are those of the total");
        }
    }

    #[test]
    fn a_turned_scanner_sees_the_same_row_begin_elsewhere() {
        let mut costs = GroupCosts::new(4, 4);
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let cost = if j == (i + 3) % 4 { 0.01 } else { 5.0 };
            costs.offer(GroupPair {
                scan: one(i),
                reference: one(j),
                cost,
            });
        }
        let (pairs, total) = cyclic_matching(&costs, 0.1);
        assert_eq!(pairs.len(), 4);
        assert!((total - 0.04).abs() < 1e-12);
    }

    #[test]
    fn dear_pairs_stay_unmatched() {
        let mut costs = GroupCosts::new(1, 1);
        costs.offer(GroupPair {
            scan: one(0),
            reference: one(0),
            cost: 0.21,
        });
        assert!(
            cyclic_matching(&costs, 0.1).0.is_empty(),
            "two penalties are cheaper"
        );
        assert_eq!(cyclic_matching(&costs, 0.11).0.len(), 1);
    }
}
