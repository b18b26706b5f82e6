//! Laser lines with their geometry:
//! `ROBOTLASER1 type start_angle field_of_view resolution maximum_range accuracy remission_mode
//! n r1 .. rn m e1 .. em laser_x laser_y laser_theta robot_x robot_y robot_theta
//! tv rv forward_safety side_safety turn_axis ipc_stamp host logger_stamp`,
//! and `RAWLASER1`, the same without the eleven fields of the robot.
//!
//! In goes a line, out come the ranges with the bearings of that line: they may change from line to line
//! (interlaced scanners). A negative resolution is a scanner that turns clockwise; it is turned round.
//! Odometry is the laser's pose, `odometry_from_scan`.

use polymapper_core::scan::ScanGeometry;

use super::fields::Fields;
use crate::log::LineFault;
use crate::log::keeper::Reading;
use crate::log::number::{pose, stamp_s};

/// Fields between the remission values and the stamp of a `ROBOTLASER` line: two poses, five of the robot.
const ROBOT_FIELDS: usize = 11;
/// Stamp, host, logger's stamp.
const STAMP_FIELDS: usize = 3;
/// A resolution below this is a field that was not filled in; the field of view is used instead.
const MIN_STEP_RAD: f64 = 1e-6;

/// Reads one line.
///
/// # Errors
/// A line that is cut, a header that does not fit the ranges, a field that is no number, impossible bearings.
pub(super) fn parse(line: &str, use_odometry: bool) -> Result<Reading, LineFault> {
    let robot_fields = if line.starts_with("ROBOT") {
        ROBOT_FIELDS
    } else {
        0
    };
    let fields_at_end = robot_fields + STAMP_FIELDS;
    let mut fields = Fields::new(line, 1 + fields_at_end);
    let header = Header::read(&mut fields)?;
    let beams = fields.beam_count()?;
    let readings = fields.clone();
    let read = fields.ranges_m(beams).and_then(|ranges_m| {
        let remissions = fields.count("the number of remission values")?;
        for _ in 0..remissions {
            fields.next_field()?;
        }
        Ok((ranges_m, fields.remaining().collect::<Vec<_>>()))
    });
    let (mut ranges_m, end) = match read {
        Ok((ranges_m, end)) if end.len() == fields_at_end => (ranges_m, end),
        Ok(_) => return Err(why_not_whole(&readings, fields_at_end).unwrap_or_else(|| readings.cut())),
        Err(fault) => return Err(why_not_whole(&readings, fields_at_end).unwrap_or(fault)),
    };
    let geometry = header.geometry(&mut ranges_m)?;
    Ok(Reading {
        geometry,
        ranges_m,
        stamp_s: stamp_s(end[robot_fields]),
        odometry: if use_odometry && robot_fields > 0 {
            pose(&end[..3])
        } else {
            None
        },
    })
}

/// The fields before the number of ranges.
struct Header {
    start_rad: f64,
    field_of_view_rad: f64,
    resolution_rad: f64,
    maximum_range_m: f64,
}

impl Header {
    fn read(fields: &mut Fields<'_>) -> Result<Self, LineFault> {
        fields.number("the laser type")?;
        let header = Self {
            start_rad: fields.number("the start angle")?,
            field_of_view_rad: fields.number("the field of view")?,
            resolution_rad: fields.number("the angular resolution")?,
            maximum_range_m: fields.number("the maximum range")?,
        };
        fields.number("the accuracy")?;
        fields.number("the remission mode")?;
        Ok(header)
    }

    /// The bearings; turns the ranges of a clockwise scanner round.
    fn geometry(&self, ranges_m: &mut [f64]) -> Result<ScanGeometry, LineFault> {
        let beams = ranges_m.len();
        let gaps = beams.saturating_sub(1) as f64;
        let mut first_rad = self.start_rad;
        let mut step_rad = self.resolution_rad;
        if step_rad.abs() < MIN_STEP_RAD {
            step_rad = self.field_of_view_rad / gaps.max(1.0);
        }
        if step_rad < 0.0 {
            first_rad += step_rad * gaps;
            step_rad = -step_rad;
            ranges_m.reverse();
        }
        Ok(ScanGeometry::new(first_rad, step_rad, beams)?.with_limits(0.0, self.maximum_range_m))
    }
}

/// Looks for the number of remission values that makes the line whole, to tell how many ranges it really has.
/// `None` where the header is right, or nothing can be told.
fn why_not_whole(readings: &Fields<'_>, fields_at_end: usize) -> Option<LineFault> {
    let header = readings.header();
    let all: Vec<&str> = readings.clone().remaining().collect();
    let fits = |&ranges: &usize| {
        let remissions = all[ranges].parse::<usize>().ok();
        remissions.and_then(|m| (ranges + 1 + fields_at_end).checked_add(m)) == Some(all.len())
    };
    let ranges = (0..all.len()).filter(fits).min_by_key(|n| n.abs_diff(header))?;
    (ranges != header).then_some(LineFault::BeamCount { ranges, header })
}
