//! CARMEN, one `ROBOTLASER1` line a scan; see the reader for its fields.
//!
//! Numbers are written with as many digits as it takes to read the same bits again. A beam without return holds the
//! maximum range; a scan without a stamp has `nan` for one; pose fields are zero where there is no odometry.

use std::io::{self, Write};

use polymapper_core::geometry::Pose;

use super::ScanWriter;
use crate::log::LogScan;

pub(super) struct CarmenWriter<W> {
    out: W,
}

impl<W: Write> CarmenWriter<W> {
    pub fn new(mut out: W) -> io::Result<Self> {
        writeln!(
            out,
            "# ROBOTLASER1 laser_type start_angle field_of_view angular_resolution maximum_range accuracy remission_mode \
             num_readings [range_readings] num_remissions [remission values] laser_pose_x laser_pose_y laser_pose_theta \
             robot_pose_x robot_pose_y robot_pose_theta laser_tv laser_rv forward_safety_dist side_safty_dist turn_axis \
             timestamp host logger_timestamp"
        )?;
        Ok(Self { out })
    }
}

impl<W: Write> ScanWriter for CarmenWriter<W> {
    fn write_scan(&mut self, entry: &LogScan) -> io::Result<()> {
        let (out, scan) = (&mut self.out, &entry.scan);
        let geometry = scan.geometry();
        let (beams, step_rad, max_m) = (geometry.beams(), geometry.step_rad(), geometry.max_range_m());
        let width_rad = step_rad * beams.saturating_sub(1) as f64;
        let first_rad = geometry.bearing_rad(0);
        write!(
            out,
            "ROBOTLASER1 0 {first_rad} {width_rad} {step_rad} {max_m} 0.01 0 {beams}"
        )?;
        for &range_m in scan.ranges_m() {
            write!(out, " {}", if range_m.is_nan() { max_m } else { range_m })?;
        }
        let Pose { x, y, theta_rad } = entry.odometry.unwrap_or_default();
        let stamp_s = entry.stamp_s.unwrap_or(f64::NAN);
        write!(out, " 0")?;
        for _ in ["laser", "robot"] {
            write!(out, " {x} {y} {theta_rad}")?;
        }
        writeln!(out, " 0 0 0 0 0 {stamp_s} polymapper {stamp_s}")
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
