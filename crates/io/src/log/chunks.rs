//! Files of records in which a chunk holds further records, packed.
//!
//! In goes the file as a stream, out comes the stream of the records of a chunk, unpacked as they are read, and behind
//! it the file again. Memory does not depend on the length of chunks.

use std::io::{self, BufRead, BufReader, Read, Take};

use bzip2::bufread::MultiBzDecoder;
use flate2::Crc;

const CHUNK_BUFFER_BYTES: usize = 64 * 1024;

type Stream = Box<dyn BufRead>;

/// What records are read from.
pub(super) enum Layer {
    File(Stream),
    /// A chunk, and with it the file around.
    Chunk(BufReader<Chunk>),
    /// A fault in between lost the file.
    Lost,
}

/// A chunk being unpacked.
pub(super) struct Chunk {
    unpacker: Unpacker,
    /// Checksum so far, and what it should be at the end.
    checksum: Option<(Crc, u32)>,
}

enum Unpacker {
    Plain(Take<Stream>),
    Bz2(MultiBzDecoder<Take<Stream>>),
    Lz4(lz4::Decoder<Take<Stream>>),
    Zstd(zstd::stream::read::Decoder<'static, Take<Stream>>),
}

impl Unpacker {
    fn new(chunk: Take<Stream>, compression: &str) -> io::Result<Self> {
        Ok(match compression {
            "" | "none" => Self::Plain(chunk),
            "bz2" => Self::Bz2(MultiBzDecoder::new(chunk)),
            "lz4" => Self::Lz4(lz4::Decoder::new(chunk)?),
            "zstd" => Self::Zstd(zstd::stream::read::Decoder::with_buffer(chunk)?),
            other => {
                return Err(broken(format!(
                    "a chunk is packed with `{}`; none, bz2, lz4 or zstd is expected",
                    super::error::excerpt(other.as_bytes())
                )));
            }
        })
    }

    /// The stream behind the chunk.
    fn into_file(self) -> io::Result<Stream> {
        let mut rest = match self {
            Self::Plain(inner) => inner,
            Self::Bz2(inner) => inner.into_inner(),
            Self::Lz4(inner) => inner.finish().0,
            Self::Zstd(inner) => inner.finish(),
        };
        io::copy(&mut rest, &mut io::sink())?;
        Ok(rest.into_inner())
    }
}

impl Read for Chunk {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let read = match &mut self.unpacker {
            Unpacker::Plain(inner) => inner.read(buf),
            Unpacker::Bz2(inner) => inner.read(buf),
            Unpacker::Lz4(inner) => inner.read(buf),
            Unpacker::Zstd(inner) => inner.read(buf),
        }?;
        if let Some((checksum, _)) = &mut self.checksum {
            checksum.update(&buf[..read]);
        }
        Ok(read)
    }
}

impl Layer {
    pub fn stream(&mut self) -> io::Result<&mut dyn BufRead> {
        match self {
            Self::File(stream) => Ok(stream),
            Self::Chunk(stream) => Ok(stream),
            Self::Lost => Err(broken("a chunk could not be read".to_owned())),
        }
    }

    /// Goes into a chunk of `bytes` bytes; `checksum` is the CRC-32 of what is in it, if that is known.
    pub fn enter(&mut self, compression: &str, bytes: u64, checksum: Option<u32>) -> io::Result<()> {
        let Self::File(stream) = std::mem::replace(self, Self::Lost) else {
            return Err(broken("a chunk within a chunk".to_owned()));
        };
        let chunk = Chunk {
            unpacker: Unpacker::new(stream.take(bytes), compression)?,
            checksum: checksum.map(|expected| (Crc::new(), expected)),
        };
        *self = Self::Chunk(BufReader::with_capacity(CHUNK_BUFFER_BYTES, chunk));
        Ok(())
    }

    /// Goes back to the file at the end of a chunk; `false` at the end of the file.
    pub fn leave(&mut self) -> io::Result<bool> {
        match std::mem::replace(self, Self::Lost) {
            Self::Chunk(chunk) => {
                let chunk = chunk.into_inner();
                if let Some((found, expected)) = chunk.checksum
                    && found.sum() != expected
                {
                    return Err(broken(format!(
                        "the checksum of a chunk is {:#010x}, but {expected:#010x} stands in the file",
                        found.sum()
                    )));
                }
                *self = Self::File(chunk.unpacker.into_file()?);
                Ok(true)
            }
            other => {
                *self = other;
                Ok(false)
            }
        }
    }
}

/// Appends `bytes` bytes; the buffer grows with what is there, whatever length was announced.
pub(super) fn read_up_to(
    stream: &mut dyn BufRead,
    bytes: usize,
    buffer: &mut Vec<u8>,
    what: &str,
) -> io::Result<()> {
    let read = stream.take(bytes as u64).read_to_end(buffer)?;
    if read < bytes {
        return Err(cut(io::ErrorKind::UnexpectedEof.into(), what));
    }
    Ok(())
}

pub(super) fn broken(what: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// An end of the file gets words; other faults pass.
pub(super) fn cut(error: io::Error, what: &str) -> io::Error {
    if error.kind() == io::ErrorKind::UnexpectedEof {
        return io::Error::new(error.kind(), format!("the file is cut within {what}"));
    }
    error
}
