//! `report.json`: what a build read, made and took.

use std::collections::BTreeMap;
use std::io::{self, Write};

use serde::Serialize;

use super::QualityReport;
use crate::log::Tally;

/// The whole report.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Name and version of the program.
    pub generator: String,
    /// Why the result does not hold the whole log; `None` when it does.
    pub partial: Option<String>,
    /// The log.
    pub input: InputReport,
    /// What became of its scans.
    pub scans: ScanReport,
    /// How well they were placed.
    pub quality: QualityReport,
    /// The map.
    pub map: MapReport,
    /// Time by stage, in the order of the pipeline.
    pub stages: Vec<StageTime>,
    /// The most memory that the process held, bytes; `None` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// Every setting with its value.
    pub settings: serde_json::Value,
    /// What was assumed, in words.
    pub notes: Vec<String>,
}

/// What was read.
#[derive(Clone, Debug, Serialize)]
pub struct InputReport {
    /// Name of the file as it was given.
    pub name: String,
    /// Name of the format.
    pub format: String,
    /// Message kind of the laser.
    pub laser: Option<String>,
    /// Lines or messages.
    pub lines: u64,
    /// Bytes after decompression.
    pub bytes: u64,
    /// Whether the poses in the log were used.
    pub odometry_used: bool,
    /// Scans whose stamp is earlier than that of the scan before.
    pub stamps_backwards: usize,
    /// Messages of other kinds, by name.
    pub other_messages: BTreeMap<String, u64>,
    /// What of the log was not read although it does not break off, in words.
    pub lost: Option<String>,
}

impl InputReport {
    /// The report of the log `name` in `format`, of which `tally` was read.
    #[must_use]
    pub fn new(name: &str, format: &str, odometry_used: bool, tally: &Tally) -> Self {
        Self {
            name: name.to_owned(),
            format: format.to_owned(),
            laser: tally.laser.clone(),
            lines: tally.lines,
            bytes: tally.bytes,
            odometry_used,
            stamps_backwards: tally.stamps_backwards,
            other_messages: tally.other_messages.clone(),
            lost: tally.lost.clone(),
        }
    }
}

/// Scans, counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ScanReport {
    /// Lines of the laser.
    pub read: usize,
    /// Scans with a place in the map.
    pub placed: usize,
    /// Scans without, and lines that could not be used.
    pub not_placed: usize,
    /// How often for which reason; unusable lines are one reason together.
    pub not_placed_by_reason: BTreeMap<String, usize>,
}

/// The map, measured.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MapReport {
    /// Polylines.
    pub polylines: usize,
    /// Vertices of all polylines together.
    pub vertices: usize,
    /// Length of all polylines together, metres.
    pub length_m: f64,
    /// Eraser boxes.
    pub eraser_boxes: usize,
    /// Size of `map.json`, bytes.
    pub bytes: u64,
}

/// Time that a stage took.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageTime {
    /// Name of the stage.
    pub stage: String,
    /// Time on the wall clock, seconds.
    pub wall_s: f64,
    /// Time of the processor, seconds; `None` where the system does not tell.
    pub cpu_s: Option<f64>,
}

impl Report {
    /// Writes the report, indented.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut *out, self)?;
        writeln!(out)
    }
}
