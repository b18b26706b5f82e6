//! Laser logs: from a file name to scans in file order.
//!
//! [`open`] looks at the first decompressed bytes, picks the format that knows them and hands out one
//! [`Entry`] a laser line or message: a scan, or the fault that makes it useless. One bad line costs one scan;
//! a stream that breaks off ends the log with an error after everything before it was given out. A folder is
//! read as the parts of one log, in the natural order of their names.
//!
//! A format is one module with two functions, `recognise` (does the head look like mine?) and `open`,
//! listed in `FORMATS`.

mod bag;
mod carmen;
mod chunks;
mod columns;
mod db3;
mod error;
mod folder;
mod json_lines;
mod keeper;
mod live;
mod mcap;
mod number;
mod rawlog;
mod ros;

use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};

use polymapper_core::geometry::Pose;
use polymapper_core::scan::Scan;

use crate::input::Input;
pub use crate::input::ReadProgress;
pub use columns::{Layout, LayoutError};
pub use error::{LineFault, LogError, Unit};
pub use json_lines::write_json_line;
pub use live::open_live;

/// More beams than any 2D scanner has a turn; keeps a hostile header from costing memory.
const MAX_BEAMS: usize = 65_536;
/// Kinds of messages, topics or notes that are kept by name; what is beyond is counted together.
const MAX_NAMES: usize = 64;

/// What is read from a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Hand out the poses that the log holds. Without it they are not even parsed.
    pub use_odometry: bool,
    /// Message kind (`RLASER`) or topic (`/rear_scan`) of the laser to read, where the log has several; the best
    /// one unless told.
    pub laser: Option<String>,
    /// What the columns of a text file are; told by the file unless given.
    pub layout: Option<Layout>,
    /// Read on behind a place where a recording does not hang together, as far as that can be told.
    pub salvage: bool,
    /// Hand out the ranges as they stand in the log, too.
    pub keep_raw: bool,
}

/// One scan of a log.
#[derive(Clone, Debug)]
pub struct LogScan {
    /// 0-based place among the lines of this laser in file order; lines that cannot be used count too.
    pub index: usize,
    /// 1-based number of the line or message in its file.
    pub line: u64,
    /// Time stamp, seconds; `None` where the format has none. File order is the true order: stamps
    /// may run backwards.
    pub stamp_s: Option<f64>,
    /// Ranges and geometry.
    pub scan: Scan,
    /// Pose that the robot's own odometry gave (`odometry_from_scan` or the robot's, as the log has it); only
    /// with [`ReadOptions::use_odometry`].
    pub odometry: Option<Pose>,
    /// The ranges before no returns were marked, metres, counter-clockwise; only with [`ReadOptions::keep_raw`].
    pub raw_ranges_m: Option<Vec<f64>>,
}

/// A line or message of the laser that holds no usable scan.
#[derive(Clone, Debug, PartialEq)]
pub struct BadScan {
    /// As in [`LogScan::index`].
    pub index: usize,
    /// As in [`LogScan::line`].
    pub line: u64,
    /// What the number counts.
    pub unit: Unit,
    /// What is wrong with it.
    pub fault: LineFault,
}

/// What one laser line gave.
#[derive(Clone, Debug)]
pub enum Entry {
    /// A scan.
    Scan(LogScan),
    /// A line that could not be used.
    Bad(BadScan),
}

/// What went past while a log was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Lines of text, or messages.
    pub lines: u64,
    /// Bytes after decompression.
    pub bytes: u64,
    /// Message kind or topic of the laser that was read, once known.
    pub laser: Option<String>,
    /// Scans handed out.
    pub scans: usize,
    /// Lines of the laser that could not be used.
    pub bad_scans: usize,
    /// Scans whose stamp is earlier than that of the scan before.
    pub stamps_backwards: usize,
    /// Messages of other kinds or topics, by name.
    pub other_messages: BTreeMap<String, u64>,
    /// Why those are not used, by the same names; only where there is more to say than that they are no scans.
    pub reasons: BTreeMap<String, String>,
    /// What of the log was not read although it does not break off, in words for the user.
    pub lost: Option<String>,
    /// What was assumed, in words for the user.
    pub notes: Vec<String>,
}

/// One format's reader.
trait ScanReader {
    /// The next laser line; `None` at the end of the part. After an error there is no more.
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>>;
    /// Reads on in the next part of the log, with all that was learned so far.
    fn continue_with(&mut self, input: Input) -> Result<(), LogError>;
    fn tally(&self) -> Tally;
}

type OpenedReader = Result<Box<dyn ScanReader>, LogError>;

struct Format {
    name: &'static str,
    unit: Unit,
    /// Whether the first bytes of a file look like this format.
    recognise: fn(&[u8]) -> bool,
    open: fn(Input, &ReadOptions) -> OpenedReader,
}

/// Asked in order; the first that recognises the content reads it.
const FORMATS: &[Format] = &[
    Format {
        name: "ROS 1 bag",
        unit: Unit::Message,
        recognise: bag::recognise,
        open: bag::open,
    },
    Format {
        name: "MCAP",
        unit: Unit::Message,
        recognise: mcap::recognise,
        open: mcap::open,
    },
    Format {
        name: "ROS 2 sqlite3",
        unit: Unit::Message,
        recognise: db3::recognise,
        open: db3::open,
    },
    Format {
        name: "MRPT rawlog",
        unit: Unit::Message,
        recognise: rawlog::recognise,
        open: rawlog::open,
    },
    Format {
        name: "JSON lines",
        unit: Unit::Line,
        recognise: json_lines::recognise,
        open: json_lines::open,
    },
    Format {
        name: "CARMEN",
        unit: Unit::Line,
        recognise: carmen::recognise,
        open: carmen::open,
    },
];

