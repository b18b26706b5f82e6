//! MCAP with the messages of ROS 2, in chunks of 1 MB, not packed (as `ros2 bag record` writes it); the
//! odometry of a scan stands before it.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{WriteOptions, Writer};

use super::ScanWriter;
use super::ros2::{Definition, LASER_SCAN, ODOMETRY, Time, laser_scan, odometry};
use crate::log::LogScan;

pub(super) struct McapWriter<W: Write> {
    writer: Writer<NoSeek<W>>,
    scans: u16,
    /// Made with the first pose.
    odometry: Option<u16>,
    sequence: u32,
}

impl<W: Write> McapWriter<W> {
    pub fn new(out: W, topic: &str) -> io::Result<Self> {
        let options = WriteOptions::new()
            .profile("ros2")
            .library(concat!("polymapper ", env!("CARGO_PKG_VERSION")))
            .compression(None)
            .disable_seeking(true);
        let mut writer = options.create(NoSeek::new(out)).map_err(io::Error::other)?;
        let topic = if topic.starts_with('/') { topic } else { "/scan" };
        let scans = add_channel(&mut writer, topic, &LASER_SCAN)?;
        Ok(Self {
            writer,
            scans,
            odometry: None,
            sequence: 0,
        })
    }

    fn write(&mut self, channel_id: u16, time: Time, data: &[u8]) -> io::Result<()> {
        let time_ns = time.nanoseconds_in_all();
        let header = MessageHeader {
            channel_id,
            sequence: self.sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.writer
            .write_to_known_channel(&header, data)
            .map_err(io::Error::other)
    }
}

fn add_channel<W: Write>(
    writer: &mut Writer<NoSeek<W>>,
    topic: &str,
    definition: &Definition,
) -> io::Result<u16> {
    let schema = writer
        .add_schema(definition.name, "ros2msg", definition.text.as_bytes())
        .map_err(io::Error::other)?;
    writer
        .add_channel(schema, topic, "cdr", &BTreeMap::new())
        .map_err(io::Error::other)
}

impl<W: Write> ScanWriter for McapWriter<W> {
    fn write_scan(&mut self, scan: &LogScan) -> io::Result<()> {
        let time = Time::of(scan.stamp_s);
        if let Some(pose) = scan.odometry {
            let channel = match self.odometry {
                Some(channel) => channel,
                None => *self
                    .odometry
                    .insert(add_channel(&mut self.writer, "/odom", &ODOMETRY)?),
            };
            self.write(channel, time, &odometry(pose, time))?;
        }
        self.write(self.scans, time, &laser_scan(&scan.scan, time))
    }

    fn finish(&mut self) -> io::Result<()> {
        self.writer.finish().map(|_| ()).map_err(io::Error::other)
    }
}
