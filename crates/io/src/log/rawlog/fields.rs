//! Fields of a serialised object, one after another.
//!
//! An object is `0x80 + length` of its class's name, the name, its version, its fields, and 0x88. Numbers are little
//! endian. By version as MRPT has them (BSD): `CPose3D` 0 to 3, `CPose2D`, matrices.

use polymapper_core::geometry::Pose;

use crate::log::LineFault;
use crate::log::number::finite_pose;
use crate::log::ros::Transform;

/// Ends every object.
const END: u8 = 0x88;
/// 1970 in ticks of 100 ns since 1601.
const EPOCH_TICKS: i64 = 116_444_736_000_000_000;

pub(super) fn malformed(what: String) -> LineFault {
    LineFault::Malformed { what }
}

/// The head of an object.
pub(super) struct Object<'a> {
    /// Of its class, without a namespace.
    pub name: &'a [u8],
    pub version: u8,
}

/// Reads field after field.
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Fields<'a> {
    /// The fields of the object at the start of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// How many bytes were read.
    pub fn read_bytes(&self) -> usize {
        self.at
    }

    pub fn take(&mut self, count: usize) -> Result<&'a [u8], LineFault> {
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

    pub fn u8(&mut self) -> Result<u8, LineFault> {
        Ok(self.array::<1>()?[0])
    }

    pub fn u32(&mut self) -> Result<u32, LineFault> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn f32(&mut self) -> Result<f64, LineFault> {
        self.array().map(|b| f64::from(f32::from_le_bytes(b)))
    }

    pub fn f64(&mut self) -> Result<f64, LineFault> {
        self.array().map(f64::from_le_bytes)
    }

    fn f64s<const N: usize>(&mut self) -> Result<[f64; N], LineFault> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.f64()?;
        }
        Ok(numbers)
    }

    pub fn text(&mut self) -> Result<String, LineFault> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    /// Seconds since 1970; `None` for what is no time.
    pub fn stamp_s(&mut self) -> Result<Option<f64>, LineFault> {
        let ticks = self.array().map(i64::from_le_bytes)?;
        Ok((ticks > EPOCH_TICKS).then(|| (ticks - EPOCH_TICKS) as f64 * 1e-7))
    }

    /// The head of an object.
    pub fn open(&mut self) -> Result<Object<'a>, LineFault> {
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
    pub fn pose2d(&mut self) -> Result<Pose, LineFault> {
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
    pub fn pose3d(&mut self) -> Result<Transform, LineFault> {
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
    pub fn matrix(&mut self) -> Result<Vec<f64>, LineFault> {
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
