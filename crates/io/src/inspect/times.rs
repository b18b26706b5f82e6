//! Stamps of a whole log: rate, gaps, and where they run backwards.
//!
//! The median time from scan to scan comes from a histogram with cells of 1 %, so that no list of all is kept.

use std::collections::BTreeMap;

use serde::Serialize;

/// A time from scan to scan of more than this many medians is a gap.
const GAP_MEDIANS: f64 = 5.0;
/// Width of a cell of the histogram, natural logarithm.
const CELL: f64 = 0.01;

/// The times of the scans.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stamps {
    /// Scans that have one.
    pub stamped: usize,
    /// The first, seconds.
    pub first_s: f64,
    /// The last in file order, seconds.
    pub last_s: f64,
    /// Median time from scan to scan, seconds; `None` when no stamp is later than the one before.
    pub median_step_s: Option<f64>,
    /// Stamps earlier than the one before.
    pub backwards: usize,
    /// The farthest step back, seconds.
    pub most_backwards_s: f64,
    /// Stamps that are the same as the one before.
    pub repeated: usize,
    /// Steps of more than five medians.
    pub gaps: usize,
    /// The longest of all steps.
    pub longest_gap: Option<Gap>,
}

impl Stamps {
    /// Whether most stamps are not later than the one before, so that they tell no times.
    #[must_use]
    pub fn are_useless(&self) -> bool {
        2 * (self.backwards + self.repeated) >= self.stamped
    }
}

/// A time without scans.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gap {
    /// How long, seconds.
    pub seconds: f64,
    /// 0-based number of the scan before it.
    pub after_scan: usize,
}

#[derive(Default)]
pub(super) struct StampCensus {
    stamped: usize,
    first_s: f64,
    last: Option<(f64, usize)>,
    /// Steps forward by their logarithm.
    steps: BTreeMap<i64, usize>,
    backwards: usize,
    most_backwards_s: f64,
    repeated: usize,
    longest: Option<Gap>,
}

impl StampCensus {
    pub fn take(&mut self, stamp_s: Option<f64>, index: usize) {
        let Some(stamp_s) = stamp_s else { return };
        self.stamped += 1;
        match self.last {
            None => self.first_s = stamp_s,
            Some((before_s, before)) => self.step(stamp_s - before_s, before),
        }
        self.last = Some((stamp_s, index));
    }

    fn step(&mut self, seconds: f64, before: usize) {
        if seconds < 0.0 {
            self.backwards += 1;
            self.most_backwards_s = self.most_backwards_s.max(-seconds);
        } else if seconds > 0.0 {
            *self
                .steps
                .entry((seconds.ln() / CELL).round() as i64)
                .or_default() += 1;
            if self.longest.as_ref().is_none_or(|gap| seconds > gap.seconds) {
                self.longest = Some(Gap {
                    seconds,
                    after_scan: before,
                });
            }
        } else {
            self.repeated += 1;
        }
    }

    pub fn finish(self) -> Option<Stamps> {
        let (last_s, _) = self.last?;
        let median_step_s = median(&self.steps);
        let gaps = median_step_s.map_or(0, |median_s| {
            let from = ((GAP_MEDIANS * median_s).ln() / CELL).round() as i64;
            self.steps.range(from + 1..).map(|(_, n)| n).sum()
        });
        Some(Stamps {
            stamped: self.stamped,
            first_s: self.first_s,
            last_s,
            median_step_s,
            backwards: self.backwards,
            most_backwards_s: self.most_backwards_s,
            repeated: self.repeated,
            gaps,
            longest_gap: self.longest,
        })
    }
}

fn median(steps: &BTreeMap<i64, usize>) -> Option<f64> {
    let half = steps.values().sum::<usize>() / 2;
    let mut passed = 0;
    steps
        .iter()
        .find(|(_, n)| {
            passed += **n;
            passed > half
        })
        .map(|(&cell, _)| (cell as f64 * CELL).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamps(all: &[f64]) -> Stamps {
        let mut census = StampCensus::default();
        for (k, &s) in all.iter().enumerate() {
            census.take(Some(s), k);
        }
        census.finish().unwrap()
    }

    #[test]
    fn gaps_and_steps_back_are_found() {
        let found = stamps(&[0.0, 0.1, 0.2, 0.15, 0.3, 0.3, 0.4, 3.4, 3.5, 3.6]);
        assert_eq!((found.backwards, found.repeated, found.gaps), (1, 1, 1));
        assert!((found.most_backwards_s - 0.05).abs() < 1e-9);
        assert!((found.median_step_s.unwrap() - 0.1).abs() < 0.002);
        let gap = found.longest_gap.unwrap();
        assert_eq!((gap.after_scan, (gap.seconds - 3.0).abs() < 1e-9), (6, true));
    }

    #[test]
    fn useless_stamps_are_no_rate() {
        let found = stamps(&[0.0; 5]);
        assert_eq!(
            (found.median_step_s, found.repeated, found.longest_gap),
            (None, 4, None)
        );
    }
}
