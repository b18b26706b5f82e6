//! Laser logs: from a file name to scans in file order.
//!
//! [`open`] looks at the first decompressed bytes, picks the format that knows them and hands out one
//! [`Entry`] a laser line or message: a scan, or the fault that makes it useless. One bad line costs one scan;
//! a stream that breaks off ends the log with an error after everything before it was given out. A folder is
//! read as the parts of one log, in the natural order of their names.
//!
//! A format is one module with two functions, `recognise` (does the head look like mine?) and `open`,
//! listed in `formats.rs`.

mod bag;
mod carmen;
mod chunks;
mod columns;
mod db3;
mod entry;
mod error;
mod folder;
mod formats;
mod json_lines;
mod keeper;
mod live;
mod mcap;
mod number;
mod opened;
mod rawlog;
mod ros;
mod text;

use std::collections::VecDeque;
use std::path::Path;

use crate::input::Input;
pub use crate::input::ReadProgress;
pub use columns::{Layout, LayoutError};
pub use entry::{BadScan, Entry, LogScan, ReadOptions, Tally};
pub use error::{LineFault, LogError, Unit};
use formats::{Format, ScanReader, format_of};
pub use json_lines::write_json_line;
pub use live::open_live;
pub use opened::Log;

/// More beams than any 2D scanner has a turn; keeps a hostile header from costing memory.
const MAX_BEAMS: usize = 65_536;
/// Kinds of messages, topics or notes that are kept by name; what is beyond is counted together.
const MAX_NAMES: usize = 64;

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
