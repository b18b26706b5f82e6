//! MCAP with standard ROS 2 messages, for Foxglove, Lichtblick, rosbag2 and whatever reads CDR.
//!
//! | topic | message | when |
//! |---|---|---|
//! | `/map_lines` | MarkerArray: a line strip a polyline | at the first scan |
//! | `/map` | OccupancyGrid, as `nav2` writes it | at the first scan |
//! | `/path` | Path: the way of the scanner | at the first scan |
//! | `/tf` | TFMessage: `map` → `laser` | at every placed scan |
//! | `/scan` | LaserScan in `laser` | at every placed scan |

mod messages;

use super::grid::Grid;
use super::{ExportError, Place, Subject};
use crate::log_out::mcap::Recording;
use crate::log_out::ros2::{self, LASER_SCAN, TF};
use messages::{MARKER_ARRAY, OCCUPANCY_GRID, PATH};

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let failed = |source| place.failed(source);
    let grid = Grid::of(subject, place)?;
    let rows = subject.placed_rows();
    let start_ns = rows.first().map_or(0, |row| ros2::nanoseconds(Some(row.time_s)));
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
            let time_ns = ros2::nanoseconds(Some(scan.time_s));
            let readings = ros2::laser_scan(time_ns, scan.readings);
            recording
                .put("/tf", &TF, time_ns, &ros2::tf(time_ns, scan.map_from_scan))
                .and_then(|()| recording.put("/scan", &LASER_SCAN, time_ns, &readings))
                .map_err(std::io::Error::other)
        })?;
    } else {
        for row in &rows {
            let time_ns = ros2::nanoseconds(Some(row.time_s));
            let tf = ros2::tf(time_ns, row.map_from_scan);
            recording.put("/tf", &TF, time_ns, &tf).map_err(failed)?;
        }
    }
    recording.finish().map_err(failed)?;
    Ok(recording.into_inner().finish()?)
}
