//! One pass over a log: its scans, their places in the map, the map, and maps of the first scans.

use anyhow::Context;
use polymapper_core::geometry::Pose;
use polymapper_core::map::Map;
use polymapper_core::mapper::{Mapper, Outcome, Settings};
use polymapper_core::scan::Scan;
use polymapper_io::log::{Entry, Log};

use crate::interrupt::Interrupt;
use crate::scans::{self, Reading};

/// Before these scans the map is kept as it is then, for Fig. 4: early, because the newer a vertex of the map is, the
/// further a scan moves it, and the more there is to see.
const EARLY: [usize; 8] = [1, 2, 3, 5, 8, 13, 21, 34];

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
        let mut early = Vec::new();
        let reading = scans::for_each(log, interrupt, |entry| {
            let Entry::Scan(line) = entry else { return Ok(()) };
            let before = EARLY.contains(&scans.len()).then(|| mapper.map());
            let outcome = mapper.add_scan(&line.scan, None).outcome;
            if let (Some(map), Some(map_from_scan)) = (before, place(outcome)) {
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

fn place(outcome: Outcome) -> Option<Pose> {
    match outcome {
        Outcome::Placed { map_from_scan } => Some(map_from_scan),
        Outcome::NotPlaced { .. } => None,
    }
}
