//! Readings at uneven bearings, put onto even ones.
//!
//! In go bearings and ranges in any order, out come an evenly spaced geometry and its ranges. The step is the median
//! distance of neighbouring bearings of the first scan; later scans keep it, and bearings are multiples of it, so that
//! all have beams in common. Between two readings on one surface the range is that of the straight line through both
//! points, so that walls stay where they are; elsewhere it is that of the nearest reading, if that is within half a
//! step.

use std::f64::consts::{PI, TAU};

use polymapper_core::geometry::wrap_rad;
use polymapper_core::scan::ScanGeometry;

use crate::log::{LineFault, MAX_BEAMS};

/// Bearings that differ from even ones by less than this share of a step are even.
const EVEN: f64 = 0.02;
/// Neighbours farther apart than this many steps have a missing reading between them.
const MOST_APART: f64 = 1.75;
/// Readings that would fill this share of a turn, one a step, go all the way round.
const WHOLE_TURN: f64 = 0.85;
/// Ranges of one surface differ by less than this share of them, and [`SAME_SURFACE_M`].
const SAME_SURFACE: f64 = 0.1;
const SAME_SURFACE_M: f64 = 0.05;

/// The even bearings of a log.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::log) struct EvenBearings {
    step_rad: Option<f64>,
}

impl EvenBearings {
    /// The scan of `readings`, pairs of bearing in radians and range in metres; bearings are finite.
    ///
    /// # Errors
    /// Fewer than two readings, bearings that are all the same, or go round more than once.
    pub fn scan(&mut self, mut readings: Vec<(f64, f64)>) -> Result<(ScanGeometry, Vec<f64>), LineFault> {
        readings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [(first_rad, _), .., (last_rad, _)] = readings[..] else {
            return Err(LineFault::Beams {
                header: readings.len() as u64,
                limit: MAX_BEAMS,
            });
        };
        let span_rad = last_rad - first_rad;
        let median_rad = median_step_rad(&readings);
        let is_even = |(k, r): (usize, &(f64, f64))| {
            (r.0 - first_rad - k as f64 * median_rad).abs() < EVEN * median_rad
        };
        if median_rad > 0.0 && readings.iter().enumerate().all(is_even) {
            let step_rad = span_rad / (readings.len() - 1) as f64;
            let geometry = ScanGeometry::new(first_rad, step_rad, readings.len())?;
            return Ok((geometry, readings.into_iter().map(|r| r.1).collect()));
        }
        let step_rad = self.step_rad.unwrap_or(median_rad);
        let most_beams = span_rad / step_rad;
        if !(step_rad > 0.0 && span_rad < TAU * 1.01 && most_beams < MAX_BEAMS as f64) {
            return Err(LineFault::Malformed {
                what: format!(
                    "{} bearings from {:.3}° to {:.3}° with {:.5}° between them make no scan",
                    readings.len(),
                    first_rad.to_degrees(),
                    last_rad.to_degrees(),
                    step_rad.to_degrees()
                ),
            });
        }
        let whole_turn = readings.len() as f64 * step_rad > WHOLE_TURN * TAU;
        let (first_step, beams, step_rad) = if whole_turn {
            let beams = (TAU / step_rad).round();
            readings = all_round(readings);
            (-(beams / 2.0).floor(), beams, TAU / beams)
        } else {
            let first_step = (first_rad / step_rad).round();
            (
                first_step,
                (last_rad / step_rad).round() - first_step + 1.0,
                step_rad,
            )
        };
        self.step_rad = Some(step_rad);
        let geometry = ScanGeometry::new(first_step * step_rad, step_rad, beams as usize)?;
        let ranges_m = (0..geometry.beams())
            .map(|beam| range_at(&readings, geometry.bearing_rad(beam), step_rad))
            .collect();
        Ok((geometry, ranges_m))
    }
}

fn median_step_rad(readings: &[(f64, f64)]) -> f64 {
    let mut steps: Vec<f64> = readings.windows(2).map(|w| w[1].0 - w[0].0).collect();
    steps.sort_by(f64::total_cmp);
    steps[steps.len() / 2]
}

