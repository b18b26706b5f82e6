//! What is in a log: counted while its scans go past, in memory that does not depend on its length.
//!
//! In goes an opened log (with [`ReadOptions::keep_raw`](crate::log::ReadOptions) and `use_odometry`), out comes an
//! [`Inspection`]: topics, scans, geometry, times, what stands for "no return", and what will be left out and why.

mod codes;
mod times;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::log::{Entry, Log, LogError, LogScan, Tally};
use codes::RangeCensus;
pub use codes::{Code, Ranges};
use times::StampCensus;
pub use times::{Gap, Stamps};

/// Kinds of geometry and of faults that are kept apart.
const MAX_KINDS: usize = 16;

/// What a log holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// Name of the file or folder.
    pub name: String,
    /// Name of the format.
    pub format: String,
    /// How it is packed.
    pub compression: Option<String>,
    /// Bytes after decompression.
    pub bytes: u64,
    /// Lines or messages.
    pub lines: u64,
    /// Topic or kind of message of the laser that is read.
    pub laser: Option<String>,
    /// Scans that can be used.
    pub scans: usize,
    /// Geometry of the scans, the most frequent first.
    pub geometries: Vec<Geometry>,
    /// Further kinds of geometry that are not listed.
    pub more_geometries: usize,
    /// Ranges of all scans.
    pub ranges: Ranges,
    /// Times of the scans; `None` where the log has none.
    pub stamps: Option<Stamps>,
    /// Scans that come with a pose of odometry.
    pub odometry_poses: usize,
    /// Length of the way by odometry, metres; it will not be used unless it is asked for.
    pub odometry_way_m: f64,
    /// Scans that will be left out, by reason.
    pub bad_scans: Vec<BadScans>,
    /// Messages that are not used, by name, with how many and why.
    pub not_used: Vec<NotUsed>,
    /// Why the log was not read to its end, or not all of it.
    pub broken: Option<String>,
    /// What was assumed.
    pub notes: Vec<String>,
}

/// A kind of scan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Geometry {
    /// Scans of this kind.
    pub scans: usize,
    /// Beams of a scan.
    pub beams: usize,
    /// Bearing of the first beam, counter-clockwise from ahead, degrees.
    pub first_deg: f64,
    /// Angle from beam to beam, degrees.
    pub step_deg: f64,
}

/// Scans that will be left out for one reason.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BadScans {
    /// How many.
    pub scans: usize,
    /// The first of them: where, and what is wrong.
    pub first: String,
}

/// Messages that are not used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotUsed {
    /// Kind or topic.
    pub name: String,
    /// How many.
    pub messages: u64,
    /// Why; `None`: they are no scans.
    pub reason: Option<String>,
}

/// Reads `log` to its end.
///
/// # Errors
/// A log without a scan, or one that breaks off before the first. One that breaks off later is told in the result.
pub fn inspect(log: &mut Log) -> Result<Inspection, LogError> {
    let mut census = Census::default();
    let mut broken = None;
    while let Some(entry) = log.next() {
        match entry {
            Ok(Entry::Scan(scan)) => census.take(&scan),
            Ok(Entry::Bad(bad)) => {
                let first = format!("{}, {} {}: {}", log.place(), bad.unit, bad.line, bad.fault);
                census.take_bad(bad.fault.kind(), first);
            }
            Err(error @ LogError::Broken { .. }) if census.scans > 0 => broken = Some(chain(&error)),
            Err(error) => return Err(error),
        }
    }
    Ok(census.finish(log, broken))
}

/// An error with its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let mut words = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        words = format!("{words}: {error}");
        cause = error.source();
    }
    words
}

#[derive(Default)]
struct Census {
    scans: usize,
    /// Scans by beams, and by first bearing and step in 0.001°.
    geometries: BTreeMap<(usize, i64, i64), (usize, Geometry)>,
    more_geometries: usize,
    ranges: RangeCensus,
    stamps: StampCensus,
    odometry_poses: usize,
    odometry_way_m: f64,
    last_pose: Option<polymapper_core::geometry::Pose>,
    bad: BTreeMap<&'static str, BadScans>,
}

impl Census {
    fn take(&mut self, entry: &LogScan) {
        self.scans += 1;
        self.take_geometry(entry);
        self.ranges.take(&entry.scan, entry.raw_ranges_m.as_deref());
        self.stamps.take(entry.stamp_s, entry.index);
        if let Some(pose) = entry.odometry {
            self.odometry_poses += 1;
            if let Some(before) = self.last_pose {
                self.odometry_way_m += before.distance(pose);
            }
            self.last_pose = Some(pose);
        }
    }

    fn take_geometry(&mut self, entry: &LogScan) {
        let geometry = entry.scan.geometry();
        let (first_deg, step_deg) = (
            geometry.bearing_rad(0).to_degrees(),
            geometry.step_rad().to_degrees(),
        );
        let thousandths = |deg: f64| (deg * 1000.0).round() as i64;
        let key = (geometry.beams(), thousandths(first_deg), thousandths(step_deg));
        if !self.geometries.contains_key(&key) && self.geometries.len() >= MAX_KINDS {
            self.more_geometries += 1;
            return;
        }
        let new = Geometry {
            scans: 0,
            beams: geometry.beams(),
            first_deg,
            step_deg,
        };
        self.geometries.entry(key).or_insert((self.scans, new)).1.scans += 1;
    }

    fn take_bad(&mut self, kind: &'static str, first: String) {
        self.bad.entry(kind).or_insert(BadScans { scans: 0, first }).scans += 1;
    }

    fn finish(self, log: &Log, broken: Option<String>) -> Inspection {
        let tally = log.tally();
        let mut geometries: Vec<(usize, Geometry)> = self.geometries.into_values().collect();
        geometries.sort_by_key(|(first, g)| (std::cmp::Reverse(g.scans), *first));
        Inspection {
            name: log.name().to_owned(),
            format: log.format().to_owned(),
            compression: log.compression().map(str::to_owned),
            bytes: tally.bytes,
            lines: tally.lines,
            laser: tally.laser.clone(),
            scans: self.scans,
            geometries: geometries.into_iter().map(|(_, g)| g).collect(),
            more_geometries: self.more_geometries,
            ranges: self.ranges.finish(),
            stamps: self.stamps.finish(),
            odometry_poses: self.odometry_poses,
            odometry_way_m: self.odometry_way_m,
            bad_scans: self.bad.into_values().collect(),
            not_used: not_used(&tally),
            broken: broken.or_else(|| tally.lost.clone()),
            notes: tally.notes,
        }
    }
}

fn not_used(tally: &Tally) -> Vec<NotUsed> {
    tally
        .other_messages
        .iter()
        .map(|(name, &messages)| NotUsed {
            name: name.clone(),
            messages,
            reason: tally.reasons.get(name).cloned(),
        })
        .collect()
}
