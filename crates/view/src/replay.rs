//! `replay.jsonl.gz`: a record as a file, and back.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::sync::Arc;

use flate2::Compression;
use flate2::bufread::MultiGzDecoder;
use flate2::write::GzEncoder;

use crate::record::{FORMAT, Line, VERSION};
use crate::recorder::Sink;
use crate::store::Store;

/// Name of the file in the folder of a build.
pub const FILE: &str = "replay.jsonl.gz";
/// The longest line that is read. The longest seen is the last map of a large building, half a megabyte.
const MAX_LINE_BYTES: u64 = 64 * 1024 * 1024;

/// Why a file is no record.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The system or the decompressor does not give it.
    #[error("the record breaks off after line {line}")]
    Broken {
        /// Last line that was read whole.
        line: u64,
        /// What the system says.
        source: io::Error,
    },
    /// A line that is none of a record.
    #[error("line {line} is no line of a record")]
    Line {
        /// 1-based.
        line: u64,
        /// What is wrong, with its place in the line.
        source: serde_json::Error,
    },
    /// A line longer than any record has.
    #[error("line {line} is longer than {MAX_LINE_BYTES} bytes")]
    TooLong {
        /// 1-based.
        line: u64,
    },
    /// A record of another kind or version.
    #[error(
        "the first line says format \"{found}\" version {version}; this program reads \"{FORMAT}\" up to {VERSION}"
    )]
    Format {
        /// What it says.
        found: String,
        /// The version.
        version: u64,
    },
    /// The first line does not say what follows.
    #[error("the first line is not `about`")]
    NoAbout,
}

/// Writes a record, packed.
pub struct ReplayWriter<W: Write> {
    out: GzEncoder<W>,
    keeps: fn(&Line) -> bool,
    /// The line that is being written: packed whole, it takes half the time of packing number by number.
    text: Vec<u8>,
}

impl<W: Write> ReplayWriter<W> {
    /// Everything.
    pub fn new(out: W) -> Self {
        Self {
            out: GzEncoder::new(out, Compression::new(4)),
            keeps: |_| true,
            text: Vec::new(),
        }
    }

    /// Without what only single scans show: for `report.html`.
    pub fn light(out: W) -> Self {
        Self {
            out: GzEncoder::new(out, Compression::new(6)),
            keeps: |line| match line {
                Line::Detail(_) => false,
                Line::Walls(walls) => !walls.moving.is_empty(),
                _ => true,
            },
            text: Vec::new(),
        }
    }

    /// Ends the file.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn finish(self) -> io::Result<W> {
        self.out.finish()
    }
}

impl<W: Write> Sink for ReplayWriter<W> {
    fn take(&mut self, line: &Arc<Line>) -> io::Result<()> {
        if (self.keeps)(line) {
            self.text.clear();
            serde_json::to_writer(&mut self.text, &**line)?;
            self.text.push(b'\n');
            self.out.write_all(&self.text)?;
        }
        Ok(())
    }
}

/// Reads a packed record into `store`, line by line, so that pages can show the beginning while the rest is read.
///
/// # Errors
/// A file that breaks off, is no record, or one of a later version; what came before the fault is in the store.
pub fn read_replay(file: impl Read, store: &Store) -> Result<(), ReplayError> {
    let mut stream = BufReader::with_capacity(1 << 16, MultiGzDecoder::new(BufReader::new(file)));
    let mut number = 0;
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        let read = (&mut stream).take(MAX_LINE_BYTES).read_until(b'\n', &mut buffer);
        match read {
            Ok(0) => return Ok(()),
            Ok(n) if n as u64 == MAX_LINE_BYTES => return Err(ReplayError::TooLong { line: number + 1 }),
            Ok(_) => number += 1,
            Err(source) => return Err(ReplayError::Broken { line: number, source }),
        }
        let text = buffer.trim_ascii();
        let line: Line =
            serde_json::from_slice(text).map_err(|source| ReplayError::Line { line: number, source })?;
        match &line {
            Line::About(about) if about.format != FORMAT || about.version > VERSION => {
                return Err(ReplayError::Format {
                    found: about.format.clone(),
                    version: about.version,
                });
            }
            Line::About(_) => {}
            _ if number == 1 => return Err(ReplayError::NoAbout),
            _ => {}
        }
        store.push(&line, text.to_vec());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{About, Detail, End, Frame};

    fn record() -> Vec<u8> {
        let mut writer = ReplayWriter::new(Vec::new());
        for line in [
            Line::About(About {
                format: FORMAT.to_owned(),
                version: VERSION,
                generator: "test".to_owned(),
                log: "a.log".to_owned(),
                missing: None,
            }),
            Line::Detail(Box::default()),
            Line::Frame(Frame::default()),
            Line::End(End { partial: None }),
        ] {
            writer.take(&Arc::new(line)).unwrap();
        }
        writer.finish().unwrap()
    }

    #[test]
    fn what_is_written_is_read() {
        let store = Store::default();
        read_replay(&record()[..], &store).unwrap();
        let (_, lines, at_end) = store.lines(0, 1 << 20);
        assert_eq!((lines, at_end), (3, true));
        assert_eq!(store.detail(0).map(|d: Detail| d.n), Some(0));
    }

    #[test]
    fn a_cut_file_gives_what_came_before() {
        let whole = record();
        let store = Store::default();
        let error = read_replay(&whole[..whole.len() - 12], &store).unwrap_err();
        assert!(matches!(error, ReplayError::Broken { .. }), "{error}");
    }

    #[test]
    fn other_files_are_refused_by_name() {
        let packed = |text: &str| {
            let mut out = GzEncoder::new(Vec::new(), Compression::fast());
            out.write_all(text.as_bytes()).unwrap();
            out.finish().unwrap()
        };
        let fault = |text: &str| {
            read_replay(&packed(text)[..], &Store::default())
                .unwrap_err()
                .to_string()
        };
        assert!(fault("FLASER 3 1 1 1\n").contains("line 1 is no line of a record"));
        assert!(fault("{\"end\":{\"partial\":null}}\n").contains("not `about`"));
        let future = r#"{"about":{"format":"polymapper-replay","version":9,"generator":"","log":""}}"#;
        assert!(fault(future).contains("version 9"));
    }
}
