//! Logs out: the one writer of each format, for logs that are converted and for scans that are exported with the
//! poses of a map.
//!
//! In go scans as they were read ([`LogScan`], with `use_odometry`), out comes a file that any reader of the format
//! reads, this crate's too. Beams without a return are written as the format has it; what a device said instead of a
//! range, intensities, and other messages are not carried over.

pub(crate) mod carmen;
pub(crate) mod cdr;
pub(crate) mod mcap;
pub(crate) mod ros2;

use std::io::{self, Write};

use crate::log::LogScan;

/// A format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogFormat {
    /// CARMEN, `ROBOTLASER1`: text, every bit of ranges, bearings and stamps kept.
    Carmen,
    /// MCAP with `sensor_msgs/msg/LaserScan` and `nav_msgs/msg/Odometry`: single precision, as the messages have it.
    Mcap,
}

impl LogFormat {
    /// The format that a file name asks for by its ending; `.gz` after it is passed over.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        let name = name.to_ascii_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        match name.rsplit_once('.')?.1 {
            "log" | "clf" | "carmen" => Some(Self::Carmen),
            "mcap" => Some(Self::Mcap),
            _ => None,
        }
    }

    /// A writer of this format onto `out`; `topic` names the scans where the format has topics.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn writer<'a>(self, out: impl Write + 'a, topic: &str) -> io::Result<Box<dyn ScanWriter + 'a>> {
        Ok(match self {
            Self::Carmen => Box::new(carmen::CarmenLog::new(out)?),
            Self::Mcap => Box::new(mcap::McapLog::new(out, topic)?),
        })
    }
}

/// Writes scan after scan.
pub trait ScanWriter {
    /// Appends a scan.
    ///
    /// # Errors
    /// Those of the output.
    fn write_scan(&mut self, scan: &LogScan) -> io::Result<()>;

    /// Writes what belongs at the end.
    ///
    /// # Errors
    /// Those of the output.
    fn finish(&mut self) -> io::Result<()>;
}
