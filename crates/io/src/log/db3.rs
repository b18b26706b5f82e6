//! sqlite3 recordings of ROS 2 (rosbag2's `.db3`).
//!
//! In goes the file, out come its messages in the order in which they were written. SQLite needs the file itself, so
//! that a packed file or standard input is unpacked first: a short one into memory, others into a temporary file. The
//! database is opened for reading
//! only; its schema is not trusted. Messages that rosbag2 packed one by one (`compression_mode: message`) are unpacked.
//!
//! Tables: `topics(id, name, type, serialization_format, ..)`, `messages(id, topic_id, timestamp, data)`.

use std::io::{self, BufRead, Cursor, Read, Write};
use std::path::Path;

use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, MAIN_DB, OpenFlags};

use super::ros::{Channel, Encoding, MAX_MESSAGE_BYTES, Message, Messages};
use super::{LogError, ReadOptions, ScanReader, ros};
use crate::input::Input;

const MAGIC: &[u8] = b"SQLite format 3\0";
const ZSTD_MAGIC: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
/// Messages fetched at a time.
const BATCH: i64 = 256;
/// Bytes of messages fetched at a time, unless one alone is longer.
const BATCH_BYTES: usize = 1024 * 1024;
/// More topics than a robot has.
const MAX_TOPICS: i64 = 4096;
/// A packed recording grows by 3 to 10 times when unpacked; one that grows by more than this is made to fill a disk.
const MOST_GROWTH: u64 = 200;
const LEAST_LIMIT_BYTES: u64 = 256 * 1024 * 1024;
/// What is unpacked to less than this needs no temporary file.
const SHORT_BYTES: u64 = 1024 * 1024;

pub(super) fn recognise(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    ros::open(input, options, |input, _| {
        let name = input.name.clone();
        let unreadable = |source| LogError::Unreadable { name, source };
        DbMessages::open(input)
            .map(|messages| Box::new(messages) as Box<dyn Messages>)
            .map_err(unreadable)
    })
}

struct Row {
    topic: usize,
    recorded_s: f64,
    data: Vec<u8>,
}

struct DbMessages {
    database: Connection,
    /// Thrown away with the reader.
    _unpacked: Option<tempfile::NamedTempFile>,
    channels: Vec<Channel>,
    /// `topics.id` of each channel.
    ids: Vec<i64>,
    /// Fetched and not yet handed out, the last first.
    batch: Vec<Row>,
    current: Option<Row>,
    last_id: i64,
    read_bytes: u64,
}

impl DbMessages {
    fn open(input: Input) -> io::Result<Self> {
        let (database, unpacked) = match input.plain_file() {
            Some(path) => (connect(path)?, None),
            None => match unpack(input)? {
                Unpacked::Memory(bytes) => (connect_to_bytes(bytes)?, None),
                Unpacked::File(file) => (connect(file.path())?, Some(file)),
            },
        };
        let mut messages = Self {
            database,
            _unpacked: unpacked,
            channels: Vec::new(),
            ids: Vec::new(),
            batch: Vec::new(),
            current: None,
            last_id: i64::MIN,
            read_bytes: 0,
        };
        messages.read_topics().map_err(broken)?;
        Ok(messages)
    }

    fn read_topics(&mut self) -> rusqlite::Result<()> {
        let mut query = self
            .database
            .prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id LIMIT ?1")?;
        let mut rows = query.query([MAX_TOPICS])?;
        while let Some(row) = rows.next()? {
            let (name, kind, format): (String, String, String) = (row.get(1)?, row.get(2)?, row.get(3)?);
            let encoding = match format.as_str() {
                "cdr" => Ok(Encoding::Cdr),
                _ => Err(format),
            };
            self.ids.push(row.get(0)?);
            self.channels.push(Channel::new(&name, &kind, encoding));
        }
        Ok(())
    }

    /// Fetches the next messages, the next of them last.
    fn fetch(&mut self) -> rusqlite::Result<()> {
        let mut query = self.database.prepare(
            "SELECT id, topic_id, timestamp, data FROM messages WHERE id > ?1 ORDER BY id LIMIT ?2",
        )?;
        let mut rows = query.query((self.last_id, BATCH))?;
        let mut bytes = 0;
        while let Some(row) = rows.next()? {
            self.last_id = row.get(0)?;
            let topic_id: i64 = row.get(1)?;
            let nanoseconds: i64 = row.get(2)?;
            let Some(topic) = self.ids.iter().position(|&id| id == topic_id) else {
                continue;
            };
            let data = match row.get_ref(3)? {
                ValueRef::Blob(data) => data.to_vec(),
                _ => Vec::new(),
            };
            bytes += data.len();
            self.batch.push(Row {
                topic,
                recorded_s: nanoseconds as f64 * 1e-9,
                data,
            });
            if bytes > BATCH_BYTES {
                break;
            }
        }
        self.batch.reverse();
        self.read_bytes += bytes as u64;
        Ok(())
    }
}

