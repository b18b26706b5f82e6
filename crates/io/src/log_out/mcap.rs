//! MCAP with the messages of ROS 2, in chunks of 1 MB, not packed (as `ros2 bag record` writes it).

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{McapResult, WriteOptions, Writer};

use super::ScanWriter;
use super::ros2::{self, LASER_SCAN, ODOMETRY, Type};
use crate::log::LogScan;

/// A recording as it grows.
pub(crate) struct Recording<W: Write> {
    writer: Writer<NoSeek<W>>,
    /// Channel and messages so far, by topic.
    topics: BTreeMap<String, (u16, u32)>,
}

impl<W: Write> Recording<W> {
    /// Begins a recording.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn new(out: W) -> McapResult<Self> {
        let options = WriteOptions::new()
            .profile("ros2")
            .compression(None)
            .disable_seeking(true);
        let options = WriteOptions::library(options, concat!("polymapper ", env!("CARGO_PKG_VERSION")));
        Ok(Self {
            writer: options.create(NoSeek::new(out))?,
            topics: BTreeMap::new(),
        })
    }

    /// Appends a message; the topic is made with its first.
    ///
    /// # Errors
    /// Those of the output.
    pub fn put(&mut self, topic: &str, kind: &Type, time_ns: u64, data: &[u8]) -> McapResult<()> {
        let (channel_id, sequence) = match self.topics.get_mut(topic) {
            Some((channel, messages)) => {
                *messages = messages.wrapping_add(1);
                (*channel, *messages)
            }
            None => (self.add(topic, kind)?, 0),
        };
        let header = MessageHeader {
            channel_id,
            sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.writer.write_to_known_channel(&header, data)
    }

    fn add(&mut self, topic: &str, kind: &Type) -> McapResult<u16> {
        let definition = kind.schema();
        let schema = self
            .writer
            .add_schema(kind.name, "ros2msg", definition.as_bytes())?;
        let channel = self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
        self.topics.insert(topic.to_owned(), (channel, 0));
        Ok(channel)
    }

    /// Writes what belongs at the end.
    ///
    /// # Errors
    /// Those of the output.
    pub fn finish(&mut self) -> McapResult<()> {
        self.writer.finish().map(|_| ())
    }

    /// What was written to, after [`Self::finish`].
    pub fn into_inner(self) -> W {
        self.writer.into_inner().into_inner()
    }
}

/// Time from the scan before to one without a stamp, nanoseconds: players need times that go on.
const STEP_WITHOUT_STAMP_NS: u64 = 100_000_000;

/// A log of scans on one topic; the odometry of a scan stands before it, on `/odom`. Scans without a stamp are recorded
/// 0.1 s apart; the stamp in the message is zero, since nothing is known of it.
pub(super) struct McapLog<W: Write> {
    recording: Recording<W>,
    topic: String,
    /// When the scan before was recorded.
    last_ns: Option<u64>,
}

impl<W: Write> McapLog<W> {
    pub fn new(out: W, topic: &str) -> io::Result<Self> {
        Ok(Self {
            recording: Recording::new(out).map_err(io::Error::other)?,
            topic: topic.to_owned(),
            last_ns: None,
        })
    }
}

impl<W: Write> ScanWriter for McapLog<W> {
    fn write_scan(&mut self, scan: &LogScan) -> io::Result<()> {
        let stamp_ns = ros2::nanoseconds(scan.stamp_s);
        let recorded_ns = match (scan.stamp_s, self.last_ns) {
            (None, Some(last_ns)) => last_ns.saturating_add(STEP_WITHOUT_STAMP_NS),
            _ => stamp_ns,
        };
        self.last_ns = Some(recorded_ns);
        if let Some(pose) = scan.odometry {
            let odometry = ros2::odometry(stamp_ns, pose);
            self.recording
                .put("/odom", &ODOMETRY, recorded_ns, &odometry)
                .map_err(io::Error::other)?;
        }
        let readings = ros2::laser_scan(stamp_ns, &scan.scan);
        self.recording
            .put(&self.topic, &LASER_SCAN, recorded_ns, &readings)
            .map_err(io::Error::other)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.recording.finish().map_err(io::Error::other)
    }
}
