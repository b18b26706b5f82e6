//! How the scanner has moved, and where that lets it be next.

use crate::align::Guess;
use crate::geometry::{Pose, wrap_rad};

/// The scanner's last pose and how it moved to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub map_from_scan: Pose,
    /// From the last scan but one to the last, in the frame of the former.
    pub step: Pose,
    /// By odometry, from the last placed scan to now, in the frame of the former.
    pub driven: Option<Pose>,
    /// Scans since, that could not be placed.
    pub lost_scans: u32,
    /// How far off predictions usually are.
    pub usual: Surprise,
}

/// How far poses usually lie from the predicted ones: some millimetres in a log of every scan, a metre in one of
/// keyframes. A running mean, so that one set of settings serves both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surprise {
    pub shift_m: f64,
    pub turn_rad: f64,
}

impl Default for Surprise {
    fn default() -> Self {
        Self {
            shift_m: 0.3,
            turn_rad: 0.3,
        }
    }
}

impl Surprise {
    fn after(self, shift_m: f64, turn_rad: f64) -> Self {
        const GAIN: f64 = 0.1;
        Self {
            shift_m: (self.shift_m + GAIN * (shift_m - self.shift_m)).max(0.03),
            turn_rad: (self.turn_rad + GAIN * (turn_rad - self.turn_rad)).max(0.02),
        }
    }
}

impl Motion {
    /// Where the scanner is when it keeps on moving as before, or as odometry says: wheels slip by a tenth of the way.
    pub fn predicted(&self) -> Guess {
        match self.driven {
            Some(driven) => Guess {
                map_from_scan: self.map_from_scan * driven,
                sigma_m: 0.02 + 0.1 * driven.translation().norm(),
                sigma_rad: 0.02 + 0.1 * driven.theta_rad.abs(),
            },
            None => Guess {
                map_from_scan: self.map_from_scan * self.step,
                ..self.standing()
            },
        }
    }

    /// The motion after the next scan was placed. After a gap the speed is not known.
    pub fn advanced(&self, pose: Pose) -> Self {
        let predicted = self.predicted().map_from_scan;
        let is_gap = self.lost_scans > 0;
        let usual = self.usual.after(
            predicted.distance(pose),
            wrap_rad(predicted.theta_rad - pose.theta_rad).abs(),
        );
        Self {
            step: if is_gap {
                Pose::IDENTITY
            } else {
                self.map_from_scan.inverse() * pose
            },
            usual: if is_gap { self.usual } else { usual },
            ..Self::starting_at(pose)
        }
    }

    /// No motion yet.
    pub fn starting_at(map_from_scan: Pose) -> Self {
        Self {
            map_from_scan,
            step: Pose::IDENTITY,
            driven: None,
            lost_scans: 0,
            usual: Surprise::default(),
        }
    }

    /// Where it is when it has stopped. Speeds change by some centimetres a scan, the more the faster it is.
    pub fn standing(&self) -> Guess {
        Guess {
            map_from_scan: self.map_from_scan,
            sigma_m: 0.02 + 0.3 * self.step.translation().norm(),
            sigma_rad: 0.02 + 0.3 * self.step.theta_rad.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_drive_is_expected_to_go_on_and_surprises_less_and_less() {
        let step = Pose::new(0.1, 0.0, 0.01);
        let mut motion = Motion::starting_at(Pose::IDENTITY);
        for _ in 0..60 {
            motion = motion.advanced(motion.map_from_scan * step);
        }
        let next = motion.map_from_scan * step;
        assert!(motion.predicted().map_from_scan.distance(next) < 1e-9);
        assert!(motion.usual.shift_m < 0.04, "{:?}", motion.usual);
    }

    #[test]
    fn odometry_outranks_the_speed_so_far() {
        let driven = Pose::new(0.5, 0.0, 1.0);
        let motion = Motion {
            driven: Some(driven),
            ..Motion::starting_at(Pose::new(2.0, 0.0, 0.0))
        };
        assert!(
            motion
                .predicted()
                .map_from_scan
                .distance(Pose::new(2.5, 0.0, 1.0))
                < 1e-12
        );
    }

    #[test]
    fn after_a_gap_the_speed_is_not_known() {
        let lost = Motion {
            lost_scans: 3,
            ..Motion::starting_at(Pose::IDENTITY)
        };
        let found = lost.advanced(Pose::new(4.0, 0.0, 0.0));
        assert!(
            found.step.translation().norm() < 1e-12,
            "four metres in four scans is no speed"
        );
    }
}
