//! Maps what is watched, scan by scan.

use polymapper_core::mapper::{Mapper, Settings};
use polymapper_io::log::Entry;
use polymapper_view::{Recorder, Store};

use crate::record::scanned;

/// A mapper and the record that pages follow.
pub struct Follower {
    mapper: Mapper,
    recorder: Recorder<Store>,
}

impl Follower {
    pub fn new(recorder: Recorder<Store>) -> Self {
        Self {
            mapper: Mapper::new(Settings::default()),
            recorder,
        }
    }

    /// Maps a scan.
    pub fn take(&mut self, entry: &Entry) -> anyhow::Result<()> {
        match entry {
            Entry::Scan(scan) => {
                let step = self.mapper.add_scan(&scan.scan, scan.odometry);
                self.recorder.step(&self.mapper, scanned(scan), &step)?;
            }
            Entry::Bad(bad) => {
                self.recorder.skip(bad.index, bad.line, &bad.fault.to_string())?;
            }
        }
        Ok(())
    }

    /// To be called when no scan waits.
    pub fn idle(&mut self) -> anyhow::Result<()> {
        Ok(self.recorder.idle(&self.mapper)?)
    }

    /// Ends the record with the finished map.
    pub fn finish(mut self, partial: Option<String>) -> anyhow::Result<()> {
        self.mapper.settle();
        self.recorder
            .finish(&self.mapper.map(), &self.mapper.outcomes(), partial)?;
        Ok(())
    }
}
