//! Where the bytes of a log come from: a file or standard input, compressed or plain.
//!
//! In goes a name, out comes a buffered stream of decompressed bytes whose first part can be looked at
//! without being used up.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::compression::{Compression, unpacked};
use crate::log::LogError;

/// How much of the decompressed content is looked at to recognise a format.
const HEAD_BYTES: u64 = 256 * 1024;
/// Small enough that the bytes taken from a compressed file tell how far the reading has come.
const SOURCE_BUFFER_BYTES: usize = 16 * 1024;

/// How far the reading of a file has come; clones watch the same file.
#[derive(Clone, Debug, Default)]
pub struct ReadProgress {
    read_bytes: Arc<AtomicU64>,
    total_bytes: Option<u64>,
}

impl ReadProgress {
    /// Bytes taken from the file so far, before decompression.
    #[must_use]
    pub fn read_bytes(&self) -> u64 {
        self.read_bytes.load(Ordering::Relaxed)
    }

    /// Length of the file in bytes, before decompression; `None` for standard input and pipes.
    #[must_use]
    pub fn total_bytes(&self) -> Option<u64> {
        self.total_bytes
    }
}

/// An opened source, decompressed, with its first part at hand.
pub(crate) struct Input {
    /// The name for messages.
    pub name: String,
    /// The first decompressed bytes, as many as there are, at most [`HEAD_BYTES`], without a byte order mark.
    pub head: Vec<u8>,
    /// What follows the head. A fault met while the head was read comes first.
    rest: Box<dyn BufRead>,
    pub progress: ReadProgress,
    /// How the source is packed.
    pub compression: Option<&'static Compression>,
    /// Where the file is, if it can be opened again.
    path: Option<PathBuf>,
}

impl Input {
    /// Opens the file at `path`, or standard input for `-`.
    ///
    /// # Errors
    /// No such file, a directory, no permission, nothing in it, or nothing that could be read.
    pub fn open(path: &Path) -> Result<Self, LogError> {
        let name = if path == Path::new("-") {
            "standard input".to_owned()
        } else {
            path.display().to_string()
        };
        let (source, total_bytes) = open_source(path, &name)?;
        let mut input = Self::from_reader(name, source, total_bytes)?;
        input.path = total_bytes.is_some().then(|| path.to_owned());
        Ok(input)
    }

    /// Takes any stream of `total_bytes`, if that is known, under a name for messages.
    ///
    /// # Errors
    /// Nothing in it, or nothing that could be read.
    pub fn from_reader(
        name: String,
        source: impl Read + 'static,
        total_bytes: Option<u64>,
    ) -> Result<Self, LogError> {
        let progress = ReadProgress {
            read_bytes: Arc::default(),
            total_bytes,
        };
        let counted = Counted {
            inner: source,
            read_bytes: Arc::clone(&progress.read_bytes),
        };
        let source = Box::new(BufReader::with_capacity(SOURCE_BUFFER_BYTES, counted));
        let (stream, compression) = unpacked(source).map_err(|source| LogError::Unreadable {
            name: name.clone(),
            source,
        })?;
        Self::with_head(name, stream, progress, compression)
    }

    fn with_head(
        name: String,
        mut stream: Box<dyn BufRead>,
        progress: ReadProgress,
        compression: Option<&'static Compression>,
    ) -> Result<Self, LogError> {
        let mut head = Vec::new();
        let outcome = (&mut stream).take(HEAD_BYTES).read_to_end(&mut head);
        let rest: Box<dyn BufRead> = match outcome {
            Err(source) if head.is_empty() => return Err(LogError::Unreadable { name, source }),
            Err(fault) => Box::new(BufReader::with_capacity(0, Fault(Some(fault)))),
            Ok(_) => stream,
        };
        if head.is_empty() {
            return Err(LogError::Empty { name });
        }
        Ok(Self {
            name,
            head: without_mark(&head).to_vec(),
            rest,
            progress,
            compression,
            path: None,
        })
    }

    /// Takes a stream of which the first part has been read: one that is live cannot be waited for.
    pub fn begun(name: String, head: Vec<u8>, rest: Box<dyn BufRead>) -> Self {
        Self {
            name,
            head: without_mark(&head).to_vec(),
            rest,
            progress: ReadProgress::default(),
            compression: None,
            path: None,
        }
    }

    /// The file itself, where it is one and not packed.
    pub fn plain_file(&self) -> Option<&Path> {
        self.path.as_deref().filter(|_| self.compression.is_none())
    }

    /// The whole stream from its first byte.
    pub fn into_stream(self) -> Box<dyn BufRead> {
        Box::new(Cursor::new(self.head).chain(self.rest))
    }
}

/// The first bytes without the mark that some editors put before text in UTF-8. No binary log begins with it.
pub(crate) fn without_mark(head: &[u8]) -> &[u8] {
    head.strip_prefix("\u{feff}".as_bytes()).unwrap_or(head)
}

fn open_source(path: &Path, name: &str) -> Result<(Box<dyn Read>, Option<u64>), LogError> {
    if path == Path::new("-") {
        return Ok((Box::new(io::stdin()), None));
    }
    let unreadable = |source: io::Error| match source.kind() {
        io::ErrorKind::NotFound => LogError::Missing {
            name: name.to_owned(),
        },
        _ => LogError::Unreadable {
            name: name.to_owned(),
            source,
        },
    };
    let file = File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    if metadata.is_dir() {
        return Err(LogError::Directory {
            name: name.to_owned(),
        });
    }
    Ok((Box::new(file), metadata.is_file().then_some(metadata.len())))
}

/// Counts the bytes that pass.
struct Counted<R> {
    inner: R,
    read_bytes: Arc<AtomicU64>,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        let n = self.inner.read(buf)?;
        self.read_bytes.fetch_add(n as u64, Ordering::Relaxed);
        Ok(n)
    }
}

/// Gives back a fault that was met earlier, in its turn.
struct Fault(Option<io::Error>);

impl Read for Fault {
    fn read(&mut self, _buf: &mut [u8]) -> io::Result<usize> {
        self.0.take().map_or(Ok(0), Err)
    }
}
