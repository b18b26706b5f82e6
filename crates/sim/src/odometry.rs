//! Wheel odometry that drifts.
//!
//! In: the true poses. Out: what the wheels would say: every step is measured with noise and with errors that stay
//! the same for the whole run (wrong wheel diameters), and the steps are added up. Starts at the origin.

use polymapper_core::geometry::{Pose, wrap_rad};

use crate::dice::{Dice, Purpose};
use crate::error::SimError;

/// How badly the wheels measure. The defaults let a run of 100 m end some metres and some ten degrees off, as the
/// odometry of the Intel and Aces logs does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OdometryNoise {
    /// Standard deviation of the distance measured over 1 m, metres; grows with the root of the distance.
    pub distance_noise_m: f64,
    /// Standard deviation of the heading after 1 m, radians; grows with the root of the distance.
    pub heading_noise_rad: f64,
    /// Standard deviation, from run to run, of the share by which all turns are wrong.
    pub turn_bias_ratio: f64,
    /// Standard deviation, from run to run, of the turn that is measured on a straight way, radians per metre.
    pub heading_bias_rad_per_m: f64,
}

impl Default for OdometryNoise {
    fn default() -> Self {
        Self {
            distance_noise_m: 0.01,
            heading_noise_rad: 0.01,
            turn_bias_ratio: 0.01,
            heading_bias_rad_per_m: 0.002,
        }
    }
}

impl OdometryNoise {
    pub(crate) fn check(&self) -> Result<(), SimError> {
        let all = [
            ("distance_noise_m", self.distance_noise_m),
            ("heading_noise_rad", self.heading_noise_rad),
            ("turn_bias_ratio", self.turn_bias_ratio),
            ("heading_bias_rad_per_m", self.heading_bias_rad_per_m),
        ];
        match all.into_iter().find(|(_, value)| !(0.0..=1.0).contains(value)) {
            Some((name, value)) => Err(SimError::Setting {
                name,
                value,
                range: "0 to 1",
            }),
            None => Ok(()),
        }
    }

    /// The poses that the wheels report, one for every true pose.
    pub(crate) fn measured(&self, truth: &[Pose], seed: u64) -> Vec<Pose> {
        let mut dice = Dice::new(seed, Purpose::Odometry);
        let turn_bias_ratio = dice.normal() * self.turn_bias_ratio;
        let heading_bias = dice.normal() * self.heading_bias_rad_per_m;
        let mut odom_from_laser = Pose::IDENTITY;
        let mut out: Vec<Pose> = truth.first().map(|_| odom_from_laser).into_iter().collect();
        for pair in truth.windows(2) {
            let step = relative(pair[0], pair[1]);
            let moved_m = step.translation().norm();
            let spread = moved_m.sqrt();
            let longer = 1.0
                + if moved_m > 0.0 {
                    dice.normal() * self.distance_noise_m * spread / moved_m
                } else {
                    0.0
                };
            let turn_rad = step.theta_rad * (1.0 + turn_bias_ratio)
                + heading_bias * moved_m
                + dice.normal() * self.heading_noise_rad * spread;
            odom_from_laser = compose(
                odom_from_laser,
                Pose::new(step.x * longer, step.y * longer, turn_rad),
            );
            out.push(odom_from_laser);
        }
        out
    }
}

/// Pose b seen from pose a, to the same bits on every platform.
fn relative(a: Pose, b: Pose) -> Pose {
    let shift = b.translation() - a.translation();
    let ahead = crate::dice::direction(a.theta_rad);
    Pose::new(
        shift.dot(ahead),
        shift.dot(ahead.left()),
        wrap_rad(b.theta_rad - a.theta_rad),
    )
}

/// The step made from pose a, to the same bits on every platform.
fn compose(a: Pose, step: Pose) -> Pose {
    let ahead = crate::dice::direction(a.theta_rad);
    let place = a.translation() + ahead * step.x + ahead.left() * step.y;
    Pose::new(place.x, place.y, a.theta_rad + step.theta_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight() -> Vec<Pose> {
        (0..=1000)
            .map(|k| Pose::new(2.0, 3.0 + 0.1 * f64::from(k), std::f64::consts::FRAC_PI_2))
            .collect()
    }

    #[test]
    fn odometry_drifts_but_is_good_over_a_metre() {
        let measured = OdometryNoise::default().measured(&straight(), 9);
        assert_eq!(measured.len(), 1001);
        assert!(measured[10].distance(Pose::new(1.0, 0.0, 0.0)) < 0.1);
        let off_m = measured[1000].distance(Pose::new(100.0, 0.0, 0.0));
        assert!((0.2..40.0).contains(&off_m), "{off_m} m off after 100 m");
    }

    #[test]
    fn without_noise_it_is_the_path_seen_from_its_start() {
        let none = OdometryNoise {
            distance_noise_m: 0.0,
            heading_noise_rad: 0.0,
            turn_bias_ratio: 0.0,
            heading_bias_rad_per_m: 0.0,
        };
        let truth = straight();
        for (k, pose) in none.measured(&truth, 9).into_iter().enumerate() {
            assert!(pose.distance(truth[0].inverse() * truth[k]) < 1e-9);
        }
    }
}
