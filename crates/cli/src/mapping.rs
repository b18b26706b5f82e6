//! What `build` needs of a mapper, and the mapper of the core library in that role.

use polymapper_core::geometry::Pose;
use polymapper_core::map::Map;
use polymapper_core::mapper::{self, Mapper, NotPlaced, Settings, Stage};
use polymapper_core::scan::Scan;
use polymapper_io::out::Outcome;
use serde_json::Value;

use crate::clock::StageClock;

/// Scans in, map out.
pub trait Mapping {
    /// Takes the next scan. `odometry` is the pose that the log gives for it, only with `--use-odometry`.
    /// Stages are entered on `clock` as they begin.
    fn add_scan(&mut self, scan: &Scan, odometry: Option<Pose>, clock: &mut StageClock);

    /// The map, and what became of every scan that was added, in their order.
    fn finish(self, clock: &mut StageClock) -> Finished;

    /// Every setting with its value, for the report.
    fn settings(&self) -> Value;
}

/// What a mapper leaves.
pub struct Finished {
    pub map: Map,
    pub outcomes: Vec<Outcome>,
}

/// The mapper of the core library.
pub struct CoreMapping {
    mapper: Mapper,
    settings: Settings,
}

impl CoreMapping {
    pub fn new(settings: Settings) -> Self {
        Self {
            mapper: Mapper::new(settings),
            settings,
        }
    }
}

impl Mapping for CoreMapping {
    fn add_scan(&mut self, scan: &Scan, odometry: Option<Pose>, clock: &mut StageClock) {
        self.mapper
            .add_scan_watched(scan, odometry, &mut |stage| clock.enter(stage.name()));
    }

    fn finish(self, clock: &mut StageClock) -> Finished {
        clock.enter(Stage::Finish.name());
        Finished {
            map: self.mapper.map(),
            outcomes: self.mapper.outcomes().iter().map(outcome).collect(),
        }
    }

    fn settings(&self) -> Value {
        // Printed by their own names, so that there is no second list of settings to keep in step.
        Value::String(format!("{:?}", self.settings))
    }
}

fn outcome(outcome: &mapper::Outcome) -> Outcome {
    match *outcome {
        mapper::Outcome::Placed { map_from_scan } => Outcome::Placed { map_from_scan },
        mapper::Outcome::NotPlaced { reason } => Outcome::NotPlaced {
            reason: words(reason).to_owned(),
        },
    }
}

fn words(reason: NotPlaced) -> &'static str {
    match reason {
        NotPlaced::TooFewReturns => "too_few_returns",
        NotPlaced::SeparateSubmap => "separate_submap",
    }
}
