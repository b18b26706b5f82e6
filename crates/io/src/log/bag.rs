//! ROS 1 bags, format 2.0.
//!
//! In goes the file as a stream, out come its messages in the order in which they stand. The index at the end is
//! not looked at, since it may be wrong or missing (a bag whose recording was cut): chunks are read one after
//! another, through their decompressor, so that memory does not depend on their size. A record is a head of named
//! fields and data, each with its length before it (<http://wiki.ros.org/Bags/Format/2.0>).
//!
//! Some writers gave the index behind a chunk a length that is not 12 bytes an entry. What stands behind such a
//! record cannot be reached by the lengths: reading ends there and says so, or goes on behind the entries when it
//! is asked to ([`ReadOptions::salvage`]).

use std::io;

use super::chunks::{Records, broken};
use super::ros::{Channel, Encoding, MAX_MESSAGE_BYTES, Message, Messages};
use super::{LogError, ReadOptions, ScanReader, ros};
use crate::input::Input;

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";
/// Heads hold a topic and a few numbers; a connection's data hold a message definition.
const MAX_HEAD_BYTES: usize = 1024 * 1024;
/// More topics and nodes than a robot has.
const MAX_CONNECTIONS: u32 = 65_536;

pub(super) fn recognise(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    ros::open(input, options, |input, options| {
        Ok(Box::new(BagMessages {
            records: Records::behind(MAGIC, input.into_stream()),
            connections: Vec::new(),
            record: Record::default(),
            salvage: options.salvage,
            lost: None,
        }))
    })
}

/// What is read of a record; the buffers are used again.
#[derive(Default)]
struct Record {
    head: Vec<u8>,
    data: Vec<u8>,
}

/// Bytes of an entry of an index: a time and a place.
const INDEX_ENTRY_BYTES: u64 = 12;

/// Kinds of records.
mod op {
    pub const MESSAGE: u8 = 0x02;
    pub const INDEX: u8 = 0x04;
    pub const CHUNK: u8 = 0x05;
    pub const CONNECTION: u8 = 0x07;
}

struct BagMessages {
    records: Records,
    /// By their number.
    connections: Vec<Option<Channel>>,
    record: Record,
    salvage: bool,
    /// What is not read, and why.
    lost: Option<String>,
}

impl Messages for BagMessages {
    fn next_message(&mut self) -> io::Result<Option<Message<'_>>> {
        let (id, recorded_s) = loop {
            if !self.read_head()? {
                if self.records.leave()? {
                    continue;
                }
                return Ok(None);
            }
            let data_bytes = self.length("the length of a record's data")?;
            let head = Head(&self.record.head);
            match head.byte("op") {
                Some(op::CHUNK) => {
                    let compression = head.text("compression");
                    // The records of a chunk that is not packed stand in the file like any other.
                    if compression != "none" {
                        self.records.enter(&compression, u64::from(data_bytes), None)?;
                    }
                }
                Some(op::CONNECTION) => self.read_connection(data_bytes)?,
                Some(op::MESSAGE) => {
                    let id = head.number("conn");
                    let recorded_s = head.stamp_s("time");
                    if self.read_data(data_bytes)?
                        && let Some(id) = id
                        && self.connections.get(id as usize).is_some_and(Option::is_some)
                    {
                        break (id as usize, recorded_s);
                    }
                }
                Some(op::INDEX) => {
                    let entries = head.number("count").map(|n| u64::from(n) * INDEX_ENTRY_BYTES);
                    if !self.pass_index(u64::from(data_bytes), entries)? {
                        return Ok(None);
                    }
                }
                _ => self.records.skip(u64::from(data_bytes))?,
            }
        };
        let Some(channel) = self.connections[id].as_ref() else {
            return Ok(None);
        };
        Ok(Some(Message {
            id,
            channel,
            recorded_s,
            data: &self.record.data,
        }))
    }

    fn read_bytes(&self) -> u64 {
        self.records.read_bytes()
    }

    fn lost(&self) -> Option<String> {
        self.lost.clone()
    }
}

