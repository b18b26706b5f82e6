//! Files of records in which a chunk holds further records, packed.
//!
//! In goes the file as a stream, out comes the stream of the records of a chunk, unpacked as they are read, and behind
//! it the file again. Memory does not depend on the length of chunks.

use std::io::{self, BufRead, BufReader, Read, Take};

use bzip2::bufread::MultiBzDecoder;
use flate2::Crc;

const CHUNK_BUFFER_BYTES: usize = 64 * 1024;

type Stream = Box<dyn BufRead>;

/// What records are read from, and how much was.
pub(super) struct Records {
    layer: Layer,
    read_bytes: u64,
}

enum Layer {
    File(Stream),
    /// A chunk, and with it the file around.
    Chunk(BufReader<Chunk>),
    /// A fault in between lost the file.
    Lost,
}

/// A chunk being unpacked.
struct Chunk {
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

impl Records {
    /// The records of a file, behind the `magic` with which it begins.
    pub fn behind(magic: &[u8], mut file: Stream) -> Self {
        file.consume(magic.len());
        Self {
            layer: Layer::File(file),
            read_bytes: magic.len() as u64,
        }
    }

    /// Bytes read so far, unpacked.
    pub fn read_bytes(&self) -> u64 {
        self.read_bytes
    }

    /// Whether the chunk, or the file outside of one, is read to its end.
    pub fn at_end(&mut self) -> io::Result<bool> {
        Ok(self.layer.stream()?.fill_buf()?.is_empty())
    }

    /// Reads `N` bytes of `what`.
    pub fn read_array<const N: usize>(&mut self, what: &str) -> io::Result<[u8; N]> {
        let mut array = [0; N];
        let outcome = self.layer.stream()?.read_exact(&mut array);
        outcome.map_err(|error| cut(error, what))?;
        self.read_bytes += N as u64;
        Ok(array)
    }

    /// Reads `bytes` bytes of `what` into `buffer`, in place of what is there. It grows with what there is to
    /// read, whatever length was announced.
    pub fn read_into(&mut self, buffer: &mut Vec<u8>, bytes: u64, what: &str) -> io::Result<()> {
        buffer.clear();
        let read = self.layer.stream()?.take(bytes).read_to_end(buffer)? as u64;
        self.passed(read, bytes, what)
    }

    /// Passes over `bytes` bytes of a record.
    pub fn skip(&mut self, bytes: u64) -> io::Result<()> {
        let skipped = io::copy(&mut self.layer.stream()?.take(bytes), &mut io::sink())?;
        self.passed(skipped, bytes, "a record")
    }

    fn passed(&mut self, read: u64, expected: u64, what: &str) -> io::Result<()> {
        self.read_bytes += read;
        if read < expected {
            return Err(cut(io::ErrorKind::UnexpectedEof.into(), what));
        }
        Ok(())
    }

    /// Goes into a chunk of `bytes` bytes; `checksum` is the CRC-32 of what is in it, if that is known.
    pub fn enter(&mut self, compression: &str, bytes: u64, checksum: Option<u32>) -> io::Result<()> {
        self.layer.enter(compression, bytes, checksum)
    }

    /// Goes back to the file at the end of a chunk; `false` at the end of the file.
    pub fn leave(&mut self) -> io::Result<bool> {
        self.layer.leave()
    }
}

impl Layer {
    fn stream(&mut self) -> io::Result<&mut dyn BufRead> {
        match self {
            Self::File(stream) => Ok(stream),
            Self::Chunk(stream) => Ok(stream),
            Self::Lost => Err(broken("a chunk could not be read".to_owned())),
        }
    }

    fn enter(&mut self, compression: &str, bytes: u64, checksum: Option<u32>) -> io::Result<()> {
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

    fn leave(&mut self) -> io::Result<bool> {
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

pub(super) fn broken(what: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// An end of the file gets words; other faults pass.
fn cut(error: io::Error, what: &str) -> io::Error {
    if error.kind() == io::ErrorKind::UnexpectedEof {
        return io::Error::new(error.kind(), format!("the file is cut within {what}"));
    }
    error
}
