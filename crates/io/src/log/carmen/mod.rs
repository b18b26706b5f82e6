//! CARMEN logs: text, one message a line, the kind first.
//!
//! In go lines, out come the scans of one laser: the front laser unless told. Its kind is picked from the
//! head of the file by the order of [`KINDS`], since logs may hold the same revolution twice
//! (`RAWLASER1` and `ROBOTLASER1`) or a front and a rear laser (`FLASER`, `RLASER`). Every other message
//! is counted. Two layouts of laser lines exist, one module each:
//!
//! - [`flaser`]: ranges without geometry, `FLASER`, `RLASER`, `LASER3`..
//! - [`robotlaser`]: geometry in every line, `ROBOTLASERn`, `RAWLASERn`
//!
//! The layouts follow the comments that CARMEN writes at the head of its own logs.

mod fields;
mod flaser;
mod robotlaser;

use super::keeper::{Keeper, Reading};
use super::text::{TextLines, as_text};
use super::{Entry, LineFault, LogError, MAX_BEAMS, ReadOptions, ScanReader, Tally, Unit};
use crate::input::Input;
use crate::lines::Line;

/// The kinds of laser lines, in the order in which they are preferred.
const KINDS: &[&str] = &[
    "FLASER",
    "ROBOTLASER1",
    "RAWLASER1",
    "ROBOTLASER0",
    "RAWLASER0",
    "RLASER",
    "ROBOTLASER2",
    "RAWLASER2",
    "LASER3",
    "RAWLASER3",
    "LASER4",
    "RAWLASER4",
    "LASER5",
    "RAWLASER5",
];

/// Messages that CARMEN and the tools around it write beside the lasers, and the graphs (g2o, TORO) that lasers
/// are put into.
const OTHER_KINDS: &[&str] = &[
    "PARAM",
    "SYNC",
    "ODOM",
    "TRUEPOS",
    "NEFF",
    "VERTEX_SE2",
    "EDGE_SE2",
    "VERTEX2",
    "EDGE2",
];

fn keyword(line: &[u8]) -> &[u8] {
    let end = line
        .iter()
        .position(u8::is_ascii_whitespace)
        .unwrap_or(line.len());
    &line[..end]
}

fn laser_kind(keyword: &[u8]) -> Option<&'static str> {
    KINDS.iter().copied().find(|k| k.as_bytes() == keyword)
}

/// Whether some line of the head starts with a kind of message that CARMEN knows.
pub(super) fn recognise(head: &[u8]) -> bool {
    !head.contains(&0)
        && head.split(|&b| b == b'\n').any(|line| {
            let word = keyword(line.trim_ascii_start());
            laser_kind(word).is_some() || OTHER_KINDS.iter().any(|k| k.as_bytes() == word)
        })
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    let laser = match &options.laser {
        Some(laser) => Some(laser.clone()),
        None => preferred_laser(&input.head).map(str::to_owned),
    };
    Ok(Box::new(CarmenReader {
        lines: TextLines::new(input),
        use_odometry: options.use_odometry,
        laser,
        flaser: flaser::Layout::default(),
        keeper: Keeper::new(Unit::Line, options),
    }))
}

/// The kind to read among those that the head holds.
fn preferred_laser(head: &[u8]) -> Option<&'static str> {
    let rank = |kind: &&str| KINDS.iter().position(|k| k == kind);
    head.split(|&b| b == b'\n')
        .filter_map(|line| laser_kind(keyword(line.trim_ascii_start())))
        .min_by_key(rank)
}

struct CarmenReader {
    lines: TextLines,
    use_odometry: bool,
    /// Kind of line that is read; `None` until the first laser line, when the head holds none.
    laser: Option<String>,
    flaser: flaser::Layout,
    keeper: Keeper,
}

impl ScanReader for CarmenReader {
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>> {
        loop {
            let line = match self.lines.next_line()? {
                Ok(line) => line,
                Err(broken) => return Some(Err(broken)),
            };
            let word = keyword(line.bytes);
            if word.is_empty() || word[0] == b'#' {
                continue;
            }
            if self.laser.is_none() {
                self.laser = laser_kind(word).map(str::to_owned);
            }
            if self.laser.as_ref().is_some_and(|l| l.as_bytes() == word) {
                let number = line.number;
                let notes = &mut self.keeper.tally.notes;
                let parsed = parse(&line, self.use_odometry, &mut self.flaser, notes);
                return Some(Ok(self.keeper.entry(number, parsed)));
            }
            self.keeper.count_other(word);
        }
    }

    fn continue_with(&mut self, input: Input) -> Result<(), LogError> {
        self.lines.continue_with(input);
        Ok(())
    }

    fn tally(&self) -> Tally {
        let mut tally = self.lines.tally(&self.keeper);
        tally.laser.clone_from(&self.laser);
        tally.notes.extend(self.flaser.note());
        tally
    }
}

fn parse(
    line: &Line<'_>,
    use_odometry: bool,
    flaser: &mut flaser::Layout,
    notes: &mut Vec<String>,
) -> Result<Reading, LineFault> {
    let text = as_text(line)?;
    if text.starts_with("ROBOTLASER") || text.starts_with("RAWLASER") {
        robotlaser::parse(text, use_odometry)
    } else {
        flaser.parse(text, use_odometry, notes)
    }
}
