//! MCAP recordings of ROS 2 (and of ROS 1, converted).
//!
//! In goes the file as a stream, out come its messages in the order in which they stand. The `mcap` crate's
//! linear reader takes it apart without the index at the end, chunk after chunk through the decompressor, so that
//! memory does not depend on the file (https://mcap.dev/spec).

use std::collections::BTreeMap;
use std::io::{self, Read};

use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::ros::{Channel, Encoding, MAX_MESSAGE_BYTES, Message, Messages};
use super::{LogError, ReadOptions, ScanReader, ros};
use crate::input::Input;

/// Bytes asked of the file at a time, at least.
const READ_BYTES: usize = 64 * 1024;
/// Bytes before the data of a message record: channel, sequence, two times.
const MESSAGE_HEAD: usize = 2 + 4 + 8 + 8;
/// Schemas and their texts that are kept; only their names are.
const MAX_SCHEMAS: usize = 65_536;

pub(super) fn recognise(head: &[u8]) -> bool {
    head.starts_with(mcap::MAGIC)
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    ros::open(input, options, |input, _| {
        let options = LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(MAX_MESSAGE_BYTES);
        Ok(Box::new(McapMessages {
            stream: input.into_stream(),
            reader: LinearReader::new_with_options(options),
            schemas: BTreeMap::new(),
            channels: Vec::new(),
            data: Vec::new(),
            read_bytes: 0,
        }))
    })
}

struct McapMessages {
    stream: Box<dyn io::BufRead>,
    reader: LinearReader,
    /// Names of types.
    schemas: BTreeMap<u16, String>,
    /// By their number.
    channels: Vec<Option<Channel>>,
    data: Vec<u8>,
    read_bytes: u64,
}

impl Messages for McapMessages {
    fn next_message(&mut self) -> io::Result<Option<Message<'_>>> {
        let (id, recorded_s) = loop {
            let event = match self.reader.next_event() {
                None => return Ok(None),
                Some(event) => event.map_err(|error| broken(&error))?,
            };
            match event {
                LinearReadEvent::ReadRequest(wanted) => {
                    let space = self.reader.insert(wanted.max(READ_BYTES));
                    let read = self.stream.read(space)?;
                    self.reader.notify_read(read);
                    self.read_bytes += read as u64;
                }
                LinearReadEvent::Record { opcode, data } => match opcode {
                    op::MESSAGE => {
                        let head = data.first_chunk::<MESSAGE_HEAD>();
                        let known = |id: u16| self.channels.get(usize::from(id)).is_some_and(Option::is_some);
                        if let Some(head) = head {
                            let id = u16::from_le_bytes([head[0], head[1]]);
                            if known(id) {
                                self.data.clear();
                                self.data.extend_from_slice(&data[MESSAGE_HEAD..]);
                                break (usize::from(id), log_time_s(head));
                            }
                        }
                    }
                    op::SCHEMA | op::CHANNEL => {
                        let record = mcap::parse_record(opcode, data).map_err(|error| broken(&error))?;
                        take_definition(&mut self.schemas, &mut self.channels, record);
                    }
                    _ => {}
                },
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
        self.read_bytes
    }
}

fn take_definition(
    schemas: &mut BTreeMap<u16, String>,
    channels: &mut Vec<Option<Channel>>,
    record: Record<'_>,
) {
    match record {
        Record::Schema { header, .. } if schemas.len() < MAX_SCHEMAS => {
            schemas.insert(header.id, header.name);
        }
        Record::Channel(channel) => {
            let encoding = match channel.message_encoding.as_str() {
                "cdr" => Ok(Encoding::Cdr),
                "ros1" => Ok(Encoding::Ros1),
                other => Err(other.to_owned()),
            };
            let kind = schemas.get(&channel.schema_id).map_or("no type", String::as_str);
            let id = usize::from(channel.id);
            if channels.len() <= id {
                channels.resize(id + 1, None);
            }
            channels[id] = Some(Channel::new(&channel.topic, kind, encoding));
        }
        _ => {}
    }
}

fn log_time_s(head: &[u8; MESSAGE_HEAD]) -> f64 {
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&head[6..14]);
    u64::from_le_bytes(bytes) as f64 * 1e-9
}

fn broken(error: &mcap::McapError) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, error.to_string())
}
