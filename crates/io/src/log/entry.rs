//! What is asked of a log, and what comes out of it.

use std::collections::BTreeMap;

use polymapper_core::geometry::Pose;
use polymapper_core::scan::Scan;

use super::{Layout, LineFault, Unit};

/// What is read from a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Hand out the poses that the log holds. Without it they are not even parsed.
    pub use_odometry: bool,
    /// Message kind (`RLASER`) or topic (`/rear_scan`) of the laser to read, where the log has several; the best
    /// one unless told.
    pub laser: Option<String>,
    /// What the columns of a text file are; told by the file unless given.
    pub layout: Option<Layout>,
    /// Read on behind a place where a recording does not hang together, as far as that can be told.
    pub salvage: bool,
    /// Hand out the ranges as they stand in the log, too.
    pub keep_raw: bool,
}

/// One scan of a log.
#[derive(Clone, Debug)]
pub struct LogScan {
    /// 0-based place among the lines of this laser in file order; lines that cannot be used count too.
    pub index: usize,
    /// 1-based number of the line or message in its file.
    pub line: u64,
    /// Time stamp, seconds; `None` where the format has none. File order is the true order: stamps
    /// may run backwards.
    pub stamp_s: Option<f64>,
    /// Ranges and geometry.
    pub scan: Scan,
    /// Pose that the robot's own odometry gave (`odometry_from_scan` or the robot's, as the log has it); only
    /// with [`ReadOptions::use_odometry`].
    pub odometry: Option<Pose>,
    /// The ranges before no returns were marked, metres, counter-clockwise; only with [`ReadOptions::keep_raw`].
    pub raw_ranges_m: Option<Vec<f64>>,
}

/// A line or message of the laser that holds no usable scan.
#[derive(Clone, Debug, PartialEq)]
pub struct BadScan {
    /// As in [`LogScan::index`].
    pub index: usize,
    /// As in [`LogScan::line`].
    pub line: u64,
    /// What the number counts.
    pub unit: Unit,
    /// What is wrong with it.
    pub fault: LineFault,
}

/// What one laser line gave.
#[derive(Clone, Debug)]
pub enum Entry {
    /// A scan.
    Scan(LogScan),
    /// A line that could not be used.
    Bad(BadScan),
}

/// What went past while a log was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Lines of text, or messages.
    pub lines: u64,
    /// Bytes after decompression.
    pub bytes: u64,
    /// Message kind or topic of the laser that was read, once known.
    pub laser: Option<String>,
    /// Scans handed out.
    pub scans: usize,
    /// Lines of the laser that could not be used.
    pub bad_scans: usize,
    /// Scans whose stamp is earlier than that of the scan before.
    pub stamps_backwards: usize,
    /// Messages of other kinds or topics, by name.
    pub other_messages: BTreeMap<String, u64>,
    /// Why those are not used, by the same names; only where there is more to say than that they are no scans.
    pub reasons: BTreeMap<String, String>,
    /// What of the log was not read although it does not break off, in words for the user.
    pub lost: Option<String>,
    /// What was assumed, in words for the user.
    pub notes: Vec<String>,
}
