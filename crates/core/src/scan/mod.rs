//! One revolution of a laser scanner: bearings given by a geometry, one range a beam.
//!
//! Beams run counter-clockwise (a reader turns clockwise scanners round). A range
//! that is no return (beyond reach, too near, error code, NaN, infinite) is held
//! as NaN, so that the stages have a single test to make. No return says nothing
//! about free space: glass and black walls give none either. [`NoReturnCode`] finds the range that
//! a log writes for "no return" where it does not say.

mod no_return;
mod straight;

pub use no_return::NoReturnCode;

use crate::geometry::{Point, Pose};
use straight::Straight;

/// Why a scan cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScanError {
    /// Ranges and geometry do not belong together.
    #[error("{ranges} ranges, but the geometry has {beams} beams")]
    BeamCount {
        /// Ranges given.
        ranges: usize,
        /// Beams of the geometry.
        beams: usize,
    },
    /// The bearings are unusable.
    #[error(
        "first bearing {first_bearing_rad} rad with a step of {step_rad} rad: the step must be a positive number, and {beams} beams must not turn round more than once"
    )]
    Bearings {
        /// First bearing given.
        first_bearing_rad: f64,
        /// Step given.
        step_rad: f64,
        /// Beams given.
        beams: usize,
    },
}

/// Evenly spaced bearings of a scanner, and the ranges it can measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanGeometry {
    first_bearing_rad: f64,
    step_rad: f64,
    beams: usize,
    min_range_m: f64,
    max_range_m: f64,
}

impl ScanGeometry {
    /// Ranges at or above this are no returns whatever the device says: no 2D
    /// indoor scanner reaches it, and several logs code "no return" as 81.83..81.91 m.
    pub const LONGEST_RANGE_M: f64 = 80.0;
    /// Ranges below this are error codes (SICK and URG codes are < 20 mm).
    pub const SHORTEST_RANGE_M: f64 = 0.02;

    /// `beams` bearings from `first_bearing_rad`, counter-clockwise, `step_rad` > 0 apart, within one turn.
    ///
    /// # Errors
    /// A step that is not positive, bearings that are not finite or span more than a turn.
    pub fn new(first_bearing_rad: f64, step_rad: f64, beams: usize) -> Result<Self, ScanError> {
        let span_rad = step_rad * beams.saturating_sub(1) as f64;
        let ok = first_bearing_rad.is_finite()
            && first_bearing_rad.abs() < 100.0
            && step_rad > 0.0
            && span_rad < std::f64::consts::TAU * 1.01;
        if !ok {
            return Err(ScanError::Bearings {
                first_bearing_rad,
                step_rad,
                beams,
            });
        }
        Ok(Self {
            first_bearing_rad,
            step_rad,
            beams,
            min_range_m: Self::SHORTEST_RANGE_M,
            max_range_m: Self::LONGEST_RANGE_M,
        })
    }

    /// The same bearings with the device's own limits; ranges at or beyond them are no returns.
    #[must_use]
    pub fn with_limits(mut self, min_range_m: f64, max_range_m: f64) -> Self {
        if min_range_m.is_finite() {
            self.min_range_m = min_range_m.max(Self::SHORTEST_RANGE_M);
        }
        if max_range_m > self.min_range_m {
            self.max_range_m = max_range_m.min(Self::LONGEST_RANGE_M);
        }
        self
    }

    /// Number of beams.
    #[must_use]
    pub fn beams(&self) -> usize {
        self.beams
    }

    /// Angle between neighbouring beams, radians, positive.
    #[must_use]
    pub fn step_rad(&self) -> f64 {
        self.step_rad
    }

    /// The shortest range that is a return, metres.
    #[must_use]
    pub fn min_range_m(&self) -> f64 {
        self.min_range_m
    }

    /// Ranges from here on are no returns, metres.
    #[must_use]
    pub fn max_range_m(&self) -> f64 {
        self.max_range_m
    }

