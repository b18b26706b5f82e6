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
    if let Ok(mut log) = open_reader("fuzz", Cursor::new(with_small_blocks(bytes)), options) {
        let _ = inspect(&mut log);
    }
}

/// Makes every bzip2 stream in `bytes` one of blocks of 100 kB.
///
/// A decompressor clears 4 bytes of memory for each byte of a block before it reads the first bit: with the usual
/// blocks of 900 kB nothing else is left to be measured (4200 runs/s of bags, instead of over 20000).
fn with_small_blocks(mut bytes: Vec<u8>) -> Vec<u8> {
    const MAGIC: &[u8] = b"BZh";
    for at in 0..bytes.len().saturating_sub(MAGIC.len()) {
        if bytes[at..].starts_with(MAGIC) {
            bytes[at + MAGIC.len()] = b'1';
        }
    }
    bytes
}

/// `start` and then `rest`.
#[must_use]
pub fn joined(start: &[u8], rest: &[u8]) -> Vec<u8> {
    [start, rest].concat()
}
