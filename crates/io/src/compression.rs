//! Undoes compression, told by the content and never by the name.
//!
//! In goes a buffered stream of bytes, out comes the stream of what was packed; several members or frames one
//! after another are one stream. What is packed twice is undone once. Nothing is held but the window of the
//! decompressor: at most 128 MB, which only `zstd --ultra -22` asks for.

use std::io::{self, BufRead, BufReader};

use bzip2::bufread::MultiBzDecoder;
use flate2::bufread::MultiGzDecoder;

const UNPACKED_BUFFER_BYTES: usize = 128 * 1024;

type Stream = Box<dyn BufRead>;

/// A way to pack a file.
pub(crate) struct Compression {
    /// The usual ending of a name, for the user.
    pub name: &'static str,
    magic: &'static [u8],
    unpack: fn(Stream) -> io::Result<Stream>,
}

/// RFC 1952, the bzip2 file format, RFC 8878.
const COMPRESSIONS: &[Compression] = &[
    Compression {
        name: "gzip",
        magic: &[0x1f, 0x8b],
        unpack: |source| Ok(buffered(MultiGzDecoder::new(source))),
    },
    Compression {
        name: "bzip2",
        magic: b"BZh",
        unpack: |source| Ok(buffered(MultiBzDecoder::new(source))),
    },
    Compression {
        name: "zstd",
        magic: &[0x28, 0xb5, 0x2f, 0xfd],
        unpack: |source| Ok(buffered(zstd::stream::read::Decoder::with_buffer(source)?)),
    },
];

/// The stream of what is packed in `source`, and how it was packed; `source` itself when it is not.
///
/// # Errors
/// The first bytes cannot be read.
pub(crate) fn unpacked(mut source: Stream) -> io::Result<(Stream, Option<&'static Compression>)> {
    let start = source.fill_buf()?;
    match COMPRESSIONS.iter().find(|c| start.starts_with(c.magic)) {
        Some(compression) => Ok(((compression.unpack)(source)?, Some(compression))),
        None => Ok((source, None)),
    }
}

fn buffered(unpacked: impl io::Read + 'static) -> Stream {
    Box::new(BufReader::with_capacity(UNPACKED_BUFFER_BYTES, unpacked))
}
