//! One pass over a log: its scans, their places in the map, the map, and maps of the first scans.

use anyhow::Context;
use polymapper_core::geometry::Pose;
use polymapper_core::map::Map;
use polymapper_core::mapper::{Mapper, Outcome, Settings};
use polymapper_core::scan::Scan;
use polymapper_io::log::{Entry, Log};

use crate::interrupt::Interrupt;
use crate::scans::{self, Reading};

/// Maps that are kept for Fig. 4, each a step after the one before: early ones, because they are made in no time and their
/// vertices are new; the newer a vertex, the further a scan moves it, and the more there is to see.
const EARLY_MAPS: usize = 20;
/// The step: nearer by, a scan says the same as the last.
const STEP_M: f64 = 0.25;
const STEP_RAD: f64 = 0.15;

/// A usable scan of the log.
pub struct SurveyedScan {
    /// 0-based number in the log.
    pub index: usize,
    pub scan: Scan,
    /// Pose that the log gives.
    pub log_pose: Option<Pose>,
    /// Pose in the map; `None` when it was not placed.
    pub map_from_scan: Option<Pose>,
}

/// A map that a scan is about to be merged into.
pub struct BeforeMerge {
    /// Place of the scan in [`Survey::scans`].
    pub scan: usize,
    /// The map without it.
    pub map: Map,
    pub map_from_scan: Pose,
}

/// What the figures are drawn from.
pub struct Survey {
    /// Name of the log.
    pub name: String,
    pub scans: Vec<SurveyedScan>,
    pub map: Map,
    pub early: Vec<BeforeMerge>,
    pub reading: Reading,
}

impl Survey {
    /// Reads and maps `log`.
    pub fn take(log: &mut Log, interrupt: &Interrupt) -> anyhow::Result<Self> {
        let mut mapper = Mapper::new(Settings::default());
        let mut scans: Vec<SurveyedScan> = Vec::new();
        let mut early: Vec<BeforeMerge> = Vec::new();
        let mut last: Option<Pose> = None;
        let reading = scans::for_each(log, interrupt, |entry| {
            let Entry::Scan(line) = entry else { return Ok(()) };
            let is_due = early.len() < EARLY_MAPS && last.is_some_and(|pose| is_step(&early, pose));
            let before = is_due.then(|| mapper.map());
            last = place(mapper.add_scan(&line.scan, None).outcome);
            if let (Some(map), Some(map_from_scan)) = (before, last) {
                early.push(BeforeMerge {
                    scan: scans.len(),
                    map,
                    map_from_scan,
                });
            }
            scans.push(SurveyedScan {
                index: line.index,
                scan: line.scan,
                log_pose: line.odometry,
                map_from_scan: None,
            });
            Ok(())
        })?;
        mapper.settle();
        for (scan, outcome) in scans.iter_mut().zip(mapper.outcomes()) {
            scan.map_from_scan = place(outcome);
        }
        Ok(Self {
            name: scans::short_name(log.name()),
            scans,
            map: mapper.map(),
            early,
            reading,
        })
    }

    /// Place in [`Survey::scans`] of the scan with a number in the log.
    pub fn number(&self, index: usize) -> anyhow::Result<usize> {
        self.scans
            .iter()
            .position(|scan| scan.index == index)
            .with_context(|| {
                format!(
                    "{} has no usable scan {index}: its {} usable scans are numbered up to {}",
                    self.name,
                    self.scans.len(),
                    self.scans.last().map_or(0, |scan| scan.index)
                )
            })
    }
}

/// Whether the scanner has moved since the last map was kept.
fn is_step(early: &[BeforeMerge], pose: Pose) -> bool {
    early.last().is_none_or(|before| {
        let motion = before.map_from_scan.inverse() * pose;
        motion.translation().norm() >= STEP_M || motion.theta_rad.abs() >= STEP_RAD
    })
}

fn place(outcome: Outcome) -> Option<Pose> {
    match outcome {
        Outcome::Placed { map_from_scan } => Some(map_from_scan),
        Outcome::NotPlaced { .. } => None,
    }
}
