//! Scans of ROS recordings, whatever the file around the messages.
//!
//! In go messages in file order ([`Messages`]: a ROS 1 bag, MCAP, sqlite3), out come the scans of one laser.
//!
//! - The laser is the topic that was asked for, or the best of those that the first scans are of
//!   ([`choice`]); the others are counted.
//! - Static transforms tell how the scanner is mounted ([`mount`]): upside down is turned round, and where
//!   odometry is used, the place on the robot counts. They may come after the first scans, so that these are held
//!   back ([`sorter`]).
//! - Odometry and moving transforms are looked at only when they are asked for ([`odometry`]).

mod choice;
mod laser_scan;
mod messages;
mod mount;
mod odometry;
mod sorter;
mod source;
mod transform;
mod wire;

use std::io;

use super::{Entry, LogError, ReadOptions, ScanReader, Tally, Unit};
use crate::input::Input;
use sorter::{Role, Sorter};
pub(super) use source::{Channel, MAX_MESSAGE_BYTES, Message, Messages, put_at, shortened};
pub(super) use transform::Transform;
pub(super) use wire::Encoding;

/// Opens the messages of a file.
pub(super) type OpenMessages = fn(Input, &ReadOptions) -> Result<Box<dyn Messages>, LogError>;

/// Reads the scans of the recording in `input`.
pub(super) fn open(
    input: Input,
    options: &ReadOptions,
    open_messages: OpenMessages,
) -> Result<Box<dyn ScanReader>, LogError> {
    Ok(Box::new(RosReader {
        name: input.name.clone(),
        source: open_messages(input, options)?,
        open_messages,
        options: options.clone(),
        roles: Vec::new(),
        sorter: Sorter::new(options),
        messages: 0,
        bytes_before: 0,
        fault: None,
        lost_before: None,
        at_end: false,
    }))
}

struct RosReader {
    name: String,
    source: Box<dyn Messages>,
    open_messages: OpenMessages,
    options: ReadOptions,
    /// By the number of the channel in this part of the recording.
    roles: Vec<Option<(Role, Encoding)>>,
    sorter: Sorter,
    /// Messages of this part.
    messages: u64,
    bytes_before: u64,
    /// Why the source broke off, until all before it is handed out.
    fault: Option<io::Error>,
    /// What was not read of the parts before.
    lost_before: Option<String>,
    at_end: bool,
}

impl ScanReader for RosReader {
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>> {
        loop {
            if let Some(entry) = self.sorter.ready(self.at_end) {
                return Some(Ok(entry));
            }
            if let Some(source) = self.fault.take() {
                return Some(Err(LogError::Broken {
                    name: self.name.clone(),
                    line: self.messages,
                    unit: Unit::Message,
                    source,
                }));
            }
            if self.at_end {
                return None;
            }
            self.read_one();
        }
    }

    fn continue_with(&mut self, input: Input) -> Result<(), LogError> {
        self.bytes_before += self.source.read_bytes();
        self.lost_before = self.lost_before.take().or_else(|| self.source.lost());
        self.sorter.messages_before += self.messages;
        input.name.clone_into(&mut self.name);
        self.source = (self.open_messages)(input, &self.options)?;
        self.roles.clear();
        self.messages = 0;
        self.at_end = false;
        Ok(())
    }

    fn tally(&self) -> Tally {
        let mut tally = self.sorter.tally();
        tally.lines = self.sorter.messages_before + self.messages;
        tally.bytes = self.bytes_before + self.source.read_bytes();
        tally.lost = self.lost_before.clone().or_else(|| self.source.lost());
        tally
    }
}

impl RosReader {
    fn read_one(&mut self) {
        match self.source.next_message() {
            Ok(Some(message)) => {
                self.messages += 1;
                if self.roles.len() <= message.id {
                    self.roles.resize(message.id + 1, None);
                }
                let (role, encoding) = self.roles[message.id].get_or_insert_with(|| {
                    let encoding = message.channel.encoding.clone().unwrap_or(Encoding::Cdr);
                    (self.sorter.role(message.channel), encoding)
                });
                self.sorter.take(role, *encoding, &message, self.messages);
            }
            Ok(None) => self.at_end = true,
            Err(fault) => {
                self.fault = Some(fault);
                self.at_end = true;
            }
        }
    }
}
