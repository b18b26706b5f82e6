//! The record of a build: one JSON object a line, each with one key that says what it is.
//!
//! | line | when | what |
//! |---|---|---|
//! | `about` | first | the log, the program |
//! | `frame` | every scan | pose, how good it is, what was decided; small |
//! | `walls` | every scan that is merged | its polylines, laser frame; those that move are named |
//! | `moved` | poses change afterwards | which, and how |
//! | `map` | now and then, and at the end | what has changed in the map since the last one |
//! | `skipped` | a line of the log is unusable | which, and why |
//! | `detail` | every scan | returns, polylines, the search for the pose; large, sent when asked for |
//! | `end` | last | whether the log was read to its end |
//!
//! Scans are numbered from 0 in the order in which the mapper took them (`n`); `scan` is the place in the log, which
//! counts unusable lines too. Poses are metres and radians, map frame. Lists of points are whole millimetres, the first
//! point and then differences: `[x, y, dx, dy, ..]`. `docs/replay-format.md` describes every field.

mod from_step;
mod map_change;
mod moved;
mod points;

use serde::{Deserialize, Serialize};

pub(crate) use from_step::{detail, frame, walls};
pub use map_change::{MapChange, MapState, PolylineRecord};
pub use moved::{Moved, Run, ShownPoses};
pub use points::{Chain, chain, polyline};

/// Value of [`About::format`].
pub const FORMAT: &str = "polymapper-replay";
/// Version of the format that is written, and the newest that is read.
pub const VERSION: u64 = 1;

/// x and y in metres, heading in radians.
pub type PoseRecord = [f64; 3];

/// One line.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Line {
    /// What the record is about.
    About(About),
    /// What became of a scan.
    Frame(Frame),
    /// The polylines of a merged scan.
    Walls(Walls),
    /// Poses that have changed.
    Moved(Moved),
    /// What has changed in the map.
    Map(MapChange),
    /// A line of the log without a usable scan.
    Skipped(Skipped),
    /// All else about a scan.
    Detail(Box<Detail>),
    /// Nothing follows.
    End(End),
}

/// What the record is about.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct About {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u64,
    /// Name and version of the program.
    pub generator: String,
    /// Name of the log.
    pub log: String,
    /// What is not there and cannot be shown; absent when all is there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<String>,
}

/// What became of a scan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Place in the log.
    pub scan: usize,
    /// Stamp of the log, seconds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stamp_s: Option<f64>,
    /// The laser in the map; absent when the scan was not placed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pose: Option<PoseRecord>,
    /// Why it was not placed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Beams that returned.
    pub returns: usize,
    /// Of the beams that the map says something of, the share that ends on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fit: Option<f64>,
    /// Share of the beams that the map says something of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub known: Option<f64>,
    /// Share of the beams that went through walls of the map.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub through: Option<f64>,
    /// Share of the returns that found a side in the alignment.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub matched: Option<f64>,
    /// Root mean square distance of the matched returns to their sides, millimetres.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rms_mm: Option<f64>,
    /// Standard deviations of the place by what the walls tell: along the longer axis and across, metres, and the
    /// direction of the longer axis, radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ellipse: Option<[f64; 3]>,
    /// Direction in which the walls leave the place open, radians.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open_rad: Option<f64>,
    /// By how much the pose leads the next best, different one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lead: Option<f64>,
    /// Whether it was merged.
    #[serde(default, skip_serializing_if = "is_false")]
    pub merged: bool,
    /// Whether the predicted pose did not settle the place, so that it was searched by shape.
    #[serde(default, skip_serializing_if = "is_false")]
    pub searched: bool,
    /// Number of the scan at whose place it was recognised to be.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recognised: Option<usize>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde wants a reference")]
fn is_false(value: &bool) -> bool {
    !*value
}

/// The polylines of a merged scan.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Walls {
    /// Number of the scan.
    pub n: usize,
    /// Laser frame.
    pub polylines: Vec<Chain>,
    /// Numbers of those that belong to moving objects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<usize>,
}

/// A line of the log without a usable scan.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Skipped {
    /// Place in the log.
    pub scan: usize,
    /// 1-based line number.
    pub line: u64,
    /// What is wrong with it.
    pub why: String,
}

/// All else about a scan.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Detail {
    /// Number of the scan.
    pub n: usize,
    /// Bearing of beam 0 and step between beams, radians.
    pub bearings_rad: [f64; 2],
    /// Runs of beams that returned: number of the first beam, its range in millimetres, then differences.
    pub returns: Vec<Vec<i64>>,
    /// Laser frame.
    pub polylines: Vec<Chain>,
    /// Numbers of those that belong to moving objects.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moving: Vec<usize>,
    /// How the place was searched, when the predicted pose did not settle it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<Search>,
}

/// A search for the place by shape. Everything lies in the frame of the last scan that was placed before.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Search {
    /// Number of the last placed scan.
    pub last: usize,
    /// The polylines that were matched with.
    pub virtual_scan: Vec<Chain>,
    /// Poses, best first.
    pub hypotheses: Vec<HypothesisRecord>,
    /// Which polylines belong together at the best of them.
    pub pairs: Vec<PairRecord>,
}

/// A pose and what speaks for it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct HypothesisRecord {
    /// Frame of the last placed scan.
    pub pose: PoseRecord,
    /// What hypotheses are ranked by; only differences mean something.
    pub score: f64,
    /// Of the beams that the map says something of, the share that ends on it.
    pub fit: f64,
    /// Share of the beams that went through walls of the map.
    pub through: f64,
}

/// Polylines that belong together.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PairRecord {
    /// Of the scan.
    pub scan: Vec<usize>,
    /// Of the virtual scan.
    pub reference: Vec<usize>,
    /// How unlike their shapes are, rad².
    pub cost_rad2: f64,
}

/// The end of the record.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct End {
    /// Why the record does not hold the whole log; absent when it does.
    pub partial: Option<String>,
}

/// As many decimals as carry meaning; no negative zero.
pub(crate) fn rounded(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit + 0.0
}

pub(crate) fn pose_record(pose: polymapper_core::geometry::Pose) -> PoseRecord {
    [
        rounded(pose.x, 1e4),
        rounded(pose.y, 1e4),
        rounded(pose.theta_rad, 1e5),
    ]
}
