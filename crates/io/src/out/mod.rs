//! What a build leaves behind, as files: map, trajectory, report, polylines of scans; and the [`formats`] that a
//! map can be exported to.
//!
//! Every writer takes any [`std::io::Write`]; [`AtomicFile`] makes sure that a file is there whole or not at all.
//! Numbers are written with as many decimals as carry meaning: 0.1 mm and 1 µrad. `docs/map-format.md` describes
//! every file for those who read them.

mod atomic;
mod decimals;
pub mod formats;
mod keyframes;
mod locations;
mod map_file;
mod map_file_in;
mod polylines;
mod quality;
mod quality_report;
mod report;
mod trajectory;
mod trajectory_in;

pub use atomic::{AtomicFile, OutputError, prepare_folder};
pub(crate) use formats::{ENGINEERING_2D, FRAME_ID, POLYLINE_ID, UNIT_ATTRIBUTE, XDATA_APPLICATION};
pub use keyframes::{KeyframeFile, KeyframeFileError, read_keyframes, write_keyframes};
pub use locations::{LocatedPose, LocationFormat, LocationRow};
pub use map_file::{MAP_FORMAT, MAP_VERSION, MapFile, write_map};
pub(crate) use map_file_in::{FARTHEST_M, map_from_json};
pub use map_file_in::{MapFileError, read_map};
pub use polylines::write_polylines;
pub use quality_report::{LooseReport, QualityReport, RankReport};
pub use report::{InputReport, MapReport, Report, ScanReport, StageTime};
pub use trajectory::{Outcome, TrajectoryRow, write_trajectory_csv, write_trajectory_tum};
pub use trajectory_in::{TrajectoryFileError, read_trajectory_csv};
