//! An opened log: its entries through all its parts.

use std::collections::VecDeque;
use std::path::PathBuf;

use super::formats::{Format, ScanReader};
use super::{Entry, LogError, ReadOptions, ReadProgress, Tally, folder};

/// An opened log: an iterator over its laser lines.
pub struct Log {
    pub(super) reader: Box<dyn ScanReader>,
    pub(super) format: &'static Format,
    pub(super) name: String,
    pub(super) place: String,
    pub(super) compression: Option<&'static str>,
    pub(super) progress: ReadProgress,
    /// Files that follow, where the log is a folder.
    pub(super) parts: VecDeque<PathBuf>,
    pub(super) options: ReadOptions,
    pub(super) notes: Vec<String>,
    pub(super) ended: bool,
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
