//! The lines of a log that is text, through all its parts.
//!
//! In go the parts, out come their lines; a fault of the stream comes out as one that names the file and the line.

use super::keeper::Keeper;
use super::{LineFault, LogError, Tally, Unit};
use crate::input::Input;
use crate::lines::{Line, Lines, MAX_LINE_BYTES};

/// Reads line after line of a log.
pub(super) struct TextLines {
    /// Name of the part, for messages.
    name: String,
    lines: Lines,
    /// Lines of the parts before this one.
    lines_before: u64,
}

impl TextLines {
    pub fn new(input: Input) -> Self {
        Self {
            name: input.name.clone(),
            lines: Lines::new(input.into_stream()),
            lines_before: 0,
        }
    }

    /// The next line of this part; `None` at its end.
    pub fn next_line(&mut self) -> Option<Result<Line<'_>, LogError>> {
        let number = self.lines.number();
        match self.lines.next_line() {
            Ok(line) => line.map(Ok),
            Err(source) => Some(Err(LogError::Broken {
                name: self.name.clone(),
                line: number,
                unit: Unit::Line,
                source,
            })),
        }
    }

    /// Reads on in the next part.
    pub fn continue_with(&mut self, input: Input) {
        self.lines_before += self.lines.number();
        input.name.clone_into(&mut self.name);
        self.lines.continue_with(input.into_stream());
    }

    /// What `keeper` counted, with the lines and bytes that were read.
    pub fn tally(&self, keeper: &Keeper) -> Tally {
        Tally {
            lines: self.lines_before + self.lines.number(),
            bytes: self.lines.read_bytes(),
            ..keeper.tally.clone()
        }
    }
}

/// The line as text.
///
/// # Errors
/// It is longer than any line of a scan, or no text.
pub(super) fn as_text<'a>(line: &Line<'a>) -> Result<&'a str, LineFault> {
    std::str::from_utf8(as_bytes(line)?).map_err(|_| LineFault::NotText)
}

/// The whole line.
///
/// # Errors
/// It is longer than any line of a scan.
pub(super) fn as_bytes<'a>(line: &Line<'a>) -> Result<&'a [u8], LineFault> {
    if line.too_long {
        return Err(LineFault::TooLong {
            limit: MAX_LINE_BYTES,
        });
    }
    Ok(line.bytes)
}
