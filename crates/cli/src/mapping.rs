//! What `build` needs of a mapper, and the mapper of the core library in that role.

use polymapper_core::join::SavedMap;
use polymapper_core::map::Map;
use polymapper_core::mapper::{
    self, LooseStretch, Mapper, NotPlaced, Quality, Revoked, Settings, Stage, Step,
};
use polymapper_io::log::{BadScan, LogScan};
use polymapper_io::out::Outcome;
use serde_json::Value;

use crate::clock::StageClock;
use crate::record::{BuildRecord, Recorded};

/// Scans in, map out.
pub trait Mapping {
    /// Takes the next scan. Its odometry is there only with `--use-odometry`. Stages are entered on `clock` as they
    /// begin.
    fn add_scan(&mut self, scan: &LogScan, clock: &mut StageClock) -> anyhow::Result<()>;

    /// Takes note of a line without a usable scan.
    fn skip(&mut self, bad: &BadScan) -> anyhow::Result<()>;

    /// The map, and what became of every scan that was added, in their order. `partial` says why the log was not read
    /// to its end.
    fn finish(self, partial: Option<&str>, clock: &mut StageClock) -> anyhow::Result<Finished>;

    /// Every setting with its value, for the report.
    fn settings(&self) -> Value;
}

/// What a mapper leaves.
pub struct Finished {
    pub map: Map,
    pub outcomes: Vec<Outcome>,
    /// What was noted when each of these scans was placed.
    pub noted: Vec<Noted>,
    /// What was taken back or put right, in words.
    pub corrections: Vec<String>,
    /// Where the map may be wrong; scans are numbered as in the log.
    pub loose: Vec<LooseStretch>,
    /// What must be kept to continue the map; scans are numbered as they were added.
    pub saved: SavedMap,
    /// How the map came to be.
    pub recorded: Recorded,
}

/// What is kept of the moment at which a scan was placed.
#[derive(Clone, Copy, Default)]
pub struct Noted {
    /// The scan at whose place it was recognised to be, counted as they were added.
    pub recognised: Option<usize>,
    pub quality: Quality,
}

impl Noted {
    pub fn of(step: &Step) -> Self {
        Self {
            recognised: step.recognised,
            quality: step.quality(),
        }
    }
}

/// The mapper of the core library.
pub struct CoreMapping {
    mapper: Mapper,
    settings: Settings,
    noted: Vec<Noted>,
    /// Number in the log of every scan that was added.
    numbers: Vec<usize>,
    corrections: Vec<String>,
    record: BuildRecord,
}

impl CoreMapping {
    /// A mapper that records what it does.
    pub fn new(settings: Settings, record: BuildRecord) -> Self {
        Self {
            mapper: Mapper::new(settings),
            settings,
            noted: Vec::new(),
            numbers: Vec::new(),
            corrections: Vec::new(),
            record,
        }
    }
}

impl Mapping for CoreMapping {
    fn add_scan(&mut self, scan: &LogScan, clock: &mut StageClock) -> anyhow::Result<()> {
        let step = self
            .mapper
            .add_scan_watched(&scan.scan, scan.odometry, &mut |stage| clock.enter(stage.name()));
        self.noted.push(Noted::of(&step));
        self.numbers.push(scan.index);
        let numbers = &self.numbers;
        self.corrections.extend(step.revoked.iter().map(|revoked| {
            Revoked {
                scan: numbers[revoked.scan],
                recognised: numbers[revoked.recognised],
                ..*revoked
            }
            .to_string()
        }));
        self.corrections.extend(step.made_again.iter().map(|&scan| {
            let number = numbers[scan];
            format!("scan {number} contradicted the scans after it and was placed again, with them")
        }));
        clock.enter("record");
        self.record.step(&self.mapper, scan, &step)
    }

    fn skip(&mut self, bad: &BadScan) -> anyhow::Result<()> {
        self.record.skip(bad)
    }

    fn finish(mut self, partial: Option<&str>, clock: &mut StageClock) -> anyhow::Result<Finished> {
        clock.enter(Stage::Finish.name());
        let placed_again = self.mapper.settle();
        self.corrections.extend(sweep(self.mapper.sweep_share()));
        self.corrections.extend(placed_again.iter().map(|&scan| {
            let number = self.numbers[scan];
            format!("scan {number} contradicted the finished map and was placed again")
        }));
        let loose = self.mapper.loose_stretches();
        let loose = loose.into_iter().map(|l| l.numbered(&self.numbers)).collect();
        let map = self.mapper.map();
        let outcomes = self.mapper.outcomes();
        clock.enter("record");
        let recorded = self.record.finish(&map, &outcomes, partial)?;
        Ok(Finished {
            saved: self.mapper.saved(),
            map,
            outcomes: outcomes.iter().map(outcome).collect(),
            noted: self.noted,
            corrections: self.corrections,
            loose,
            recorded,
        })
    }

    fn settings(&self) -> Value {
        // Printed by their own names, so that there is no second list of settings to keep in step.
        Value::String(format!("{:?}", self.settings))
    }
}

/// That scans were made straight, in words.
fn sweep(share: f64) -> Option<String> {
    let direction = if share > 0.0 {
        "counter-clockwise"
    } else {
        "clockwise"
    };
    (share != 0.0).then(|| {
        format!(
            "the beam goes round {direction} once in {:.0} % of the time from scan to scan, as the walls show: scans taken on the move were made straight",
            100.0 * share.abs()
        )
    })
}

/// An outcome as it is written.
pub fn outcome(outcome: &mapper::Outcome) -> Outcome {
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
