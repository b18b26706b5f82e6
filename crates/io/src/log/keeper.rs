//! The book-keeping that all readers share: numbers of scans, counts, stamps that run backwards.

use polymapper_core::geometry::Pose;
use polymapper_core::scan::{Scan, ScanGeometry};

use super::error::excerpt;
use super::{BadScan, Entry, LineFault, LogScan, MAX_NAMES, ReadOptions, Tally, Unit};

/// What a laser line or message holds, whatever its format.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    pub geometry: ScanGeometry,
    /// As the log has them, but counter-clockwise.
    pub ranges_m: Vec<f64>,
    pub stamp_s: Option<f64>,
    pub odometry: Option<Pose>,
}

/// Makes entries of readings, and counts.
pub(super) struct Keeper {
    unit: Unit,
    keep_raw: bool,
    last_stamp_s: Option<f64>,
    /// All but lines, bytes and laser, which the reader knows.
    pub tally: Tally,
}

impl Keeper {
    pub fn new(unit: Unit, options: &ReadOptions) -> Self {
        Self {
            unit,
            keep_raw: options.keep_raw,
            last_stamp_s: None,
            tally: Tally::default(),
        }
    }

    /// The entry of the line or message with the number `line`.
    pub fn entry(&mut self, line: u64, reading: Result<Reading, LineFault>) -> Entry {
        let index = self.tally.scans + self.tally.bad_scans;
        let keep_raw = self.keep_raw;
        let scan = reading.and_then(|r| {
            let raw_ranges_m = keep_raw.then(|| r.ranges_m.clone());
            Ok(LogScan {
                index,
                line,
                stamp_s: r.stamp_s.filter(|s| s.is_finite()),
                scan: Scan::new(r.geometry, r.ranges_m)?,
                odometry: r.odometry,
                raw_ranges_m,
            })
        });
        match scan {
            Ok(scan) => {
                self.tally.scans += 1;
                if let (Some(before), Some(now)) = (self.last_stamp_s, scan.stamp_s) {
                    self.tally.stamps_backwards += usize::from(now < before);
                }
                self.last_stamp_s = scan.stamp_s.or(self.last_stamp_s);
                Entry::Scan(scan)
            }
            Err(fault) => {
                self.tally.bad_scans += 1;
                Entry::Bad(BadScan {
                    index,
                    line,
                    unit: self.unit,
                    fault,
                })
            }
        }
    }

    /// Counts a message of another kind.
    pub fn count_other(&mut self, name: &[u8]) {
        let counts = &mut self.tally.other_messages;
        let known = std::str::from_utf8(name).ok().and_then(|n| counts.get_mut(n));
        if let Some(count) = known {
            *count += 1;
            return;
        }
        let kind = if counts.len() < MAX_NAMES {
            excerpt(name)
        } else {
            "others".to_owned()
        };
        *counts.entry(kind).or_default() += 1;
    }

    /// Says something once.
    pub fn note(&mut self, note: String) {
        note_once(&mut self.tally.notes, note);
    }
}

/// Adds a note unless it is there, or there are many.
pub(super) fn note_once(notes: &mut Vec<String>, note: String) {
    const MAX_NOTES: usize = 16;
    if notes.len() < MAX_NOTES && !notes.contains(&note) {
        notes.push(note);
    }
}
