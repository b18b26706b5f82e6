//! Messages, whatever the file around them.

use std::io;

use super::Encoding;

/// A longer message is no scan, transform or pose; nothing longer is taken into memory.
pub(in crate::log) const MAX_MESSAGE_BYTES: usize = 64 * 1024 * 1024;

/// What messages of a topic are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::log) struct Channel {
    pub topic: String,
    /// Type as ROS 1 writes it: `sensor_msgs/LaserScan`.
    pub kind: String,
    /// How they are serialised; the name of an encoding that is not read here.
    pub encoding: Result<Encoding, String>,
}

impl Channel {
    pub fn new(topic: &str, kind: &str, encoding: Result<Encoding, String>) -> Self {
        Self {
            topic: shortened(topic).to_owned(),
            kind: shortened(kind).replace("/msg/", "/"),
            encoding,
        }
    }

    /// Topic and type, for people.
    pub fn name(&self) -> String {
        format!("{} ({})", self.topic, self.kind)
    }
}

/// The first characters of a name; a name that is longer is made to fill the memory.
pub(in crate::log) fn shortened(name: &str) -> &str {
    const LONGEST: usize = 255;
    &name[..name.floor_char_boundary(LONGEST)]
}

/// A serialised message.
pub(in crate::log) struct Message<'a> {
    /// Place of the channel among those of the source; small.
    pub id: usize,
    pub channel: &'a Channel,
    /// When it was recorded, seconds.
    pub recorded_s: f64,
    pub data: &'a [u8],
}

/// A file of messages.
pub(in crate::log) trait Messages {
    /// The next message; `None` at the end.
    ///
    /// # Errors
    /// The file is cut or broken.
    fn next_message(&mut self) -> io::Result<Option<Message<'_>>>;
    /// Bytes read so far, after decompression.
    fn read_bytes(&self) -> u64;
    /// What of the file is not read although there is no fault, and why.
    fn lost(&self) -> Option<String> {
        None
    }
}

/// Puts `channel` under the number `id`, which is small, in the place of one that was there.
pub(in crate::log) fn put_at(channels: &mut Vec<Option<Channel>>, id: usize, channel: Channel) {
    if channels.len() <= id {
        channels.resize(id + 1, None);
    }
    channels[id] = Some(channel);
}
