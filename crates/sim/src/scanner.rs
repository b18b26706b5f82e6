//! Scanners: where their beams go and what they make of the true distance.
//!
//! In: the true distance along a beam (exact, from the walls, legs and leaves it meets). Out: the range that the
//! device would log: noise, mixed pixels at edges, dropouts, the no-return code, rounding. The figures of the
//! models follow the data sheets and the recordings that the mapper is made for; every one can be set.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;
use std::str::FromStr;

use polymapper_core::scan::{ScanError, ScanGeometry};

use crate::dice::Dice;
use crate::error::SimError;

/// Sort of device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ScannerKind {
    /// `sick180`: SICK LMS 2xx. 181 beams, 1° apart, from −90° to 90°; 80 m; 1 cm noise; ranges in whole
    /// centimetres; 81.91 m for no return (8.19 m in the mode that reaches 8 m).
    Sick180,
    /// `hokuyo240`: Hokuyo URG-04LX. 682 beams over 240° (360°/1024 apart); 5.6 m; noise of 1 cm near by and
    /// 3 cm at the end of its reach; ranges in millimetres; 0 for no return.
    Hokuyo240,
    /// `lowcost360`: a spinning low-cost scanner (RPLIDAR class). 360 beams, 1° apart, all round; 12 m;
    /// noise of 1 to 2 cm; beams up to a quarter of a degree off; 17 % give no return at random (0).
    LowCost360,
}

impl ScannerKind {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Sick180, Self::Hokuyo240, Self::LowCost360];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sick180 => "sick180",
            Self::Hokuyo240 => "hokuyo240",
            Self::LowCost360 => "lowcost360",
        }
    }
}

impl fmt::Display for ScannerKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for ScannerKind {
    type Err = SimError;

    fn from_str(name: &str) -> Result<Self, SimError> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| SimError::UnknownName {
            what: "scanner",
            name: name.to_owned(),
            known: Self::ALL.map(Self::name).join(", "),
        })
    }
}

/// A scanner with all its faults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scanner {
    /// Decides about bearings, rounding and the form of the log.
    pub kind: ScannerKind,
    /// Shortest range measured, metres; nearer things give no return.
    pub min_range_m: f64,
    /// Reach, metres; further things give no return.
    pub max_range_m: f64,
    /// Standard deviation of the range noise at no distance, metres ...
    pub noise_m: f64,
    /// ... and what it grows by with every metre, metres per metre.
    pub noise_per_m_ratio: f64,
    /// Standard deviation of a beam's bearing about its nominal one, radians.
    pub bearing_noise_rad: f64,
    /// Share of beams that give no return at random, 0..=1.
    pub dropout_ratio: f64,
    /// Share of the beams beside an edge that log a range somewhere between both sides of it, 0..=1.
    pub mixed_pixel_ratio: f64,
    /// Share of the time from scan to scan in which the beam goes round once: 0 measures at once; negative: clockwise,
    /// −1..=1. The scanner moves on meanwhile; its true pose is that at the middle beam.
    pub sweep_ratio: f64,
}

impl Scanner {
    /// A device of this kind as it comes out of its box.
    #[must_use]
    pub fn new(kind: ScannerKind) -> Self {
        let common = Self {
            kind,
            min_range_m: 0.06,
            max_range_m: 80.0,
            noise_m: 0.01,
            noise_per_m_ratio: 0.0,
            bearing_noise_rad: 0.0,
            dropout_ratio: 0.0,
            mixed_pixel_ratio: 0.0,
            sweep_ratio: 0.0,
        };
        match kind {
            ScannerKind::Sick180 => common,
            ScannerKind::Hokuyo240 => Self {
                max_range_m: 5.6,
                noise_m: 0.008,
                noise_per_m_ratio: 0.004,
                ..common
            },
            ScannerKind::LowCost360 => Self {
                min_range_m: 0.15,
                max_range_m: 12.0,
                noise_per_m_ratio: 0.001,
                bearing_noise_rad: 0.1_f64.to_radians(),
                dropout_ratio: 0.17,
                ..common
            },
        }
    }

    /// The bearings of its beams, and its limits.
    ///
    /// # Errors
    /// None for the kinds there are: their bearings are fixed.
    pub fn geometry(&self) -> Result<ScanGeometry, ScanError> {
        let degree_rad = PI / 180.0;
        let urg_step_rad = 2.0 * PI / 1024.0;
        let geometry = match self.kind {
            ScannerKind::Sick180 => ScanGeometry::new(-FRAC_PI_2, degree_rad, 181),
            // Steps 44 to 725 of the device, step 384 straight ahead.
            ScannerKind::Hokuyo240 => ScanGeometry::new(-340.0 * urg_step_rad, urg_step_rad, 682),
            ScannerKind::LowCost360 => ScanGeometry::new(-PI, degree_rad, 360),
        }?;
        Ok(geometry.with_limits(self.min_range_m, self.max_range_m))
    }

