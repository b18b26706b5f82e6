//! MCAP with standard ROS 2 messages, for Foxglove, Lichtblick, rosbag2 and whatever reads CDR.
//!
//! | topic | message | when |
//! |---|---|---|
//! | `/map_lines` | MarkerArray: a line strip a polyline | at the first scan |
//! | `/map` | OccupancyGrid, as `nav2` writes it | at the first scan |
//! | `/path` | Path: the way of the scanner | at the first scan |
//! | `/tf` | TFMessage: `map` → `laser` | at every placed scan |
//! | `/scan` | LaserScan in `laser` | at every placed scan |
//!
//! No compression: it costs a C library and little is gained over ranges.

mod cdr;
mod messages;

use std::collections::BTreeMap;

use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{McapResult, WriteOptions, Writer};

use super::grid::Grid;
use super::{ExportError, Place, Subject};
use crate::out::atomic::AtomicFile;
use messages::{LASER_SCAN, MARKER_ARRAY, OCCUPANCY_GRID, PATH, TF, Type, nanoseconds};

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let failed = |source| place.library(source);
    let grid = Grid::of(subject, place)?;
    let rows = subject.placed_rows();
    let start_ns = rows.first().map_or(0, |row| nanoseconds(row.time_s));
    let mut recording = Recording::new(place.create(0)?).map_err(failed)?;
    let lines = messages::markers(start_ns, subject.map);
    recording
        .put("/map_lines", &MARKER_ARRAY, start_ns, &lines)
        .map_err(failed)?;
    let cells = messages::occupancy_grid(start_ns, &grid);
    recording
        .put("/map", &OCCUPANCY_GRID, start_ns, &cells)
        .map_err(failed)?;
    if !rows.is_empty() {
        let path = messages::path(start_ns, &rows);
        recording.put("/path", &PATH, start_ns, &path).map_err(failed)?;
    }
    if subject.scans.is_some() {
        subject.for_each_scan(&mut |scan| {
            let time_ns = nanoseconds(scan.time_s);
            let readings = messages::laser_scan(time_ns, scan.readings);
            recording
                .put("/tf", &TF, time_ns, &messages::tf(time_ns, scan.map_from_scan))
                .and_then(|()| recording.put("/scan", &LASER_SCAN, time_ns, &readings))
                .map_err(std::io::Error::other)
        })?;
    } else {
        for row in &rows {
            let time_ns = nanoseconds(row.time_s);
            let tf = messages::tf(time_ns, row.map_from_scan);
            recording.put("/tf", &TF, time_ns, &tf).map_err(failed)?;
        }
    }
    Ok(recording.finish().map_err(failed)?.finish()?)
}

/// The file as it grows.
struct Recording {
    writer: Writer<NoSeek<AtomicFile>>,
    /// Channel and messages so far, by topic.
    topics: BTreeMap<&'static str, (u16, u32)>,
}

impl Recording {
    fn new(file: AtomicFile) -> McapResult<Self> {
        let options = WriteOptions::new()
            .compression(None)
            .disable_seeking(true)
            .profile("ros2")
            .library(concat!("polymapper ", env!("CARGO_PKG_VERSION")));
        Ok(Self {
            writer: options.create(NoSeek::new(file))?,
            topics: BTreeMap::new(),
        })
    }

    fn put(&mut self, topic: &'static str, kind: &Type, time_ns: u64, data: &[u8]) -> McapResult<()> {
        let (channel_id, sequence) = match self.topics.get(topic) {
            Some(&known) => known,
            None => {
                let schema = self
                    .writer
                    .add_schema(kind.name, "ros2msg", kind.schema().as_bytes())?;
                (
                    self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?,
                    0,
                )
            }
        };
        self.topics.insert(topic, (channel_id, sequence.wrapping_add(1)));
        let header = MessageHeader {
            channel_id,
            sequence,
            log_time: time_ns,
            publish_time: time_ns,
        };
        self.writer.write_to_known_channel(&header, data)
    }

    fn finish(mut self) -> McapResult<AtomicFile> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}
