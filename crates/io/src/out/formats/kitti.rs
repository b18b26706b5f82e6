//! KITTI odometry poses: a line a placed scan, the upper 3×4 of `map_from_scan` by rows; z is up.
//!
//! The format has no times. The frames are those of the map (x ahead, y left, z up), not of a KITTI camera.

use std::io::Write;

use super::{ExportError, Place, Subject};

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let rows = subject.way(place)?;
    place.write(0, |f| {
        for row in &rows {
            let pose = row.map_from_scan;
            let (sin, cos) = pose.theta_rad.sin_cos();
            let (x, y) = (pose.x, pose.y);
            writeln!(
                f,
                "{cos:.9} {:.9} 0 {x:.4} {sin:.9} {cos:.9} 0 {y:.4} 0 0 1 0",
                0.0 - sin
            )?;
        }
        Ok(())
    })
}