    /// What the device logs where nothing returned, metres.
    #[must_use]
    pub fn no_return_m(&self) -> f64 {
        match self.kind {
            ScannerKind::Sick180 if self.max_range_m < 8.19 => 8.19,
            ScannerKind::Sick180 => 81.91,
            ScannerKind::Hokuyo240 | ScannerKind::LowCost360 => 0.0,
        }
    }

    /// Decimals of a metre that the device resolves.
    #[must_use]
    pub fn decimals(&self) -> usize {
        match self.kind {
            ScannerKind::Sick180 => 2,
            ScannerKind::Hokuyo240 | ScannerKind::LowCost360 => 3,
        }
    }

    pub(crate) fn check(&self) -> Result<(), SimError> {
        let in_range = [
            ("min_range_m", self.min_range_m, 0.0, 1.0, "0 to 1"),
            (
                "max_range_m",
                self.max_range_m,
                1.0,
                80.0,
                "1 to 80, and more than min_range_m",
            ),
            ("noise_m", self.noise_m, 0.0, 1.0, "0 to 1"),
            ("noise_per_m_ratio", self.noise_per_m_ratio, 0.0, 1.0, "0 to 1"),
            ("bearing_noise_rad", self.bearing_noise_rad, 0.0, 0.1, "0 to 0.1"),
            ("dropout_ratio", self.dropout_ratio, 0.0, 1.0, "0 to 1"),
            ("mixed_pixel_ratio", self.mixed_pixel_ratio, 0.0, 1.0, "0 to 1"),
            ("sweep_ratio", self.sweep_ratio, -1.0, 1.0, "-1 to 1"),
        ];
        for (name, value, low, high, range) in in_range {
            if !(low..=high).contains(&value) {
                return Err(SimError::Setting { name, value, range });
            }
        }
        if self.min_range_m >= self.max_range_m {
            let value = self.max_range_m;
            return Err(SimError::Setting {
                name: "max_range_m",
                value,
                range: "more than min_range_m",
            });
        }
        Ok(())
    }

    /// The range logged for a true distance, rounded as the device does; `None` for no return. Draws the same
    /// number of random numbers whatever happens.
    pub(crate) fn logged_m(&self, true_m: Option<f64>, dice: &mut Dice) -> Option<f64> {
        let (noise, dropped) = (dice.normal(), dice.chance(self.dropout_ratio));
        let true_m = true_m.filter(|_| !dropped)?;
        let measured_m = true_m + noise * (self.noise_m + self.noise_per_m_ratio * true_m);
        let units = if self.decimals() == 2 { 100.0 } else { 1000.0 };
        let rounded_m = (measured_m * units).round() / units;
        (rounded_m >= self.min_range_m && rounded_m < self.max_range_m).then_some(rounded_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::Purpose;

    fn spread(scanner: &Scanner, true_m: f64) -> (f64, f64, usize) {
        let mut dice = Dice::new(5, Purpose::Scanner);
        let logged: Vec<f64> = (0..20_000)
            .filter_map(|_| scanner.logged_m(Some(true_m), &mut dice))
            .collect();
        let n = logged.len() as f64;
        let mean = logged.iter().sum::<f64>() / n;
        let variance = logged.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / n;
        (mean, variance.sqrt(), logged.len())
    }

    #[test]
    fn the_noise_has_the_deviation_set() {
        for kind in ScannerKind::ALL {
            let scanner = Scanner {
                noise_m: 0.02,
                noise_per_m_ratio: 0.005,
                ..Scanner::new(kind)
            };
            let (mean, deviation, _) = spread(&scanner, 4.0);
            assert!((mean - 4.0).abs() < 0.001, "{kind} {mean}");
            assert!((deviation - 0.04).abs() < 0.001, "{kind} {deviation}");
        }
    }

    #[test]
    fn dropouts_have_their_share() {
        let (_, _, returned) = spread(&Scanner::new(ScannerKind::LowCost360), 4.0);
        assert!((returned as f64 / 20_000.0 - 0.83).abs() < 0.01);
        let (_, _, returned) = spread(&Scanner::new(ScannerKind::Sick180), 4.0);
        assert_eq!(returned, 20_000);
    }

    #[test]
    fn what_is_too_far_or_too_near_does_not_return() {
        let scanner = Scanner {
            noise_m: 0.0,
            ..Scanner::new(ScannerKind::Sick180)
        };
        let mut dice = Dice::new(1, Purpose::Scanner);
        assert_eq!(scanner.logged_m(Some(80.0), &mut dice), None);
        assert_eq!(scanner.logged_m(Some(0.03), &mut dice), None);
        assert_eq!(scanner.logged_m(None, &mut dice), None);
        assert_eq!(scanner.logged_m(Some(3.2449), &mut dice), Some(3.24));
    }

    #[test]
    fn bad_settings_name_the_field() {
        let scanner = Scanner {
            dropout_ratio: f64::NAN,
            ..Scanner::new(ScannerKind::Sick180)
        };
        assert!(scanner.check().unwrap_err().to_string().contains("dropout_ratio"));
        for kind in ScannerKind::ALL {
            assert_eq!(Scanner::new(kind).check(), Ok(()));
            assert_eq!(kind.name().parse(), Ok(kind));
        }
    }
}
