//! What `build` needs of a mapper.

use anyhow::bail;
use polymapper_core::geometry::Pose;
use polymapper_core::map::Map;
use polymapper_core::scan::Scan;
use polymapper_io::out::Outcome;

use crate::clock::StageClock;

/// Scans in, map out.
pub trait Mapping {
    /// Takes the next scan. `odometry` is the pose that the log gives for it, only with `--use-odometry`.
    /// Stages are entered on `clock` as they begin.
    fn add_scan(&mut self, scan: &Scan, odometry: Option<Pose>, clock: &mut StageClock);

    /// The map, and what became of every scan that was added, in their order.
    fn finish(self, clock: &mut StageClock) -> Finished;

    /// Every setting with its value, for the report.
    fn settings(&self) -> serde_json::Value;
}

/// What a mapper leaves.
pub struct Finished {
    pub map: Map,
    pub outcomes: Vec<Outcome>,
}

/// The mapper that `build` uses.
pub fn mapper() -> anyhow::Result<NoMapper> {
    bail!("this version reads logs and extracts polylines, but does not build maps yet")
}

/// Stands where the mapper will; there is none.
pub enum NoMapper {}

impl Mapping for NoMapper {
    fn add_scan(&mut self, _scan: &Scan, _odometry: Option<Pose>, _clock: &mut StageClock) {
        match *self {}
    }

    fn finish(self, _clock: &mut StageClock) -> Finished {
        match self {}
    }

    fn settings(&self) -> serde_json::Value {
        match *self {}
    }
}
