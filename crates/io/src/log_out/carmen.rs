//! CARMEN, one line a scan; see the reader for the fields.
//!
//! Numbers are written with as many digits as it takes to read the same bits again. A scan without a stamp has `nan`
//! for one.

use std::f64::consts::{FRAC_PI_2, PI};
use std::io::{self, Write};

use polymapper_core::geometry::Pose;
use polymapper_core::scan::{Scan, ScanGeometry};

use super::ScanWriter;
use crate::log::LogScan;

/// No return in a `FLASER` line: the code of the published logs, beyond what any reader takes for a wall.
const NO_RETURN_M: f64 = 81.83;

/// A scan, and where and when it was taken.
pub(crate) struct CarmenLine<'a> {
    pub scan: &'a Scan,
    pub pose: Pose,
    pub stamp_s: Option<f64>,
}

impl CarmenLine<'_> {
    /// Writes it as `ROBOTLASER1`, which holds its geometry; a beam without return holds the maximum range.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_robotlaser(&self, out: &mut impl Write) -> io::Result<()> {
        let geometry = self.scan.geometry();
        let (beams, step_rad, max_m) = (geometry.beams(), geometry.step_rad(), geometry.max_range_m());
        let width_rad = step_rad * beams.saturating_sub(1) as f64;
        let first_rad = geometry.bearing_rad(0);
        write!(
            out,
            "ROBOTLASER1 0 {first_rad} {width_rad} {step_rad} {max_m} 0.01 0 {beams}"
        )?;
        self.write_ranges(out, max_m)?;
        write!(out, " 0")?;
        self.write_poses(out)?;
        write!(out, " 0 0 0 0 0")?;
        self.write_stamps(out)
    }

    /// Writes it as `FLASER`, which old tools read, if such a line stands for its bearings; else as `ROBOTLASER1`.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_for_old_tools(&self, out: &mut impl Write) -> io::Result<()> {
        let geometry = self.scan.geometry();
        if !is_implied(geometry) {
            return self.write_robotlaser(out);
        }
        write!(out, "FLASER {}", geometry.beams())?;
        self.write_ranges(out, NO_RETURN_M)?;
        self.write_poses(out)?;
        self.write_stamps(out)
    }

    fn write_ranges(&self, out: &mut impl Write, no_return_m: f64) -> io::Result<()> {
        for &range_m in self.scan.ranges_m() {
            write!(out, " {}", if range_m.is_nan() { no_return_m } else { range_m })?;
        }
        Ok(())
    }

    /// The same pose for the laser and the robot.
    fn write_poses(&self, out: &mut impl Write) -> io::Result<()> {
        let Pose { x, y, theta_rad } = self.pose;
        for _ in ["laser", "robot"] {
            write!(out, " {x} {y} {theta_rad}")?;
        }
        Ok(())
    }

    fn write_stamps(&self, out: &mut impl Write) -> io::Result<()> {
        let stamp_s = self.stamp_s.unwrap_or(f64::NAN);
        writeln!(out, " {stamp_s} polymapper {stamp_s}")
    }
}

/// Whether a `FLASER` line, which holds no geometry, stands for these bearings: 180 or 181 beams 1° apart, 360 or 361
/// beams 0.5° apart, from −90°.
fn is_implied(geometry: &ScanGeometry) -> bool {
    let step_rad = match geometry.beams() {
        180 | 181 => PI / 180.0,
        360 | 361 => PI / 360.0,
        _ => return false,
    };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    near(geometry.step_rad(), step_rad) && near(geometry.bearing_rad(0), -FRAC_PI_2)
}

/// A log of `ROBOTLASER1` lines; pose fields are zero where there is no odometry.
pub(super) struct CarmenLog<W> {
    out: W,
}

impl<W: Write> CarmenLog<W> {
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

impl<W: Write> ScanWriter for CarmenLog<W> {
    fn write_scan(&mut self, scan: &LogScan) -> io::Result<()> {
        let line = CarmenLine {
            scan: &scan.scan,
            pose: scan.odometry.unwrap_or_default(),
            stamp_s: scan.stamp_s,
        };
        line.write_robotlaser(&mut self.out)
    }

    fn finish(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
