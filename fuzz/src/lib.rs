//! What all targets do: read a log of hostile bytes to its end, as `polymapper inspect` does.

use std::io::Cursor;

use polymapper_io::inspect::inspect;
use polymapper_io::log::{ReadOptions, open_reader};

/// Reads the log in `bytes`; everything but a panic, an endless loop or too much memory is right.
pub fn read(bytes: Vec<u8>) {
    read_with(bytes, ReadOptions::default());
}

/// The same with other options.
pub fn read_with(bytes: Vec<u8>, options: ReadOptions) {
    let options = ReadOptions {
        use_odometry: true,
        keep_raw: true,
        ..options
    };
    if let Ok(mut log) = open_reader("fuzz", Cursor::new(bytes), options) {
        let _ = inspect(&mut log);
    }
}

/// `start` and then `rest`.
#[must_use]
pub fn joined(start: &[u8], rest: &[u8]) -> Vec<u8> {
    [start, rest].concat()
}