impl Messages for DbMessages {
    fn next_message(&mut self) -> io::Result<Option<Message<'_>>> {
        loop {
            if let Some(row) = self.batch.pop() {
                self.current = Some(row);
                break;
            }
            let before = self.last_id;
            self.fetch().map_err(broken)?;
            if self.batch.is_empty() && self.last_id == before {
                return Ok(None);
            }
        }
        let Some(row) = self.current.as_mut() else {
            return Ok(None);
        };
        if row.data.starts_with(ZSTD_MAGIC) {
            row.data = unpacked_message(&row.data)?;
        }
        Ok(Some(Message {
            id: row.topic,
            channel: &self.channels[row.topic],
            recorded_s: row.recorded_s,
            data: &row.data,
        }))
    }

    fn read_bytes(&self) -> u64 {
        self.read_bytes
    }
}

fn connect(path: &Path) -> io::Result<Connection> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let open = || guarded(Connection::open_with_flags(path, flags)?);
    open().map_err(broken)
}

/// Opens a database that is in memory.
fn connect_to_bytes(mut bytes: Vec<u8>) -> io::Result<Connection> {
    /// Versions of the file format for writing and for reading: 1 with a journal, 2 with a log of writes ahead, which
    /// needs a file (https://www.sqlite.org/c3ref/deserialize.html). rosbag2 writes 2.
    const VERSIONS: std::ops::Range<usize> = 18..20;
    if let Some(versions) = bytes.get_mut(VERSIONS)
        && versions == [2, 2]
    {
        versions.fill(1);
    }
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let open = || {
        let mut database = Connection::open_in_memory_with_flags(flags)?;
        let length = bytes.len();
        database.deserialize_read_exact(MAIN_DB, Cursor::new(bytes), length, true)?;
        guarded(database)
    };
    open().map_err(broken)
}

/// Takes away what a database made to do harm would use.
fn guarded(database: Connection) -> rusqlite::Result<Connection> {
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, MAX_MESSAGE_BYTES as i32)?;
    database.pragma_update(None, "trusted_schema", false)?;
    database.pragma_update(None, "cell_size_check", true)?;
    Ok(database)
}

/// What was packed.
enum Unpacked {
    Memory(Vec<u8>),
    File(tempfile::NamedTempFile),
}

/// Unpacks `input` into memory when it is short, else into a temporary file.
fn unpack(input: Input) -> io::Result<Unpacked> {
    let progress = input.progress.clone();
    let is_packed = input.compression.is_some();
    let mut stream = input.into_stream();
    let mut start = Vec::new();
    (&mut stream).take(SHORT_BYTES).read_to_end(&mut start)?;
    if (start.len() as u64) < SHORT_BYTES {
        return Ok(Unpacked::Memory(start));
    }
    let mut file = tempfile::NamedTempFile::new()?;
    file.write_all(&start)?;
    let mut written = SHORT_BYTES;
    loop {
        let part = stream.fill_buf()?;
        if part.is_empty() {
            break;
        }
        file.write_all(part)?;
        let bytes = part.len();
        stream.consume(bytes);
        written += bytes as u64;
        let limit = LEAST_LIMIT_BYTES.max(progress.read_bytes().saturating_mul(MOST_GROWTH));
        if is_packed && written > limit {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                format!(
                    "{} packed bytes became more than {limit}; no recording grows by so much",
                    progress.read_bytes()
                ),
            ));
        }
    }
    file.flush()?;
    Ok(Unpacked::File(file))
}

fn unpacked_message(packed: &[u8]) -> io::Result<Vec<u8>> {
    let mut data = Vec::new();
    let decoder = zstd::stream::read::Decoder::with_buffer(packed)?;
    decoder.take(MAX_MESSAGE_BYTES as u64).read_to_end(&mut data)?;
    Ok(data)
}

fn broken(error: rusqlite::Error) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error)
}