impl BagMessages {
    /// Reads the head of the next record; `false` at the end of the chunk or file.
    fn read_head(&mut self) -> io::Result<bool> {
        if self.records.at_end()? {
            return Ok(false);
        }
        let bytes = self.length("the length of a record's head")? as usize;
        if bytes > MAX_HEAD_BYTES {
            return Err(broken(format!(
                "the head of a record says that it has {bytes} bytes, at most {MAX_HEAD_BYTES} are expected"
            )));
        }
        let head = &mut self.record.head;
        self.records
            .read_into(head, bytes as u64, "the head of a record")?;
        Ok(true)
    }

    fn length(&mut self, what: &str) -> io::Result<u32> {
        Ok(u32::from_le_bytes(self.records.read_array(what)?))
    }

    /// Reads the data of a record; `false` when they are too long to be held and skipped.
    fn read_data(&mut self, bytes: u32) -> io::Result<bool> {
        let is_short = bytes as usize <= MAX_MESSAGE_BYTES;
        if is_short {
            let data = &mut self.record.data;
            self.records.read_into(data, u64::from(bytes), "a record")?;
        } else {
            self.records.skip(u64::from(bytes))?;
        }
        Ok(is_short)
    }

    /// Skips an index; `false` when what follows cannot be reached.
    fn pass_index(&mut self, bytes: u64, entries: Option<u64>) -> io::Result<bool> {
        let Some(needed) = entries.filter(|&needed| needed != bytes) else {
            return self.records.skip(bytes).map(|()| true);
        };
        let place = self.records.read_bytes();
        if self.salvage {
            self.lost = Some(format!(
                "an index at byte {place} says {bytes} bytes and has entries of {needed}: read on behind the entries"
            ));
            return self.records.skip(needed).map(|()| true);
        }
        self.records.skip(needed)?;
        if self.read_head()? && Head(&self.record.head).byte("op") == Some(op::CHUNK) {
            self.lost = Some(format!(
                "an index at byte {place} says {bytes} bytes and has entries of {needed}: what follows is not read; --salvage reads it"
            ));
        }
        Ok(false)
    }

    fn read_connection(&mut self, data_bytes: u32) -> io::Result<()> {
        let head = Head(&self.record.head);
        let (id, topic) = (head.number("conn"), head.text("topic"));
        if !self.read_data(data_bytes)? {
            return Ok(());
        }
        let Some(id) = id.filter(|&id| id < MAX_CONNECTIONS) else {
            return Ok(());
        };
        let kind = Head(&self.record.data).text("type");
        let channel = Channel::new(&topic, &kind, Ok(Encoding::Ros1));
        ros::put_at(&mut self.connections, id as usize, channel);
        Ok(())
    }
}

/// Named fields: a length of four bytes, then `name=value`, again and again.
struct Head<'a>(&'a [u8]);

impl<'a> Head<'a> {
    fn field(&self, name: &str) -> Option<&'a [u8]> {
        let mut rest = self.0;
        while let Some((length, after)) = rest.split_first_chunk::<4>() {
            let (field, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize)?;
            let value = field
                .strip_prefix(name.as_bytes())
                .and_then(|f| f.strip_prefix(b"="));
            if value.is_some() {
                return value;
            }
            rest = after;
        }
        None
    }

    fn byte(&self, name: &str) -> Option<u8> {
        self.field(name)?.first().copied()
    }

    fn number(&self, name: &str) -> Option<u32> {
        Some(u32::from_le_bytes(self.field(name)?.try_into().ok()?))
    }

    fn stamp_s(&self, name: &str) -> f64 {
        let Some((seconds, rest)) = self.field(name).and_then(|f| f.split_first_chunk::<4>()) else {
            return 0.0;
        };
        let nanoseconds = rest.first_chunk::<4>().map_or(0, |b| u32::from_le_bytes(*b));
        f64::from(u32::from_le_bytes(*seconds)) + f64::from(nanoseconds) * 1e-9
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8_lossy(self.field(name).unwrap_or_default()).into_owned()
    }
}