    /// Bearing of beam `beam`, radians, not wrapped.
    #[must_use]
    pub fn bearing_rad(&self, beam: usize) -> f64 {
        self.first_bearing_rad + self.step_rad * beam as f64
    }

    /// Beam number, with fraction, of the bearing that is nearest to `bearing_rad` a turn more or less;
    /// outside 0..beams−1 when the scanner does not look there.
    #[must_use]
    pub fn beam_of_bearing(&self, bearing_rad: f64) -> f64 {
        let middle_rad = self.middle_rad();
        let from_middle_rad = crate::geometry::wrap_rad(bearing_rad - middle_rad);
        (middle_rad + from_middle_rad - self.first_bearing_rad) / self.step_rad
    }

    /// How far round from the middle beam a bearing is, turns, −½..½.
    #[must_use]
    pub fn turns_from_middle(&self, bearing_rad: f64) -> f64 {
        crate::geometry::wrap_rad(bearing_rad - self.middle_rad()) / std::f64::consts::TAU
    }

    fn middle_rad(&self) -> f64 {
        self.first_bearing_rad + 0.5 * self.step_rad * self.beams.saturating_sub(1) as f64
    }

    /// Whether the beams go all the way round, so that the last is a neighbour of the first.
    #[must_use]
    pub fn is_full_circle(&self) -> bool {
        self.beams > 2 && self.step_rad * self.beams as f64 > std::f64::consts::TAU - 1.5 * self.step_rad
    }

    fn is_return(&self, range_m: f64) -> bool {
        range_m >= self.min_range_m && range_m < self.max_range_m && !is_no_return_code(range_m)
    }
}

/// Values that scanners write for "no return" where the log does not give the limits (SICK LMS in its
/// 8 m, 32 m, 50 m and 80 m modes). A true return at one of these to the centimetre is lost with them, which
/// costs a beam now and then and never a wall.
fn is_no_return_code(range_m: f64) -> bool {
    const CODES_M: [(f64, f64); 4] = [
        (8.175, 8.195),
        (32.755, 32.775),
        (49.995, 50.005),
        (51.145, 51.225),
    ];
    CODES_M
        .iter()
        .any(|&(low, high)| range_m >= low && range_m <= high)
}

/// A scan: one range a beam, NaN where nothing returned.
#[derive(Clone, Debug)]
pub struct Scan {
    geometry: ScanGeometry,
    measured_m: Vec<f64>,
    /// Where the scanner moved while it measured, and that is known.
    straight: Option<Box<Straight>>,
}

impl Scan {
    /// Takes raw ranges and marks as NaN all that are no returns.
    ///
    /// # Errors
    /// As many ranges as beams are expected.
    pub fn new(geometry: ScanGeometry, mut ranges_m: Vec<f64>) -> Result<Self, ScanError> {
        if ranges_m.len() != geometry.beams {
            return Err(ScanError::BeamCount {
                ranges: ranges_m.len(),
                beams: geometry.beams,
            });
        }
        for r in &mut ranges_m {
            if !geometry.is_return(*r) {
                *r = f64::NAN;
            }
        }
        Ok(Self {
            geometry,
            measured_m: ranges_m,
            straight: None,
        })
    }

    /// The scan as it would have been taken at once, from where the scanner was when it looked along the middle beam.
    /// `turn_motion` is the motion of the scanner while its beam goes round once counter-clockwise, in its own frame (of one
    /// that goes round clockwise: backwards). Begins with what was measured, however the scan has been straightened before.
    #[must_use]
    pub fn straightened(&self, turn_motion: Pose) -> Self {
        let is_moving = turn_motion != Pose::IDENTITY;
        Self {
            geometry: self.geometry,
            measured_m: self.measured_m.clone(),
            straight: is_moving
                .then(|| Box::new(Straight::new(&self.geometry, &self.measured_m, turn_motion))),
        }
    }

    /// The motion that the scan was straightened by.
    #[must_use]
    pub fn turn_motion(&self) -> Pose {
        self.straight.as_ref().map_or(Pose::IDENTITY, |s| s.turn_motion)
    }

