//! What all targets do with hostile bytes: read a log to its end as `polymapper inspect` does, or a drawing as
//! `polymapper import` does.

use std::io::Cursor;
use std::sync::LazyLock;

use polymapper_io::import::{ImportOptions, import_bytes};
use polymapper_io::inspect::inspect;
use polymapper_io::log::{ReadOptions, open_reader};
use polymapper_io::out::{MapFile, write_map};

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

/// Makes every bzip2 stream in `bytes` one of blocks of 100 kB.
///
/// A decompressor clears 4 bytes of memory for each byte of a block before it reads the first bit: with the usual
/// blocks of 900 kB there is time for little else (4200 bags a second, with this 20000).
#[must_use]
pub fn with_small_blocks(mut bytes: Vec<u8>) -> Vec<u8> {
    const MAGIC: &[u8] = b"BZh";
    for at in 0..bytes.len().saturating_sub(MAGIC.len()) {
        if bytes[at..].starts_with(MAGIC) {
            bytes[at + MAGIC.len()] = b'1';
        }
    }
    bytes
}

/// How packed files begin: gzip, bzip2, zstd.
pub const PACKED: &[&[u8]] = &[&[0x1f, 0x8b], b"BZh", &[0x28, 0xb5, 0x2f, 0xfd]];

/// Metres, and a place on Earth, so that a drawing in any system goes in.
static OPTIONS: LazyLock<ImportOptions> = LazyLock::new(|| ImportOptions {
    base: None,
    georef: "48,7.8,30".parse().ok(),
    metres_per_unit: Some(0.5),
});

/// Reads the drawing in `bytes`. When it gives a map, that map is written and read back.
pub fn import(bytes: &[u8]) {
    let Ok(imported) = import_bytes("fuzz", bytes, &OPTIONS) else {
        return;
    };
    let lines = imported.map.polylines.len();
    let file = MapFile {
        map: imported.map,
        partial: None,
    };
    let mut written = Vec::new();
    write_map(&mut written, &file).expect("a map is written to memory");
    let again = import_bytes("again", &written, &ImportOptions::default());
    let again =
        again.unwrap_or_else(|fault| panic!("a map was imported, but what is written of it: {fault}"));
    assert_eq!(again.map.polylines.len(), lines);
}

/// `start` and then `rest`.
#[must_use]
pub fn joined(start: &[u8], rest: &[u8]) -> Vec<u8> {
    [start, rest].concat()
}
