//! CARMEN log of the placed scans with the poses of the map in place of odometry.
//!
//! `FLASER` lines, which old tools read, wherever they can stand for the bearings; all others `ROBOTLASER1`.

use polymapper_core::geometry::Pose;

use super::{ExportError, Place, Subject};
use crate::log_out::carmen::CarmenLine;
use crate::out::decimals::{rounded_4, rounded_6};

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    if subject.scans.is_none() || subject.trajectory.is_none() {
        return Err(place.needs("the scans and the trajectory: give --log LOG --trajectory trajectory.csv"));
    }
    let mut file = place.create(0)?;
    subject.for_each_scan(&mut |scan| {
        let line = CarmenLine {
            scan: scan.readings,
            pose: rounded(scan.map_from_scan),
            // The stamps of the log, also where they run backwards: the order of the lines is the true one.
            stamp_s: Some(scan.stamp_s.unwrap_or(scan.time_s)),
        };
        line.write_for_old_tools(&mut file)
    })?;
    Ok(file.finish()?)
}

/// To 0.1 mm and 1 µrad, as in the trajectory that `build` writes.
fn rounded(pose: Pose) -> Pose {
    Pose::new(rounded_4(pose.x), rounded_4(pose.y), rounded_6(pose.theta_rad))
}
