//! MCAP recordings of ROS 2 (and of ROS 1, converted).
//!
//! In goes the file as a stream, out come its messages in the order in which they stand. Records (kind, length, data)
//! are read one after another and chunks through their decompressor, without the index at the end, so that memory
//! does not depend on the file and a recording that was cut goes in as far as it goes (<https://mcap.dev/spec>).
//!
//! The reader of the `mcap` crate (0.26.0, `LinearReader`) was tried: it takes whole chunks of lengths that are not
//! checked (a record longer than its chunk is a subtraction that overflows, found by fuzzing in a second).

use std::collections::BTreeMap;
use std::io;

use super::chunks::{Records, broken};
use super::ros::{Channel, Encoding, MAX_MESSAGE_BYTES, Message, Messages};
use super::{LogError, ReadOptions, ScanReader, ros};
use crate::input::Input;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Bytes before the data of a message record: channel, sequence, two times.
const MESSAGE_HEAD: usize = 2 + 4 + 8 + 8;
/// Definitions of types are long, those of robots with many topics longer.
const MAX_DEFINITION_BYTES: u64 = 16 * 1024 * 1024;

/// Kinds of records.
mod op {
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
}

pub(super) fn recognise(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    ros::open(input, options, |input, _| {
        Ok(Box::new(McapMessages {
            records: Records::behind(MAGIC, input.into_stream()),
            schemas: BTreeMap::new(),
            channels: Vec::new(),
            data: Vec::new(),
        }))
    })
}

struct McapMessages {
    records: Records,
    /// Names of types.
    schemas: BTreeMap<u16, String>,
    /// By their number.
    channels: Vec<Option<Channel>>,
    /// Of the record being read; used again.
    data: Vec<u8>,
}

impl Messages for McapMessages {
    fn next_message(&mut self) -> io::Result<Option<Message<'_>>> {
        let (id, recorded_s) = loop {
            let Some((kind, bytes)) = self.read_head()? else {
                if self.records.leave()? {
                    continue;
                }
                return Err(broken("the file ends without its footer".to_owned()));
            };
            match kind {
                op::FOOTER => return Ok(None),
                op::CHUNK => self.enter_chunk(bytes)?,
                op::SCHEMA if bytes <= MAX_DEFINITION_BYTES => self.read_schema(bytes)?,
                op::CHANNEL if bytes <= MAX_DEFINITION_BYTES => self.read_channel(bytes)?,
                op::MESSAGE if (MESSAGE_HEAD as u64..=MAX_MESSAGE_BYTES as u64).contains(&bytes) => {
                    let head = self.records.read_array::<MESSAGE_HEAD>("the head of a message")?;
                    self.read_data(bytes - MESSAGE_HEAD as u64)?;
                    let id = usize::from(u16::from_le_bytes([head[0], head[1]]));
                    if self.channels.get(id).is_some_and(Option::is_some) {
                        break (id, log_time_s(&head));
                    }
                }
                _ => self.records.skip(bytes)?,
            }
        };
        let Some(channel) = self.channels[id].as_ref() else {
            return Ok(None);
        };
        Ok(Some(Message {
            id,
            channel,
            recorded_s,
            data: &self.data,
        }))
    }

    fn read_bytes(&self) -> u64 {
        self.records.read_bytes()
    }
}

impl McapMessages {
    /// Kind and length of the next record; `None` at the end of the chunk or file.
    fn read_head(&mut self) -> io::Result<Option<(u8, u64)>> {
        if self.records.at_end()? {
            return Ok(None);
        }
        let [kind] = self.records.read_array("the head of a record")?;
        let bytes = self.records.read_array("the head of a record")?;
        Ok(Some((kind, u64::from_le_bytes(bytes))))
    }

    /// Reads the data of a record, whose length is within bounds.
    fn read_data(&mut self, bytes: u64) -> io::Result<()> {
        self.records.read_into(&mut self.data, bytes, "a record")
    }

    fn enter_chunk(&mut self, bytes: u64) -> io::Result<()> {
        const LONGEST_NAME: u32 = 64;
        const HEAD: &str = "the head of a chunk";
        // Start and end time, length when unpacked.
        self.records.read_array::<24>(HEAD)?;
        let checksum = u32::from_le_bytes(self.records.read_array(HEAD)?);
        let name_bytes = u32::from_le_bytes(self.records.read_array(HEAD)?);
        if name_bytes > LONGEST_NAME {
            return Err(broken(format!(
                "the name of a chunk's compression has {name_bytes} bytes, at most {LONGEST_NAME} are expected"
            )));
        }
        self.read_data(u64::from(name_bytes))?;
        let compression = String::from_utf8_lossy(&self.data).into_owned();
        let packed_bytes = u64::from_le_bytes(self.records.read_array(HEAD)?);
        let head_bytes = 24 + 4 + 4 + u64::from(name_bytes) + 8;
        if head_bytes.checked_add(packed_bytes) != Some(bytes) {
            return Err(broken(format!(
                "a chunk of {bytes} bytes says that {packed_bytes} bytes of records are in it"
            )));
        }
        // Zero: there is none.
        let checksum = (checksum != 0).then_some(checksum);
        self.records.enter(&compression, packed_bytes, checksum)
    }

    fn read_schema(&mut self, bytes: u64) -> io::Result<()> {
        self.read_data(bytes)?;
        let mut fields = Fields(&self.data);
        if let (Some(id), Some(name)) = (fields.u16(), fields.text()) {
            self.schemas.insert(id, ros::shortened(&name).to_owned());
        }
        Ok(())
    }

    fn read_channel(&mut self, bytes: u64) -> io::Result<()> {
        self.read_data(bytes)?;
        let mut fields = Fields(&self.data);
        let (Some(id), Some(schema)) = (fields.u16(), fields.u16()) else {
            return Ok(());
        };
        let (Some(topic), Some(encoding)) = (fields.text(), fields.text()) else {
            return Ok(());
        };
        let encoding = match encoding.as_str() {
            "cdr" => Ok(Encoding::Cdr),
            "ros1" => Ok(Encoding::Ros1),
            _ => Err(encoding),
        };
        let kind = self.schemas.get(&schema).map_or("no type", String::as_str);
        ros::put_at(
            &mut self.channels,
            usize::from(id),
            Channel::new(&topic, kind, encoding),
        );
        Ok(())
    }
}

/// The fields of a definition.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn u16(&mut self) -> Option<u16> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(u16::from_le_bytes(*bytes))
    }

    fn text(&mut self) -> Option<String> {
        let (bytes, rest) = self.0.split_first_chunk()?;
        let (text, rest) = rest.split_at_checked(u32::from_le_bytes(*bytes) as usize)?;
        self.0 = rest;
        Some(String::from_utf8_lossy(text).into_owned())
    }
}

fn log_time_s(head: &[u8; MESSAGE_HEAD]) -> f64 {
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&head[6..14]);
    u64::from_le_bytes(bytes) as f64 * 1e-9
}
