use std::{fmt, io};

use polymapper_core::scan::ScanError;

/// What the numbers in messages about a log count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Lines of text, from 1.
    Line,
    /// Messages or records, from 1.
    Message,
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Line => "line",
            Self::Message => "message",
        })
    }
}

/// Why a log cannot be read, or not to its end.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// Nothing at that place.
    #[error("{name}: no such file")]
    Missing {
        /// Name of the file.
        name: String,
    },
    /// A folder without a log.
    #[error("{name} is a directory; a log file is expected, or a directory with the parts of a log")]
    Directory {
        /// Name of the directory.
        name: String,
    },
    /// Not one byte.
    #[error("{name} is empty; a laser log is expected")]
    Empty {
        /// Name of the file.
        name: String,
    },
    /// The system, or the decompressor, refused the first bytes.
    #[error("{name} cannot be read")]
    Unreadable {
        /// Name of the file.
        name: String,
        /// What the system says.
        source: io::Error,
    },
    /// No format knows the content.
    #[error("{name} is no laser log that is known here: {found}; expected is one of {formats}")]
    Unrecognised {
        /// Name of the file.
        name: String,
        /// How it starts.
        found: String,
        /// The formats that are known.
        formats: String,
    },
    /// Ranges, but nothing that says where they look.
    #[error(
        "{name}: nothing says at which bearings its ranges were measured; tell it, such as `--layout \"range_m* first_deg=-90 step_deg=0.5\"`"
    )]
    NoBearings {
        /// Name of the file.
        name: String,
    },
    /// A log without a line of the laser.
    #[error("{name}, {lines} {}s: no scan in it{others}", unit)]
    NoScan {
        /// Name of the file.
        name: String,
        /// Lines or messages read.
        lines: u64,
        /// Which of the two.
        unit: Unit,
        /// What it holds instead, as the end of the sentence.
        others: String,
    },
    /// The stream cannot be read on. Everything before was given out.
    #[error("{name} breaks off after {unit} {line}")]
    Broken {
        /// Name of the file.
        name: String,
        /// Last line or message that was read whole.
        line: u64,
        /// Which of the two.
        unit: Unit,
        /// What the system or the decompressor says.
        source: io::Error,
    },
}

impl LogError {
    /// The error for content that no format knows, quoting how it starts.
    pub(crate) fn unrecognised(name: String, head: &[u8]) -> Self {
        let is_text = std::str::from_utf8(head).map_or_else(|e| e.error_len().is_none(), |_| true)
            && !head.contains(&0);
        let found = if is_text {
            let first = head
                .split(|&b| b == b'\n')
                .map(<[u8]>::trim_ascii)
                .find(|l| !l.is_empty());
            format!("its first line is `{}`", excerpt(first.unwrap_or_default()))
        } else {
            let bytes: Vec<String> = head.iter().take(8).map(|b| format!("{b:02x}")).collect();
            format!("binary data, {} ..", bytes.join(" "))
        };
        let formats: Vec<&str> = super::formats::FORMATS
            .iter()
            .chain([&super::formats::COLUMNS])
            .map(|f| f.name)
            .collect();
        Self::Unrecognised {
            name,
            found,
            formats: formats.join(", "),
        }
    }
}

/// The first characters of a text from a file, safe to print.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    const SHOWN: usize = 40;
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4 * SHOWN)]);
    let mut shown: String = text.chars().filter(|c| !c.is_control()).take(SHOWN).collect();
    if shown.len() < bytes.len() {
        shown.push_str("..");
    }
    shown
}

/// What is wrong with a laser line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LineFault {
    /// More bytes than a line may have.
    #[error("the line is longer than {limit} bytes")]
    TooLong {
        /// The limit, bytes.
        limit: usize,
    },
    /// Bytes that are no text.
    #[error("the line is not text")]
    NotText,
    /// A field that should be a number is none.
    #[error("{field} is `{found}`, a number is expected")]
    NotANumber {
        /// Which field.
        field: String,
        /// What stands there.
        found: String,
    },
    /// A number of readings that no scanner has.
    #[error("the header says {header} ranges, at least 1 and at most {limit} are expected")]
    Beams {
        /// Number in the line.
        header: u64,
        /// The limit.
        limit: usize,
    },
    /// Header and ranges disagree.
    #[error("{ranges} ranges, but the header says {header}")]
    BeamCount {
        /// Ranges found.
        ranges: usize,
        /// Ranges announced.
        header: usize,
    },
    /// The line ends too early.
    #[error(
        "the line is cut: {found} numbers after the header, which says {header} ranges with {after} more fields behind them"
    )]
    Cut {
        /// Numbers found after the header.
        found: usize,
        /// Ranges announced.
        header: usize,
        /// Fields that follow the ranges in a whole line.
        after: usize,
    },
    /// A binary message that does not hold what it announces.
    #[error("{what}")]
    Malformed {
        /// What is wrong, with both numbers.
        what: String,
    },
    /// Bearings that make no sense.
    #[error(transparent)]
    Geometry(#[from] ScanError),
}

impl LineFault {
    /// A short name of the kind of fault, to count by.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        match self {
            Self::TooLong { .. } => "too long",
            Self::NotText => "not text",
            Self::NotANumber { .. } => "not a number",
            Self::Beams { .. } => "number of beams",
            Self::BeamCount { .. } => "beams and header disagree",
            Self::Cut { .. } => "cut",
            Self::Malformed { .. } => "malformed",
            Self::Geometry(_) => "bearings",
        }
    }
}
