//! The objects of a rawlog that are read.
//!
//! An object is `0x80 + length` of its class's name, the name, its version, its fields, and 0x88. Numbers are little
//! endian. Fields by version as MRPT has them (BSD): `CObservation2DRangeScan` 0 to 7, `CPose3D` 0 to 3,
//! `CObservationOdometry` 0 to 3, `CActionRobotMovement2D` with odometry, `CPose2D`, matrices.

use polymapper_core::geometry::Pose;
use polymapper_core::scan::ScanGeometry;

use crate::log::keeper::Reading;
use crate::log::number::finite_pose;
use crate::log::ros::Transform;
use crate::log::{LineFault, MAX_BEAMS};

/// Ends every object.
const END: u8 = 0x88;
/// 1970 in ticks of 100 ns since 1601.
const EPOCH_TICKS: i64 = 116_444_736_000_000_000;

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
        let mut fields = Fields { bytes, at: 0 };
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
        Ok((scan, fields.at))
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
        let mut fields = Fields { bytes, at: 0 };
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

fn malformed(what: String) -> LineFault {
    LineFault::Malformed { what }
}

struct Object<'a> {
    name: &'a [u8],
    version: u8,
}

struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Fields<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], LineFault> {
        let left = self.bytes.len() - self.at;
        if count > left {
            return Err(malformed(format!(
                "the object is cut: {count} bytes are needed, {left} are left"
            )));
        }
        let taken = &self.bytes[self.at..self.at + count];
        self.at += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], LineFault> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn u8(&mut self) -> Result<u8, LineFault> {
        Ok(self.array::<1>()?[0])
    }

    fn u32(&mut self) -> Result<u32, LineFault> {
        self.array().map(u32::from_le_bytes)
    }

    fn f32(&mut self) -> Result<f64, LineFault> {
        self.array().map(|b| f64::from(f32::from_le_bytes(b)))
    }

    fn f64(&mut self) -> Result<f64, LineFault> {
        self.array().map(f64::from_le_bytes)
    }

    fn f64s<const N: usize>(&mut self) -> Result<[f64; N], LineFault> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }

    fn text(&mut self) -> Result<String, LineFault> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    /// Seconds since 1970; `None` for what is no time.
    fn stamp_s(&mut self) -> Result<Option<f64>, LineFault> {
        let ticks = self.array().map(i64::from_le_bytes)?;
        Ok((ticks > EPOCH_TICKS).then(|| (ticks - EPOCH_TICKS) as f64 * 1e-7))
    }

    /// The head of an object.
    fn open(&mut self) -> Result<Object<'a>, LineFault> {
        let length = self.u8()?;
        let name = self.take(usize::from(length & 0x7f))?;
        let version = self.u8()?;
        Ok(Object {
            name: name.rsplit(|&b| b == b':').next().unwrap_or(name),
            version,
        })
    }

    /// The head of an object that must be of this class; its version.
    fn open_as(&mut self, class: &str) -> Result<u8, LineFault> {
        let object = self.open()?;
        if object.name != class.as_bytes() {
            return Err(malformed(format!(
                "a {} where a {class} is expected",
                crate::log::error::excerpt(object.name)
            )));
        }
        Ok(object.version)
    }

    fn close(&mut self) -> Result<(), LineFault> {
        match self.u8()? {
            END => Ok(()),
            other => Err(malformed(format!(
                "an object ends with {other:#04x}, {END:#04x} is expected"
            ))),
        }
    }

    /// A `CPose2D`.
    fn pose2d(&mut self) -> Result<Pose, LineFault> {
        let version = self.open_as("CPose2D")?;
        let [x, y, theta] = if version == 0 {
            [self.f32()?, self.f32()?, self.f32()?]
        } else {
            self.f64s()?
        };
        self.close()?;
        finite_pose(x, y, theta).ok_or_else(|| malformed(format!("the pose {x}, {y}, {theta} is none")))
    }

    /// A `CPose3D`.
    fn pose3d(&mut self) -> Result<Transform, LineFault> {
        let pose = match self.open_as("CPose3D")? {
            0 | 1 => of_homogeneous(&self.matrix()?)?,
            2 => {
                let [x, y, z] = self.f64s()?;
                let [qr, qx, qy, qz] = self.f64s()?;
                Transform::new([x, y, z], [qx, qy, qz, qr])
            }
            3 => {
                let place = self.f64s()?;
                let rows = [self.f64s()?, self.f64s()?, self.f64s()?];
                Transform::of_matrix(place, rows)
            }
            version => {
                return Err(malformed(format!(
                    "CPose3D version {version}; up to 3 is expected"
                )));
            }
        };
        self.close()?;
        Ok(pose)
    }

    /// A `CMatrix` (single precision) or `CMatrixD`: rows, columns, elements.
    fn matrix(&mut self) -> Result<Vec<f64>, LineFault> {
        const MOST_ELEMENTS: u64 = 64;
        let object = self.open()?;
        let is_double = match object.name {
            b"CMatrix" | b"CMatrixF" => false,
            b"CMatrixD" => true,
            other => {
                return Err(malformed(format!(
                    "a {} where a matrix is expected",
                    crate::log::error::excerpt(other)
                )));
            }
        };
        let (rows, columns) = (u64::from(self.u32()?), u64::from(self.u32()?));
        if rows * columns > MOST_ELEMENTS {
            return Err(malformed(format!(
                "a matrix of {rows} × {columns}; at most {MOST_ELEMENTS} elements are expected"
            )));
        }
        let mut elements = Vec::new();
        for _ in 0..rows * columns {
            elements.push(if is_double { self.f64()? } else { self.f32()? });
        }
        self.close()?;
        Ok(elements)
    }
}

/// The transform of a 4 × 4 matrix, row by row.
fn of_homogeneous(m: &[f64]) -> Result<Transform, LineFault> {
    let [a, b, c, x, d, e, f, y, g, h, i, z, ..] = m[..] else {
        return Err(malformed(format!(
            "a pose of {} numbers; 16 are expected",
            m.len()
        )));
    };
    Ok(Transform::of_matrix([x, y, z], [[a, b, c], [d, e, f], [g, h, i]]))
}
