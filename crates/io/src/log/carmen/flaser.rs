//! Laser lines without geometry:
//! `FLASER n r1 .. rn x y theta odom_x odom_y odom_theta [ipc_stamp host [logger_stamp]]`.
//!
//! In goes a line, out come the ranges, with bearings that the beam count tells:
//!
//! | beams | step | first bearing |
//! |---|---|---|
//! | 180 | 1° | −90° |
//! | 181 | 1° | −90° |
//! | 360, 361 | 0.5° | −90° |
//! | other n | 180°/(n−1) | −90°, said in a note |
//!
//! The lines do not say what the scanner writes for no return either; [`NoReturnCode`] finds it.
//!
//! The stamp is the first number after the six pose fields. Some tools write lines that end with the poses.
//!
//! The ranges and the poses are all numbers, so a header that is off by a few would go unseen and shift the
//! poses into the ranges. The host name gives it away: in a whole line it is the eighth field after the
//! ranges. Lines without a host name are compared with the line before.

use std::f64::consts::{FRAC_PI_2, PI};

use polymapper_core::scan::{NoReturnCode, ScanGeometry};

use super::fields::Fields;
use crate::log::LineFault;
use crate::log::keeper::{Reading, note_once};
use crate::log::number::{number, pose, stamp_s};

/// Fields that stand after the ranges in every line: two poses.
const POSE_FIELDS: usize = 6;
/// The most fields that stand after the ranges: two poses, stamp, host, logger's stamp.
const MOST_FIELDS: usize = 9;

/// What the lines before looked like.
#[derive(Default)]
pub(super) struct Layout {
    fields_after_ranges: Option<usize>,
    no_return: NoReturnCode,
}

impl Layout {
    /// What was made of the longest ranges, in words for the user.
    pub fn note(&self) -> Option<String> {
        let from_m = self.no_return.from_m()?;
        Some(format!(
            "no range limit in the log: {from_m:.3} m and more taken as no return, since that recurs and nothing is longer"
        ))
    }

    /// Reads one line.
    ///
    /// # Errors
    /// A line that is cut, a header that does not fit the ranges, a field that is no number.
    pub fn parse(
        &mut self,
        line: &str,
        use_odometry: bool,
        notes: &mut Vec<String>,
    ) -> Result<Reading, LineFault> {
        let mut fields = Fields::new(line, POSE_FIELDS);
        let beams = fields.beam_count()?;
        let readings = fields.clone();
        let ranges_m = match fields.ranges_m(beams) {
            Ok(ranges_m) => ranges_m,
            Err(fault) => return Err(wrong_header(&readings).unwrap_or(fault)),
        };
        let tail = Tail::new(fields);
        let before = self.fields_after_ranges.replace(tail.count);
        if !tail.is_whole(before) {
            return Err(wrong_header(&readings).unwrap_or_else(|| misfit(&readings)));
        }
        self.no_return.observe(&ranges_m);
        let mut geometry = geometry(beams, notes)?;
        if let Some(from_m) = self.no_return.from_m() {
            geometry = geometry.with_limits(0.0, from_m);
        }
        Ok(Reading {
            geometry,
            ranges_m,
            stamp_s: tail.fields.get(POSE_FIELDS).and_then(|text| stamp_s(text)),
            odometry: if use_odometry {
                pose(&tail.fields[3..POSE_FIELDS])
            } else {
                None
            },
        })
    }
}

/// The fields after the ranges.
struct Tail<'a> {
    /// The first nine; empty where there are fewer.
    fields: [&'a str; MOST_FIELDS],
    count: usize,
}

impl<'a> Tail<'a> {
    fn new(fields: Fields<'a>) -> Self {
        let mut first = [""; MOST_FIELDS];
        let mut count = 0;
        for field in fields.remaining() {
            if let Some(place) = first.get_mut(count) {
                *place = field;
            }
            count += 1;
        }
        Self { fields: first, count }
    }

    /// Whether poses, stamp and host are where they belong; `before` is the field count of the line before.
    fn is_whole(&self, before: Option<usize>) -> bool {
        let numbers = self.count.min(POSE_FIELDS + 1);
        let shifted = self.fields[..numbers].iter().any(|f| number(f).is_none())
            || self.count > POSE_FIELDS + 1 && number(self.fields[POSE_FIELDS + 1]).is_some();
        let unlike_before = match before {
            Some(POSE_FIELDS) => self.count == POSE_FIELDS + 1,
            Some(MOST_FIELDS) => self.count < MOST_FIELDS,
            _ => false,
        };
        (POSE_FIELDS..=MOST_FIELDS).contains(&self.count) && !shifted && !unlike_before
    }
}

/// Looks for the host name, the one field that is no number, to tell how many ranges the line really has.
/// `None` where the header is right, or nothing can be told.
fn wrong_header(readings: &Fields<'_>) -> Option<LineFault> {
    let header = readings.header();
    let all: Vec<&str> = readings.clone().remaining().collect();
    let host = all.iter().position(|f| number(f).is_none())?;
    let ranges = host.checked_sub(POSE_FIELDS + 1)?;
    let at_end = all.len() - host <= 2;
    (at_end && ranges != header).then_some(LineFault::BeamCount { ranges, header })
}

/// The fault of a line without a host name whose numbers are too few or too many.
fn misfit(readings: &Fields<'_>) -> LineFault {
    match readings.cut() {
        LineFault::Cut { found, header, .. } if found > header + POSE_FIELDS + 1 => LineFault::BeamCount {
            ranges: found - POSE_FIELDS,
            header,
        },
        cut => cut,
    }
}

/// The bearings that a beam count stands for.
fn geometry(beams: usize, notes: &mut Vec<String>) -> Result<ScanGeometry, LineFault> {
    let step_rad = match beams {
        180 | 181 => PI / 180.0,
        360 | 361 => PI / 360.0,
        _ => {
            let step_rad = PI / beams.saturating_sub(1).max(1) as f64;
            let note = format!(
                "{beams} beams a scan and no geometry in the log: taken as 180°, a beam every {:.4}°",
                step_rad.to_degrees()
            );
            note_once(notes, note);
            step_rad
        }
    };
    Ok(ScanGeometry::new(-FRAC_PI_2, step_rad, beams)?)
}
