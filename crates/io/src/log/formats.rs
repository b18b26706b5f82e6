//! The formats of logs, and how a log comes to its own.

use super::{Entry, LogError, ReadOptions, Tally, Unit, bag, carmen, columns, db3, json_lines, mcap, rawlog};
use crate::input::Input;

/// One format's reader.
pub(super) trait ScanReader {
    /// The next laser line; `None` at the end of the part. After an error it is not asked again.
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>>;
    /// Reads on in the next part of the log, with all that was learned so far.
    fn continue_with(&mut self, input: Input) -> Result<(), LogError>;
    fn tally(&self) -> Tally;
}

pub(super) type OpenedReader = Result<Box<dyn ScanReader>, LogError>;

/// A format, and how to know and read it.
pub(super) struct Format {
    /// Name for people.
    pub name: &'static str,
    /// What its readers count.
    pub unit: Unit,
    /// Whether the first bytes of a file look like this format.
    pub recognise: fn(&[u8]) -> bool,
    pub open: fn(Input, &ReadOptions) -> OpenedReader,
}

/// Asked in order; the first that recognises the content reads it.
pub(super) const FORMATS: &[Format] = &[
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

pub(super) static COLUMNS: Format = Format {
    name: "text with a scan in a line",
    unit: Unit::Line,
    recognise: columns::recognise,
    open: columns::open,
};

/// The format of a file that begins with `head`; a declared layout settles it.
pub(super) fn format_of(head: &[u8], options: &ReadOptions) -> Option<&'static Format> {
    if options.layout.is_some() && !head.contains(&0) {
        return Some(&COLUMNS);
    }
    FORMATS.iter().chain([&COLUMNS]).find(|f| (f.recognise)(head))
}
