//! A run of points → the runs of its sides: the exact minimum of Σ (cost of a side) + penalty · (number of sides).
//!
//! Dynamic programming over the end of the last side, F(t) = min over s of F(s) + cost(s..t) + penalty. A start s with
//! F(s) + cost(s..t) > F(t) is never the best again, because a longer side cannot cost less (PELT: Killick, Fearnhead,
//! Eckley, 2012), which makes it nearly linear for walls of bounded length. For the same reason a start that was too dear for the
//! run up to t − 1 need not be looked at for the run up to t: along a wall nearly none are.

use std::ops::Range;

/// Where the last side may start.
struct Start {
    at: usize,
    /// What it costs up to there and on, at the least.
    least: f64,
}

/// Sides of the run 0..n, in order. `cost` must not fall when a run grows.
pub(crate) fn divide(n: usize, penalty: f64, cost: impl Fn(&Range<usize>) -> f64) -> Vec<Range<usize>> {
    let mut best = vec![0.0; n + 1];
    let mut from = vec![0; n + 1];
    let mut starts: Vec<Start> = Vec::new();
    for t in 1..=n {
        starts.push(Start {
            at: t - 1,
            least: best[t - 1],
        });
        let mut found = (f64::INFINITY, t - 1);
        let mut look = |start: &mut Start| {
            if (start.least, start.at) < found {
                start.least = best[start.at] + cost(&(start.at..t));
                if (start.least, start.at) < found {
                    found = (start.least, start.at);
                }
            }
        };
        // Most often the side goes on.
        if let Ok(k) = starts.binary_search_by_key(&from[t - 1], |start| start.at) {
            look(&mut starts[k]);
        }
        starts.iter_mut().for_each(look);
        best[t] = found.0 + penalty;
        from[t] = found.1;
        starts.retain(|start| start.least <= best[t]);
    }
    let mut sides = Vec::new();
    let mut end = n;
    while end > 0 {
        sides.push(from[end]..end);
        end = from[end];
    }
    sides.reverse();
    sides
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squared deviations from the mean, scaled: a cost that grows with the run.
    fn spread(values: &[f64], run: &Range<usize>) -> f64 {
        let part = &values[run.clone()];
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        part.iter().map(|v| (v - mean) * (v - mean)).sum()
    }

    /// Every one of the 2^(n−1) divisions.
    fn least_of_all(values: &[f64], penalty: f64) -> f64 {
        let n = values.len();
        (0..1_usize << (n - 1))
            .map(|cuts| {
                let mut start = 0;
                let mut total = 0.0;
                for end in 1..=n {
                    if end == n || cuts >> (end - 1) & 1 == 1 {
                        total += penalty + spread(values, &(start..end));
                        start = end;
                    }
                }
                total
            })
            .fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn no_division_is_cheaper() {
        let values = [0.0, 0.1, 0.0, 2.0, 2.1, 5.0, 1.9, 2.0, 2.2, 0.3, 0.2, 0.1];
        for penalty in [0.001, 0.1, 0.5, 3.0, 100.0] {
            let sides = divide(values.len(), penalty, |run| spread(&values, run));
            let total: f64 = sides.iter().map(|run| penalty + spread(&values, run)).sum();
            assert!(
                (total - least_of_all(&values, penalty)).abs() < 1e-12,
                "penalty {penalty}"
            );
            assert_eq!(sides.iter().map(Range::len).sum::<usize>(), values.len());
        }
    }
}
