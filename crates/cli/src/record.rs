//! What a build leaves to be looked at: the record of how the map came to be, whole as `replay.jsonl.gz`, and without
//! the single scans for `report.html`.

use std::path::Path;

use anyhow::Context;
use polymapper_core::map::Map;
use polymapper_core::mapper::{Mapper, Outcome, Step};
use polymapper_io::log::{BadScan, LogScan};
use polymapper_io::out::AtomicFile;
use polymapper_view::replay::{self, ReplayWriter};
use polymapper_view::{Background, Recorder, Scanned, Snapshots};

use crate::scans::short_name;

/// Name and version of the program, as in every file.
pub const GENERATOR: &str = concat!("polymapper ", env!("CARGO_PKG_VERSION"));

/// The record of a build in the making.
pub struct BuildRecord(Recorder<Background<Files>>);

/// The whole record, if it is wanted, and the light one.
type Files = (Option<ReplayWriter<AtomicFile>>, ReplayWriter<Vec<u8>>);

/// The record for the report, packed.
pub struct Recorded(pub Vec<u8>);

impl BuildRecord {
    /// Begins the record of the log `log_name`, whole in `folder` if there is to be a file of it.
    pub fn create(folder: &Path, log_name: &str, with_file: bool) -> anyhow::Result<Self> {
        let file = with_file
            .then(|| AtomicFile::create(&folder.join(replay::FILE)))
            .transpose()?;
        let sinks = (file.map(ReplayWriter::new), ReplayWriter::light(Vec::new()));
        let recorder = Recorder::new(
            Background::new(sinks),
            &short_name(log_name),
            GENERATOR,
            Snapshots::Tripling,
        );
        Ok(Self(recorder.context(CANNOT)?))
    }

    /// Takes note of a scan.
    pub fn step(&mut self, mapper: &Mapper, scan: &LogScan, step: &Step) -> anyhow::Result<()> {
        self.0.step(mapper, scanned(scan), step).context(CANNOT)
    }

    /// Takes note of a line without a usable scan.
    pub fn skip(&mut self, bad: &BadScan) -> anyhow::Result<()> {
        self.0
            .skip(bad.index, bad.line, &bad.fault.to_string())
            .context(CANNOT)
    }

    /// Puts the file in its place.
    pub fn finish(self, map: &Map, outcomes: &[Outcome], partial: Option<&str>) -> anyhow::Result<Recorded> {
        let sinks = self.0.finish(map, outcomes, partial.map(str::to_owned));
        let (file, light) = sinks.and_then(Background::finish).context(CANNOT)?;
        if let Some(file) = file {
            file.finish().context(CANNOT)?.finish()?;
        }
        Ok(Recorded(light.finish().context(CANNOT)?))
    }
}

const CANNOT: &str = "cannot write the replay";

/// A scan as recorders take it.
pub fn scanned(scan: &LogScan) -> Scanned<'_> {
    Scanned {
        index: scan.index,
        stamp_s: scan.stamp_s,
        scan: &scan.scan,
    }
}