    /// The ranges as they were measured, metres, one a beam; NaN where nothing returned.
    #[must_use]
    pub fn measured_ranges_m(&self) -> &[f64] {
        &self.measured_m
    }

    /// The scanner's geometry.
    #[must_use]
    pub fn geometry(&self) -> &ScanGeometry {
        &self.geometry
    }

    /// Ranges in metres, one a beam; NaN where nothing returned.
    #[must_use]
    pub fn ranges_m(&self) -> &[f64] {
        self.straight.as_ref().map_or(&self.measured_m, |s| &s.ranges_m)
    }

    /// Bearing of beam `beam`, radians, not wrapped.
    #[must_use]
    pub fn bearing_rad(&self, beam: usize) -> f64 {
        self.geometry.bearing_rad(beam) + self.turned_rad(beam)
    }

    /// The beam that looks at `bearing_rad`; `None` where the scanner does not look.
    #[must_use]
    pub fn beam_at(&self, bearing_rad: f64) -> Option<usize> {
        let near = self.geometry.beam_of_bearing(bearing_rad).round();
        let turned_rad = if near >= 0.0 {
            self.turned_rad(near as usize)
        } else {
            0.0
        };
        let beam = self.geometry.beam_of_bearing(bearing_rad - turned_rad).round();
        (beam >= 0.0 && beam < self.geometry.beams as f64).then_some(beam as usize)
    }

    fn turned_rad(&self, beam: usize) -> f64 {
        let turned = self.straight.as_ref().and_then(|s| s.turned_rad.get(beam));
        turned.copied().unwrap_or(0.0)
    }

    /// Number of beams that returned.
    #[must_use]
    pub fn returns(&self) -> usize {
        self.measured_m.iter().filter(|r| r.is_finite()).count()
    }

    /// The point that beam `beam` hit, laser frame; `None` without a return.
    #[must_use]
    pub fn point(&self, beam: usize) -> Option<Point> {
        let range_m = *self.ranges_m().get(beam)?;
        range_m
            .is_finite()
            .then(|| Point::from_polar(range_m, self.bearing_rad(beam)))
    }

    /// Every return with its beam number, counter-clockwise.
    pub fn points(&self) -> impl Iterator<Item = (usize, Point)> + '_ {
        (0..self.measured_m.len()).filter_map(|beam| Some((beam, self.point(beam)?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_and_non_numbers_are_no_returns() {
        let geometry = ScanGeometry::new(0.0, 0.01, 12).unwrap();
        let raw = vec![
            1.0,
            81.91,
            81.83,
            51.2,
            50.0,
            32.76,
            8.19,
            0.0,
            0.019,
            f64::NAN,
            f64::INFINITY,
            250_000.0,
        ];
        let scan = Scan::new(geometry, raw).unwrap();
        assert_eq!(scan.returns(), 1);
        assert_eq!(scan.points().map(|(beam, _)| beam).collect::<Vec<_>>(), [0]);
    }

    #[test]
    fn the_device_limits_of_the_line_count() {
        let geometry = ScanGeometry::new(0.0, 0.01, 3).unwrap().with_limits(0.1, 4.0);
        let scan = Scan::new(geometry, vec![0.05, 3.9, 4.0]).unwrap();
        assert_eq!(scan.returns(), 1);
    }

    #[test]
    fn a_wrong_beam_count_names_both_numbers() {
        let geometry = ScanGeometry::new(0.0, 0.01, 181).unwrap();
        let error = Scan::new(geometry, vec![1.0; 180]).unwrap_err();
        assert_eq!(error.to_string(), "180 ranges, but the geometry has 181 beams");
    }

    #[test]
    fn a_bearing_finds_its_beam_across_the_turn() {
        let geometry = ScanGeometry::new(-3.0, 0.1, 61).unwrap();
        let beam = geometry.beam_of_bearing(-3.0 + 0.1 * 7.0 + std::f64::consts::TAU);
        assert!((beam - 7.0).abs() < 1e-9);
    }
}
