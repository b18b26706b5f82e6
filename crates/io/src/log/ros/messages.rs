//! The messages that hold scans, mountings and odometry.
//!
//! Definitions: `sensor_msgs/LaserScan`, `sensor_msgs/MultiEchoLaserScan`, `nav_msgs/Odometry`,
//! `tf2_msgs/TFMessage` (`tf/tfMessage` of ROS 1 is the same), fields up to the last one that is used.

use super::super::LineFault;
use super::transform::Transform;
use super::wire::{Encoding, Fields, check_beams};

/// `std_msgs/Header`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    /// Zero where the driver did not fill it in.
    pub stamp_s: f64,
    pub frame: String,
}

impl Header {
    fn read(fields: &mut Fields<'_>, encoding: Encoding) -> Result<Self, LineFault> {
        if encoding == Encoding::Ros1 {
            fields.u32("the sequence number")?;
        }
        let stamp_s = fields.stamp_s()?;
        let frame = fields.text("the frame")?;
        Ok(Self { stamp_s, frame })
    }
}

/// A revolution as the driver wrote it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LaserScan {
    pub header: Header,
    pub angle_min_rad: f64,
    pub angle_max_rad: f64,
    pub angle_increment_rad: f64,
    pub range_min_m: f64,
    pub range_max_m: f64,
    /// In the order of the message; the first echo where a beam has several.
    pub ranges_m: Vec<f64>,
}

impl LaserScan {
    /// Reads a `LaserScan`, or a `MultiEchoLaserScan` when `echoes`.
    ///
    /// # Errors
    /// A message that is cut, or has no beams or too many.
    pub fn read(data: &[u8], encoding: Encoding, echoes: bool) -> Result<Self, LineFault> {
        let mut fields = Fields::new(data, encoding)?;
        let header = Header::read(&mut fields, encoding)?;
        let angle_min_rad = fields.f32("angle_min")?;
        let angle_max_rad = fields.f32("angle_max")?;
        let angle_increment_rad = fields.f32("angle_increment")?;
        fields.f32("time_increment")?;
        fields.f32("scan_time")?;
        Ok(Self {
            header,
            angle_min_rad,
            angle_max_rad,
            angle_increment_rad,
            range_min_m: fields.f32("range_min")?,
            range_max_m: fields.f32("range_max")?,
            ranges_m: if echoes {
                first_echoes(&mut fields)?
            } else {
                fields.ranges()?
            },
        })
    }
}

/// The nearest surface that answered on each beam; NaN where none did.
fn first_echoes(fields: &mut Fields<'_>) -> Result<Vec<f64>, LineFault> {
    let beams = fields.count(4, "beams")?;
    check_beams(beams)?;
    let mut ranges_m = Vec::with_capacity(beams);
    for _ in 0..beams {
        let echoes = fields.count(4, "echoes")?;
        let mut first = f64::NAN;
        for k in 0..echoes {
            let range_m = fields.f32("an echo")?;
            if k == 0 {
                first = range_m;
            }
        }
        ranges_m.push(first);
    }
    Ok(ranges_m)
}

/// The part of `nav_msgs/Odometry` that says where the robot is.
pub(super) struct Odometry {
    pub header: Header,
    /// Frame that the pose is of.
    pub child_frame: String,
    /// `odometry_from_child`
    pub pose: Transform,
}

impl Odometry {
    /// # Errors
    /// A message that is cut.
    pub fn read(data: &[u8], encoding: Encoding) -> Result<Self, LineFault> {
        let mut fields = Fields::new(data, encoding)?;
        Ok(Self {
            header: Header::read(&mut fields, encoding)?,
            child_frame: fields.text("the child frame")?,
            pose: transform(&mut fields)?,
        })
    }
}

/// `geometry_msgs/TransformStamped`
pub(super) struct StampedTransform {
    /// Frame of the parent in the header.
    pub header: Header,
    pub child_frame: String,
    /// `parent_from_child`
    pub transform: Transform,
}

/// Reads a `TFMessage`.
///
/// # Errors
/// A message that is cut.
pub(super) fn read_transforms(data: &[u8], encoding: Encoding) -> Result<Vec<StampedTransform>, LineFault> {
    const LEAST_BYTES: usize = 72;
    let mut fields = Fields::new(data, encoding)?;
    let count = fields.count(LEAST_BYTES, "transforms")?;
    let one = |_| {
        Ok(StampedTransform {
            header: Header::read(&mut fields, encoding)?,
            child_frame: fields.text("the child frame")?,
            transform: transform(&mut fields)?,
        })
    };
    (0..count).map(one).collect()
}

/// Three numbers of a place and four of a quaternion, x y z w.
fn transform(fields: &mut Fields<'_>) -> Result<Transform, LineFault> {
    let mut numbers = [0.0; 7];
    for number in &mut numbers {
        *number = fields.f64("a transform")?;
    }
    let [x, y, z, qx, qy, qz, qw] = numbers;
    Ok(Transform::new([x, y, z], [qx, qy, qz, qw]))
}