static COLUMNS: Format = Format {
    name: "text with a scan in a line",
    unit: Unit::Line,
    recognise: columns::recognise,
    open: columns::open,
};

/// The format of a file that begins with `head`; a declared layout settles it.
fn format_of(head: &[u8], options: &ReadOptions) -> Option<&'static Format> {
    if options.layout.is_some() && !head.contains(&0) {
        return Some(&COLUMNS);
    }
    FORMATS.iter().chain([&COLUMNS]).find(|f| (f.recognise)(head))
}

/// An opened log: an iterator over its laser lines.
pub struct Log {
    reader: Box<dyn ScanReader>,
    format: &'static Format,
    name: String,
    place: String,
    compression: Option<&'static str>,
    progress: ReadProgress,
    /// Files that follow, where the log is a folder.
    parts: VecDeque<PathBuf>,
    options: ReadOptions,
    notes: Vec<String>,
    ended: bool,
}

/// Opens the log at `path` (`-`: standard input), plain or packed, in any format that is recognised, or the
/// folder that holds the parts of a log.
///
/// # Errors
/// No such file, a folder without a log, an empty file, a file that cannot be read, or content that is no known log.
pub fn open(path: &Path, options: ReadOptions) -> Result<Log, LogError> {
    if !path.is_dir() {
        return open_input(Input::open(path)?, &options);
    }
    let name = path.display().to_string();
    let found = folder::first_part(path, &options)?;
    let mut log = open_input(found.input, &options)?;
    log.name = name;
    log.parts = found.rest;
    log.notes = found.notes;
    Ok(log)
}

/// Opens a log that is in memory, as [`open`] does; `name` is for messages.
///
/// # Errors
/// Nothing in it, or content that is no known log.
pub fn open_bytes(name: &str, bytes: &'static [u8], options: ReadOptions) -> Result<Log, LogError> {
    open_reader(name, bytes, options)
}

/// Opens a log that comes from anywhere, as [`open`] does; `name` is for messages.
///
/// # Errors
/// Nothing in it, or content that is no known log.
pub fn open_reader(
    name: &str,
    source: impl std::io::Read + 'static,
    options: ReadOptions,
) -> Result<Log, LogError> {
    open_input(Input::from_reader(name.to_owned(), source, None)?, &options)
}

fn open_input(input: Input, options: &ReadOptions) -> Result<Log, LogError> {
    let Some(format) = format_of(&input.head, options) else {
        return Err(LogError::unrecognised(input.name, &input.head));
    };
    let name = input.name.clone();
    let progress = input.progress.clone();
    let compression = input.compression.map(|c| c.name);
    Ok(Log {
        reader: (format.open)(input, options)?,
        format,
        place: name.clone(),
        name,
        compression,
        progress,
        parts: VecDeque::new(),
        options: options.clone(),
        notes: Vec::new(),
        ended: false,
    })
}

impl Log {
    /// Name of the format.
    #[must_use]
    pub fn format(&self) -> &'static str {
        self.format.name
    }

    /// How the file, or the first of its parts, is packed: `gzip`, `bzip2`, `zstd`.
    #[must_use]
    pub fn compression(&self) -> Option<&'static str> {
        self.compression
    }

    /// Name of the file or folder, for messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Name of the file that is being read: one of the parts where the log is a folder.
    #[must_use]
    pub fn place(&self) -> &str {
        &self.place
    }

    /// How far the reading has come.
    #[must_use]
    pub fn progress(&self) -> ReadProgress {
        self.progress.clone()
    }

    /// What went past so far.
    #[must_use]
    pub fn tally(&self) -> Tally {
        let mut tally = self.reader.tally();
        tally.notes.extend(self.notes.iter().cloned());
        tally
    }

    /// Goes on to the next part; `false` when there is none.
    fn next_part(&mut self) -> Result<bool, LogError> {
        while let Some(path) = self.parts.pop_front() {
            let opened = folder::open_part(&path, self.format, &self.options);
            match opened {
                Ok(input) => {
                    input.name.clone_into(&mut self.place);
                    self.progress = input.progress.clone();
                    self.reader.continue_with(input)?;
                    return Ok(true);
                }
                Err(why) => folder::left_out(&mut self.notes, &path, &why),
            }
        }
        Ok(false)
    }

    /// The end of the log: an error when no laser line came.
    fn end(&mut self) -> Option<LogError> {
        self.ended = true;
        let tally = self.reader.tally();
        if tally.scans + tally.bad_scans > 0 {
            return None;
        }
        let held: Vec<String> = tally
            .other_messages
            .iter()
            .map(|(kind, n)| match tally.reasons.get(kind) {
                Some(reason) => format!("{n} {kind} ({reason})"),
                None => format!("{n} {kind}"),
            })
            .collect();
        let others = if held.is_empty() {
            String::new()
        } else {
            format!("; it holds {}", held.join(", "))
        };
        Some(LogError::NoScan {
            name: self.name.clone(),
            lines: tally.lines,
            unit: self.format.unit,
            others,
        })
    }
}

impl Iterator for Log {
    type Item = Result<Entry, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        loop {
            if let Some(entry) = self.reader.next_entry() {
                self.ended = entry.is_err();
                return Some(entry);
            }
            match self.next_part() {
                Ok(true) => {}
                Ok(false) => return self.end().map(Err),
                Err(error) => {
                    self.ended = true;
                    return Some(Err(error));
                }
            }
        }
    }
}
