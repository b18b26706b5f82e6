//! Fields of a serialised ROS message, one after another.
//!
//! In go the bytes of a message, out come its numbers and texts; a message that ends too early is a fault that
//! says where. Two encodings: that of ROS 1 (little endian, packed, lengths before arrays and texts) and CDR of
//! ROS 2 (OMG DDS-XTypes 1.3, 7.4: a head of four bytes tells the byte order, numbers stand at multiples of
//! their size, texts end with a zero byte).

use super::super::{LineFault, MAX_BEAMS};

/// How messages are serialised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::log) enum Encoding {
    /// `ros1`
    Ros1,
    /// `cdr`
    Cdr,
}

/// Bytes of the head of CDR.
const CDR_HEAD: usize = 4;

/// Reads field after field.
pub(super) struct Fields<'a> {
    data: &'a [u8],
    at: usize,
    encoding: Encoding,
    big_endian: bool,
    /// The most that a number is aligned to.
    most_aligned: usize,
}

impl<'a> Fields<'a> {
    /// The fields of the message in `data`.
    pub fn new(data: &'a [u8], encoding: Encoding) -> Result<Self, LineFault> {
        let mut fields = Self {
            data,
            at: 0,
            encoding,
            big_endian: false,
            most_aligned: 1,
        };
        if encoding == Encoding::Cdr {
            let head = fields.take(CDR_HEAD, "the CDR head")?;
            // Representation identifiers of plain CDR, version 1 and 2, big and little endian.
            (fields.big_endian, fields.most_aligned) = match head[1] {
                0x00 => (true, 8),
                0x01 => (false, 8),
                0x06 => (true, 4),
                0x07 => (false, 4),
                other => {
                    return Err(malformed(format!(
                        "CDR representation {other:#04x}; plain CDR (0x00, 0x01, 0x06, 0x07) is expected"
                    )));
                }
            };
            fields.data = &data[CDR_HEAD..];
            fields.at = 0;
        }
        Ok(fields)
    }

    fn take(&mut self, bytes: usize, what: &str) -> Result<&'a [u8], LineFault> {
        let left = self.data.len() - self.at;
        if bytes > left {
            return Err(malformed(format!(
                "the message is cut: {what} needs {bytes} bytes, {left} are left"
            )));
        }
        let taken = &self.data[self.at..self.at + bytes];
        self.at += bytes;
        Ok(taken)
    }

    fn aligned(&mut self, size: usize, what: &str) -> Result<(), LineFault> {
        let to = size.min(self.most_aligned);
        let padding = (to - self.at % to) % to;
        self.take(padding, what).map(|_| ())
    }

    fn number<const N: usize>(&mut self, what: &str) -> Result<[u8; N], LineFault> {
        self.aligned(N, what)?;
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N, what)?);
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub fn u32(&mut self, what: &str) -> Result<u32, LineFault> {
        self.number(what).map(u32::from_le_bytes)
    }

    pub fn f32(&mut self, what: &str) -> Result<f64, LineFault> {
        self.number(what).map(|b| f64::from(f32::from_le_bytes(b)))
    }

    pub fn f64(&mut self, what: &str) -> Result<f64, LineFault> {
        self.number(what).map(f64::from_le_bytes)
    }

    /// A text; bytes that are none are replaced.
    pub fn text(&mut self, what: &str) -> Result<String, LineFault> {
        const LONGEST: usize = 4096;
        let length = self.u32(what)? as usize;
        if length > LONGEST {
            return Err(malformed(format!(
                "{what} has {length} bytes, at most {LONGEST} are expected"
            )));
        }
        let bytes = self.take(length, what)?;
        let bytes = match self.encoding {
            Encoding::Ros1 => bytes,
            Encoding::Cdr => bytes.strip_suffix(&[0]).unwrap_or(bytes),
        };
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    /// How many elements of at least `bytes` bytes follow.
    pub fn count(&mut self, bytes: usize, what: &str) -> Result<usize, LineFault> {
        let count = self.u32(what)? as usize;
        let left = self.data.len() - self.at;
        match count.checked_mul(bytes) {
            Some(needed) if needed <= left => Ok(count),
            _ => Err(malformed(format!(
                "the message says {count} {what} of {bytes} bytes, {left} bytes are left"
            ))),
        }
    }

    /// The `f32` numbers of an array of beams.
    pub fn ranges(&mut self) -> Result<Vec<f64>, LineFault> {
        let count = self.count(4, "ranges")?;
        check_beams(count)?;
        let bytes = self.take(4 * count, "ranges")?;
        let big_endian = self.big_endian;
        let number = |b: &[u8; 4]| {
            f64::from(if big_endian {
                f32::from_be_bytes(*b)
            } else {
                f32::from_le_bytes(*b)
            })
        };
        Ok(bytes.as_chunks().0.iter().map(number).collect())
    }

    /// Time: seconds and nanoseconds.
    pub fn stamp_s(&mut self) -> Result<f64, LineFault> {
        let seconds = self.u32("the stamp")?;
        let nanoseconds = self.u32("the stamp")?;
        // ROS 2 has signed seconds; times before 1970 are no times of a recording.
        Ok(f64::from(seconds) + f64::from(nanoseconds) * 1e-9)
    }
}

/// Refuses a number of beams that no scanner has.
pub(super) fn check_beams(count: usize) -> Result<(), LineFault> {
    if count == 0 || count > MAX_BEAMS {
        return Err(LineFault::Beams {
            header: count as u64,
            limit: MAX_BEAMS,
        });
    }
    Ok(())
}

pub(super) fn malformed(what: String) -> LineFault {
    LineFault::Malformed { what }
}
