//! The objects of a rawlog that are read: scans and odometry.
//!
//! Fields by version as MRPT has them (BSD): `CObservation2DRangeScan` 0 to 7, `CObservationOdometry` 0 to 3,
//! `CActionRobotMovement2D` with odometry.

use polymapper_core::geometry::Pose;
use polymapper_core::scan::ScanGeometry;

use super::fields::{Fields, malformed};
use crate::log::keeper::Reading;
use crate::log::ros::Transform;
use crate::log::{LineFault, MAX_BEAMS};

/// A `CObservation2DRangeScan`.
pub(super) struct Scan {
    aperture_rad: f64,
    right_to_left: bool,
    max_range_m: f64,
    /// `robot_from_sensor`
    sensor_pose: Transform,
    /// NaN where the log says that they are not valid.
    ranges_m: Vec<f64>,
    stamp_s: Option<f64>,
    pub label: String,
}

impl Scan {
    /// Reads the object at the start of `bytes`; with it, how many bytes it has.
    ///
    /// # Errors
    /// A cut object, an unknown version, a number of beams that no scanner has.
    pub fn read(bytes: &[u8]) -> Result<(Self, usize), LineFault> {
        let mut fields = Fields::new(bytes);
        let version = fields.open()?.version;
        if version > 7 {
            return Err(malformed(format!(
                "CObservation2DRangeScan version {version}; up to 7 is expected"
            )));
        }
        let aperture_rad = fields.f32()?;
        let right_to_left = fields.u8()? != 0;
        let max_range_m = fields.f32()?;
        let sensor_pose = fields.pose3d()?;
        if version < 6 {
            fields.matrix()?;
        }
        let beams = fields.u32()? as usize;
        if beams == 0 || beams > MAX_BEAMS {
            return Err(LineFault::Beams {
                header: beams as u64,
                limit: MAX_BEAMS,
            });
        }
        let mut ranges_m = Vec::with_capacity(beams);
        for _ in 0..beams {
            ranges_m.push(fields.f32()?);
        }
        if version >= 1 {
            for range_m in &mut ranges_m {
                if fields.u8()? == 0 {
                    *range_m = f64::NAN;
                }
            }
        }
        if version >= 2 {
            fields.f32()?;
        }
        let mut stamp_s = None;
        if version >= 3 {
            stamp_s = fields.stamp_s()?;
        }
        if version >= 4 {
            fields.f32()?;
        }
        let mut label = String::new();
        if version >= 5 {
            label = fields.text()?;
            fields.f64()?;
        }
        if version >= 7 && fields.u8()? != 0 {
            fields.take(4 * beams)?;
        }
        let scan = Self {
            aperture_rad,
            right_to_left,
            max_range_m,
            sensor_pose,
            ranges_m,
            stamp_s,
            label,
        };
        Ok((scan, fields.read_bytes()))
    }

    pub fn is_upside_down(&self) -> bool {
        self.sensor_pose.up() < 0.0
    }

    /// Place of the scanner on the robot, in the plane; `None` unless finite.
    pub fn mount(&self) -> Option<Pose> {
        self.sensor_pose.planar()
    }

    /// The scan as a reading.
    ///
    /// # Errors
    /// Angles that make no sense.
    pub fn into_reading(self, odometry: Option<Pose>) -> Result<Reading, LineFault> {
        let mut ranges_m = self.ranges_m;
        let beams = ranges_m.len();
        let step_rad = self.aperture_rad / beams.saturating_sub(1).max(1) as f64;
        let first_rad = -0.5 * self.aperture_rad;
        let clockwise = !self.right_to_left;
        if clockwise != (self.sensor_pose.up() < 0.0) {
            ranges_m.reverse();
        }
        let geometry = ScanGeometry::new(first_rad, step_rad, beams)?;
        Ok(Reading {
            geometry: geometry.with_limits(0.0, self.max_range_m),
            ranges_m,
            stamp_s: self.stamp_s,
            odometry,
        })
    }
}

/// What an object says about the robot's way.
pub(super) enum Odometry {
    /// Where it is.
    At(Pose),
    /// How it went since the frame before.
    Step(Pose),
}

impl Odometry {
    /// Reads the object at the start of `bytes`.
    ///
    /// # Errors
    /// A cut object, or an action whose step does not come from odometry.
    pub fn read(bytes: &[u8], is_step: bool) -> Result<Self, LineFault> {
        let mut fields = Fields::new(bytes);
        fields.open()?;
        if !is_step {
            return Ok(Self::At(fields.pose2d()?));
        }
        let method = fields.u32()?;
        if method != 0 {
            return Err(malformed(format!(
                "a CActionRobotMovement2D of method {method}; 0, odometry, is expected"
            )));
        }
        Ok(Self::Step(fields.pose2d()?))
    }
}
