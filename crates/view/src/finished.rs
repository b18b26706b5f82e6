//! A result without the record of how it came to be: map and poses alone, as a record in which only the way grows.
//!
//! In: what `map.json` and `trajectory.csv` hold. Out: lines for a [`Sink`]. The map comes before the first scan, so
//! that it is there whichever scan is shown.

use std::io;
use std::sync::Arc;

use polymapper_core::geometry::Pose;
use polymapper_core::map::Map;

use crate::record::{About, End, FORMAT, Frame, Line, MapState, VERSION, pose_record};
use crate::recorder::Sink;

/// What became of a scan.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedScan {
    /// Place in the log.
    pub scan: usize,
    /// Stamp of the log, seconds.
    pub stamp_s: Option<f64>,
    /// The laser in the map, or why it has no place there.
    pub map_from_scan: Result<Pose, String>,
}

/// What a build has left.
#[derive(Clone, Debug)]
pub struct Finished {
    /// Name of the result.
    pub name: String,
    /// Name and version of the program that shows it.
    pub generator: String,
    /// The map.
    pub map: Map,
    /// Every scan of the log, in order.
    pub scans: Vec<FinishedScan>,
    /// Why the map does not hold the whole log; `None` when it does.
    pub partial: Option<String>,
    /// What is not there and cannot be shown, in a sentence.
    pub missing: String,
}

impl Finished {
    /// Tells all of it.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn tell(self, sink: &mut impl Sink) -> io::Result<()> {
        let mut tell = |line| sink.take(&Arc::new(line));
        tell(Line::About(About {
            format: FORMAT.to_owned(),
            version: VERSION,
            generator: self.generator,
            log: self.name,
            missing: Some(self.missing),
        }))?;
        tell(Line::Map(
            MapState::default().change_to(&self.map, self.scans.len()),
        ))?;
        for scan in self.scans {
            tell(Line::Frame(frame(scan)))?;
        }
        tell(Line::End(End {
            partial: self.partial,
        }))
    }
}

fn frame(scan: FinishedScan) -> Frame {
    let (pose, reason) = match scan.map_from_scan {
        Ok(map_from_scan) => (Some(pose_record(map_from_scan)), None),
        Err(reason) => (None, Some(reason)),
    };
    Frame {
        scan: scan.scan,
        stamp_s: scan.stamp_s,
        pose,
        reason,
        ..Frame::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Lines(Vec<Arc<Line>>);

    impl Sink for Lines {
        fn take(&mut self, line: &Arc<Line>) -> io::Result<()> {
            self.0.push(Arc::clone(line));
            Ok(())
        }
    }

    #[test]
    fn the_map_is_there_before_the_first_scan() {
        let scan = |scan, map_from_scan| FinishedScan {
            scan,
            stamp_s: None,
            map_from_scan,
        };
        let finished = Finished {
            name: "out".to_owned(),
            generator: "test".to_owned(),
            map: Map::default(),
            scans: vec![
                scan(0, Ok(Pose::new(1.0, 2.0, 0.5))),
                scan(1, Err("too dark".to_owned())),
            ],
            partial: None,
            missing: "the record".to_owned(),
        };
        let mut lines = Lines::default();
        finished.tell(&mut lines).unwrap();
        let [about, map, first, second, end] = lines.0.as_slice() else {
            panic!("{:?}", lines.0)
        };
        assert!(matches!(&**about, Line::About(a) if a.missing.as_deref() == Some("the record")));
        assert!(matches!(&**map, Line::Map(m) if m.scans == 2));
        assert!(matches!(&**first, Line::Frame(f) if f.pose == Some([1.0, 2.0, 0.5])));
        assert!(matches!(&**second, Line::Frame(f) if f.reason.as_deref() == Some("too dark")));
        assert!(matches!(&**end, Line::End(_)));
    }
}
