//! Ranges of a whole log: how many beams returned, and what stands for those that did not.

use std::collections::BTreeMap;

use polymapper_core::scan::Scan;
use serde::Serialize;

/// Different values for "no return" that are counted apart.
const MAX_CODES: usize = 4096;
/// Of those, how many are told.
const CODES_TOLD: usize = 8;

/// The ranges of all scans.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Ranges {
    /// Beams of all scans together.
    pub beams: u64,
    /// Beams that returned.
    pub returns: u64,
    /// The shortest return, metres; 0 without one.
    pub shortest_m: f64,
    /// The longest return, metres; 0 without one.
    pub longest_m: f64,
    /// What the log writes where there is no return, the most frequent first.
    pub codes: Vec<Code>,
    /// Beams without return that hold other values.
    pub other_codes: u64,
}

/// A value that is no return.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Code {
    /// The value as text: `nan`, `inf`, `-inf`, or metres with up to 3 decimals.
    pub value: String,
    /// Beams that hold it.
    pub beams: u64,
}

#[derive(Default)]
pub(super) struct RangeCensus {
    ranges: Ranges,
    /// By the bits of the value in millimetres, or of what is no number.
    codes: BTreeMap<i64, u64>,
    /// The value met last and how often in a row; no returns come in runs.
    run: (i64, u64),
}

const NAN: i64 = i64::MAX;
const INF: i64 = i64::MAX - 1;
const MINUS_INF: i64 = i64::MIN;

impl RangeCensus {
    pub fn take(&mut self, scan: &Scan, raw_ranges_m: Option<&[f64]>) {
        let ranges_m = scan.ranges_m();
        let raw = raw_ranges_m.unwrap_or(ranges_m);
        self.ranges.beams += ranges_m.len() as u64;
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        let mut returns = 0;
        for (&range_m, &raw_m) in ranges_m.iter().zip(raw) {
            if range_m.is_nan() {
                self.count(key(raw_m));
            } else {
                returns += 1;
                shortest = shortest.min(range_m);
                longest = longest.max(range_m);
            }
        }
        if returns > 0 {
            let before = self.ranges.returns > 0;
            let shortest_m = &mut self.ranges.shortest_m;
            *shortest_m = if before {
                shortest_m.min(shortest)
            } else {
                shortest
            };
            self.ranges.longest_m = self.ranges.longest_m.max(longest);
            self.ranges.returns += returns;
        }
    }

    fn count(&mut self, key: i64) {
        if self.run.0 == key {
            self.run.1 += 1;
            return;
        }
        self.end_run();
        self.run = (key, 1);
    }

    fn end_run(&mut self) {
        let (key, times) = self.run;
        if times == 0 {
            return;
        }
        if self.codes.len() < MAX_CODES || self.codes.contains_key(&key) {
            *self.codes.entry(key).or_default() += times;
        } else {
            self.ranges.other_codes += times;
        }
    }

    pub fn finish(mut self) -> Ranges {
        self.end_run();
        let mut codes: Vec<(i64, u64)> = self.codes.into_iter().collect();
        codes.sort_by_key(|&(key, beams)| (std::cmp::Reverse(beams), key));
        let told = codes.len().min(CODES_TOLD);
        self.ranges.other_codes += codes[told..].iter().map(|c| c.1).sum::<u64>();
        self.ranges.codes = codes[..told]
            .iter()
            .map(|&(key, beams)| Code {
                value: value(key),
                beams,
            })
            .collect();
        self.ranges
    }
}

/// The value in whole millimetres.
fn key(raw_m: f64) -> i64 {
    match raw_m {
        r if r.is_nan() => NAN,
        f64::INFINITY => INF,
        f64::NEG_INFINITY => MINUS_INF,
        r => (r * 1e3).round().clamp(-1e15, 1e15) as i64,
    }
}

fn value(key: i64) -> String {
    match key {
        NAN => "nan".to_owned(),
        INF => "inf".to_owned(),
        MINUS_INF => "-inf".to_owned(),
        millimetres => {
            let text = format!("{:.3}", millimetres as f64 / 1e3);
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
    }
}
