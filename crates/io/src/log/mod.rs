//! Laser logs: from a file name to scans in file order.
//!
//! [`open`] looks at the first decompressed bytes, picks the format that knows them and hands out one
//! [`Entry`] a laser line: a scan, or the fault that makes the line useless. One bad line costs one scan;
//! a stream that breaks off ends the log with an error after everything before it was given out.
//!
//! A format is one module with two functions, `recognise` (does the head look like mine?) and `open`,
//! listed in `FORMATS`.

mod carmen;
mod error;
mod json_lines;
mod live;

use std::collections::BTreeMap;
use std::path::Path;

use polymapper_core::geometry::Pose;
use polymapper_core::scan::Scan;

use crate::input::Input;
pub use crate::input::ReadProgress;
pub use error::{LineFault, LogError};
pub use json_lines::write_json_line;
pub use live::open_live;

/// What is read from a log.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Hand out the poses that the log holds. Without it they are not even parsed.
    pub use_odometry: bool,
    /// Message kind of the laser to read (`RLASER`), where the log has several; the front laser unless told.
    pub laser: Option<String>,
}

/// One scan of a log.
#[derive(Clone, Debug)]
pub struct LogScan {
    /// 0-based place among the lines of this laser in file order; lines that cannot be used count too.
    pub index: usize,
    /// 1-based line number in the file.
    pub line: u64,
    /// Time stamp of the line, seconds; `None` where the format has none. File order is the true order: stamps
    /// may run backwards.
    pub stamp_s: Option<f64>,
    /// Ranges and geometry.
    pub scan: Scan,
    /// Pose that the robot's own odometry gave (`odometry_from_scan` or the robot's, as the log has it); only
    /// with [`ReadOptions::use_odometry`].
    pub odometry: Option<Pose>,
}

/// A line of the laser that holds no usable scan.
#[derive(Clone, Debug, PartialEq)]
pub struct BadScan {
    /// As in [`LogScan::index`].
    pub index: usize,
    /// 1-based line number in the file.
    pub line: u64,
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
    /// Message kind of the laser that was read, once known.
    pub laser: Option<String>,
    /// Scans handed out.
    pub scans: usize,
    /// Lines of the laser that could not be used.
    pub bad_scans: usize,
    /// Scans whose stamp is earlier than that of the scan before.
    pub stamps_backwards: usize,
    /// Messages of other kinds, by name.
    pub other_messages: BTreeMap<String, u64>,
    /// What was assumed, in words for the user.
    pub notes: Vec<String>,
}

/// One format's reader.
trait ScanReader {
    /// The next laser line; `None` at the end. After an error there is no more.
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>>;
    fn tally(&self) -> Tally;
}

struct Format {
    name: &'static str,
    /// Whether the first bytes of a file look like this format.
    recognise: fn(&[u8]) -> bool,
    open: fn(Input, ReadOptions) -> Result<Box<dyn ScanReader>, LogError>,
}

/// Asked in order; the first that recognises the content reads it.
const FORMATS: &[Format] = &[
    Format {
        name: "CARMEN",
        recognise: carmen::recognise,
        open: carmen::open,
    },
    Format {
        name: "JSON lines",
        recognise: json_lines::recognise,
        open: json_lines::open,
    },
];

/// An opened log: an iterator over its laser lines.
pub struct Log {
    reader: Box<dyn ScanReader>,
    format: &'static str,
    name: String,
    progress: ReadProgress,
}

/// Opens the log at `path` (`-`: standard input), plain or gzip, in any format that is recognised.
///
/// # Errors
/// No such file, a directory, an empty file, a file that cannot be read, or content that is no known log.
pub fn open(path: &Path, options: ReadOptions) -> Result<Log, LogError> {
    open_input(Input::open(path)?, options)
}

/// Opens a log that is in memory, as [`open`] does; `name` is for messages.
///
/// # Errors
/// Nothing in it, or content that is no known log.
pub fn open_bytes(name: &str, bytes: &'static [u8], options: ReadOptions) -> Result<Log, LogError> {
    let input = Input::from_reader(name.to_owned(), bytes, Some(bytes.len() as u64))?;
    open_input(input, options)
}

fn open_input(input: Input, options: ReadOptions) -> Result<Log, LogError> {
    let Some(format) = FORMATS.iter().find(|f| (f.recognise)(&input.head)) else {
        return Err(LogError::unrecognised(input.name, &input.head));
    };
    let name = input.name.clone();
    let progress = input.progress.clone();
    Ok(Log {
        reader: (format.open)(input, options)?,
        format: format.name,
        name,
        progress,
    })
}

impl Log {
    /// Name of the format.
    #[must_use]
    pub fn format(&self) -> &'static str {
        self.format
    }

    /// Name of the file, for messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How far the reading has come.
    #[must_use]
    pub fn progress(&self) -> ReadProgress {
        self.progress.clone()
    }

    /// What went past so far.
    #[must_use]
    pub fn tally(&self) -> Tally {
        self.reader.tally()
    }
}

impl Iterator for Log {
    type Item = Result<Entry, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.reader.next_entry()
    }
}