/// The readings by bearing from −π to π, with the outermost repeated a turn on, so that each has two neighbours.
fn all_round(readings: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut readings: Vec<(f64, f64)> = readings.into_iter().map(|(b, r)| (wrap_rad(b), r)).collect();
    readings.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (first, last) = (readings[0], readings[readings.len() - 1]);
    readings.insert(0, (last.0 - TAU, last.1));
    readings.push((first.0 + TAU, first.1));
    debug_assert!(first.0 >= -PI - 1e-9);
    readings
}

fn range_at(readings: &[(f64, f64)], bearing_rad: f64, step_rad: f64) -> f64 {
    let after = readings.partition_point(|r| r.0 < bearing_rad);
    let next = readings.get(after);
    let before = after.checked_sub(1).and_then(|k| readings.get(k));
    if let (Some(&(b0, r0)), Some(&(b1, r1))) = (before, next) {
        let is_return = r0 >= ScanGeometry::SHORTEST_RANGE_M && r1 >= ScanGeometry::SHORTEST_RANGE_M;
        let same = (r0 - r1).abs() < SAME_SURFACE * r0.min(r1) + SAME_SURFACE_M;
        if is_return && same && b1 - b0 < MOST_APART * step_rad && b1 > b0 {
            let (s0, s1) = ((bearing_rad - b0).sin(), (b1 - bearing_rad).sin());
            return r0 * r1 * (b1 - b0).sin() / (r0 * s0 + r1 * s1);
        }
    }
    let nearest = [before, next]
        .into_iter()
        .flatten()
        .min_by(|a, b| (a.0 - bearing_rad).abs().total_cmp(&(b.0 - bearing_rad).abs()));
    match nearest {
        Some(&(b, r)) if (b - bearing_rad).abs() <= 0.5 * step_rad => r,
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_wall_stays_straight() {
        // A wall 2 m ahead, bearings every 1° but shaken by up to 0.3°.
        let readings: Vec<(f64, f64)> = (-40..=40)
            .map(|k| {
                let shake = f64::from((k * 37) % 7) * 0.1 - 0.3;
                let bearing = (f64::from(k) + shake).to_radians();
                (-bearing, 2.0 / bearing.cos())
            })
            .collect();
        let (geometry, ranges_m) = EvenBearings::default().scan(readings).unwrap();
        for (beam, range_m) in ranges_m.iter().enumerate().skip(1).take(geometry.beams() - 2) {
            let ahead_m = range_m * geometry.bearing_rad(beam).cos();
            assert!((ahead_m - 2.0).abs() < 0.013, "beam {beam}: {ahead_m}");
        }
    }

    #[test]
    fn even_bearings_are_left_alone_and_a_gap_stays_one() {
        let even: Vec<(f64, f64)> = (0..10).map(|k| (f64::from(k) * -0.1, f64::from(k))).collect();
        let (geometry, ranges_m) = EvenBearings::default().scan(even.clone()).unwrap();
        assert_eq!(ranges_m, [9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0]);
        assert!((geometry.bearing_rad(0) + 0.9).abs() < 1e-12);
        let shaken: Vec<(f64, f64)> = even.iter().map(|&(b, r)| (b + 0.004 * (r % 2.0), r)).collect();
        let (geometry, _) = EvenBearings::default().scan(shaken).unwrap();
        assert!((geometry.bearing_rad(0) / geometry.step_rad()).fract().abs() < 1e-9);
        let gap: Vec<(f64, f64)> = even.into_iter().filter(|r| r.1 < 3.0 || r.1 > 5.0).collect();
        let (_, ranges_m) = EvenBearings::default().scan(gap).unwrap();
        assert_eq!(ranges_m.len(), 10);
        assert_eq!(ranges_m.iter().filter(|r| r.is_nan()).count(), 3);
    }

    #[test]
    fn bearings_that_go_round_twice_are_refused() {
        let twice: Vec<(f64, f64)> = (0..50).map(|k| (f64::from(k * k) * 0.01, 1.0)).collect();
        assert!(EvenBearings::default().scan(twice).is_err());
        assert!(EvenBearings::default().scan(vec![(1.0, 1.0); 5]).is_err());
        assert!(EvenBearings::default().scan(vec![(1.0, 1.0)]).is_err());
    }
}
