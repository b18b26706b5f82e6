//! From a mapper at work to the lines of a record.

use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};

use polymapper_core::map::Map;
use polymapper_core::mapper::{Mapper, NotPlaced, Outcome, Step};
use polymapper_core::scan::Scan;

use crate::record::{About, End, FORMAT, Line, MapState, ShownPoses, Skipped, VERSION, detail, frame, walls};

/// Where lines go.
pub trait Sink {
    /// Takes the next line.
    ///
    /// # Errors
    /// The line cannot be kept.
    fn take(&mut self, line: &Arc<Line>) -> io::Result<()>;
}

impl<A: Sink, B: Sink> Sink for (A, B) {
    fn take(&mut self, line: &Arc<Line>) -> io::Result<()> {
        self.0.take(line)?;
        self.1.take(line)
    }
}

impl<A: Sink> Sink for Option<A> {
    fn take(&mut self, line: &Arc<Line>) -> io::Result<()> {
        self.as_mut().map_or(Ok(()), |sink| sink.take(line))
    }
}

/// When the map of all scans so far is made for the record. It takes time that grows with the map, so it is made now
/// and then; between two of them the page shows the polylines that were merged since.
#[derive(Clone, Copy, Debug)]
pub enum Snapshots {
    /// Each time the number of merged scans is three times what it was: the same record for the same log, and half as much
    /// time again as the last map takes.
    Tripling,
    /// As often as this share of the time allows, but a map that takes longer than `longest` is only made when
    /// [`Recorder::idle`] says that there is time.
    Share {
        /// Share of the time, 0..1.
        share: f64,
        /// How long the next scan may wait.
        longest: Duration,
    },
}

/// A scan and where it comes from.
#[derive(Clone, Copy, Debug)]
pub struct Scanned<'a> {
    /// Place in the log.
    pub index: usize,
    /// Stamp of the log, seconds.
    pub stamp_s: Option<f64>,
    /// Ranges and geometry.
    pub scan: &'a Scan,
}

/// Writes the record of one mapper.
pub struct Recorder<S> {
    sink: S,
    snapshots: Snapshots,
    shown: ShownPoses,
    map: MapState,
    scans: usize,
    /// Merged scans now, and when the map was last told.
    merged: usize,
    merged_then: usize,
    /// The scan before left open where the scanner is.
    was_open: bool,
    /// The scan before is part of a map that is kept apart.
    was_apart: bool,
    since: Instant,
    took: Duration,
}

/// Two maps are told at least this far apart, so that a page has the time to show one.
const LEAST_PAUSE: Duration = Duration::from_millis(250);

impl<S: Sink> Recorder<S> {
    /// Begins the record of the log `log`, made by `generator`.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn new(mut sink: S, log: &str, generator: &str, snapshots: Snapshots) -> io::Result<Self> {
        sink.take(&Arc::new(Line::About(About {
            format: FORMAT.to_owned(),
            version: VERSION,
            generator: generator.to_owned(),
            log: log.to_owned(),
            missing: None,
        })))?;
        Ok(Self {
            sink,
            snapshots,
            shown: ShownPoses::default(),
            map: MapState::default(),
            scans: 0,
            merged: 0,
            merged_then: 0,
            was_open: false,
            was_apart: false,
            since: Instant::now(),
            took: Duration::ZERO,
        })
    }

    /// Takes note of what `mapper` made of a scan.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn step(&mut self, mapper: &Mapper, scanned: Scanned<'_>, step: &Step) -> io::Result<()> {
        let is_apart = step.outcome
            == Outcome::NotPlaced {
                reason: NotPlaced::SeparateSubmap,
            };
        // Within a map that is kept apart, the search is in that map's frame, which has no place on the page.
        let last = (!(is_apart && self.was_apart))
            .then(|| self.shown.last_placed())
            .flatten();
        self.was_apart = is_apart;
        let frame = frame(step, scanned.index, scanned.stamp_s);
        self.shown.push(frame.pose);
        self.scans += 1;
        self.merged += usize::from(frame.merged);
        // A closed loop and a step made again move poses; where several accounts of the motion were carried on, or the
        // scanner was lost, a later scan may decide where the ones before were.
        let is_open = step.tracks > 1 || frame.pose.is_none();
        let is_corrected = frame.recognised.is_some() || !step.made_again.is_empty();
        let may_have_moved = is_corrected || is_open || self.was_open;
        self.was_open = is_open;
        self.tell(Line::Detail(Box::new(detail(step, scanned.scan, last))))?;
        self.tell(Line::Frame(frame))?;
        if let Some(walls) = walls(step) {
            self.tell(Line::Walls(walls))?;
        }
        if may_have_moved {
            self.tell_poses(&mapper.outcomes())?;
        }
        if self.is_due() {
            self.snapshot(mapper)?;
        }
        Ok(())
    }

    /// Takes note of a line of the log that holds no usable scan.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn skip(&mut self, scan: usize, line: u64, why: &str) -> io::Result<()> {
        self.tell(Line::Skipped(Skipped {
            scan,
            line,
            why: why.to_owned(),
        }))
    }

    /// To be called when no scan waits: the map is told if it is old.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn idle(&mut self, mapper: &Mapper) -> io::Result<()> {
        if self.merged > self.merged_then && self.since.elapsed() >= LEAST_PAUSE {
            self.snapshot(mapper)?;
        }
        Ok(())
    }

    /// Ends the record with the finished map, and gives the sink back.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn finish(mut self, map: &Map, outcomes: &[Outcome], partial: Option<String>) -> io::Result<S> {
        self.tell_poses(outcomes)?;
        let change = self.map.change_to(map, self.scans);
        self.tell(Line::Map(change))?;
        self.tell(Line::End(End { partial }))?;
        Ok(self.sink)
    }

    fn tell(&mut self, line: Line) -> io::Result<()> {
        self.sink.take(&Arc::new(line))
    }

    fn is_due(&self) -> bool {
        match self.snapshots {
            Snapshots::Tripling => self.merged > 3 * self.merged_then,
            Snapshots::Share { share, longest } => {
                let grown = self.merged as f64 / self.merged_then.max(1) as f64;
                self.merged > self.merged_then
                    && (self.merged_then == 0
                        || self.took.mul_f64(grown) <= longest
                            && self.since.elapsed() >= LEAST_PAUSE.max(self.took.div_f64(share)))
            }
        }
    }

    fn snapshot(&mut self, mapper: &Mapper) -> io::Result<()> {
        let start = Instant::now();
        let map = mapper.map();
        self.tell_poses(&mapper.outcomes())?;
        let change = self.map.change_to(&map, self.scans);
        self.tell(Line::Map(change))?;
        self.merged_then = self.merged;
        self.since = Instant::now();
        self.took = self.since - start;
        Ok(())
    }

    fn tell_poses(&mut self, outcomes: &[Outcome]) -> io::Result<()> {
        match self.shown.change_to(outcomes) {
            Some(moved) => self.tell(Line::Moved(moved)),
            None => Ok(()),
        }
    }
}
