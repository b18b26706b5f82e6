//! The speed, as far as the walls have told it: a Kalman filter over the last pose and the step from scan to scan.
//!
//! In: each step that was seen, and what the walls say of the pose it leads to. Out: the step that is expected next. The pose is
//! part of the state: along a corridor it is known less well from scan to scan, and when something tells it again, the
//! scanner is moved by what has gathered over all of them. Taken for the last step alone, such a correction of 5 cm made a
//! scanner that moved on by 5 cm a scan stand still in its own eyes (a simulated corridor, for 150 scans).

use crate::align::{Covariance, Information};
use crate::geometry::matrix::{
    Matrix, ZERO, add_to, make_symmetric, product, subtract_from, times, transposed,
};
use crate::geometry::{Pose, wrap_rad};

/// What an alignment says in two scans in a row errs alike (the same walls, the same map): so much of its information
/// counts for the speed.
const WALLS_INDEPENDENCE: f64 = 0.25;
/// Standard deviations of a pose whatever the walls say, metres and radians.
const POSE_SIGMA_M: f64 = 0.005;
const POSE_SIGMA_RAD: f64 = 0.002;
/// Standard deviations of a speed that is not known, metres and radians a scan.
const UNKNOWN_M: f64 = 10.0;
const UNKNOWN_RAD: f64 = 3.0;

/// A step from one scan to the next, in the frame of the former.
pub(super) struct Seen {
    pub step: Pose,
    /// What the walls say of where it leads, axes of the former; `None`: it is certain.
    pub walls: Option<Information>,
}

/// See the module. Errors by the axes of the last scan.
#[derive(Clone, Debug)]
pub(super) struct Speed {
    /// The step from one scan to the next that is expected, in the frame of the former.
    pub step: Pose,
    /// Covariance of the last pose, ...
    of_pose: Matrix,
    /// ... of the pose (rows) with the step, ...
    of_both: Matrix,
    /// ... and of the step.
    of_step: Matrix,
}

impl Default for Speed {
    fn default() -> Self {
        Self {
            step: Pose::IDENTITY,
            of_pose: ZERO,
            of_both: ZERO,
            of_step: diagonal(UNKNOWN_M, UNKNOWN_RAD),
        }
    }
}

impl Speed {
    /// Takes in a step. `change` is the covariance of how much the speed may have changed in it.
    pub fn see(&mut self, seen: &Seen, change: &Matrix) {
        self.predict(change);
        let off = [
            seen.step.x - self.step.x,
            seen.step.y - self.step.y,
            wrap_rad(seen.step.theta_rad - self.step.theta_rad),
        ];
        self.correct(off, seen.walls.as_ref());
        let (sin, cos) = seen.step.theta_rad.sin_cos();
        let turn = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
        self.of_pose = moved(&turn, &self.of_pose);
        self.of_both = product(&turn, &self.of_both);
    }

    /// Standard deviations of the last pose, metres and radians.
    pub fn pose_sigmas(&self) -> (f64, f64) {
        let [[xx, ..], [_, yy, _], [.., turn]] = self.of_pose;
        ((0.5 * (xx + yy)).sqrt(), turn.sqrt())
    }

    /// Covariance of the last pose, by its own axes: of walls and motion together.
    pub fn covariance(&self) -> Covariance {
        Covariance { rows: self.of_pose }
    }

    /// The information that the next step is the expected one, after a `change` of the speed of this covariance.
    pub fn step_information(&self, change: &Matrix) -> Option<Information> {
        let mut rows = self.of_step;
        add_to(&mut rows, change);
        add_to(&mut rows, &diagonal(POSE_SIGMA_M, POSE_SIGMA_RAD));
        let rows = Information { rows }.covariance()?;
        Some(Information { rows })
    }

    /// The pose was found anew: how it was missed says nothing of the speed.
    pub fn found_anew(&mut self, change: &Matrix) {
        add_to(&mut self.of_step, change);
        self.of_pose = ZERO;
        self.of_both = ZERO;
    }

    /// The covariances of the next pose, by the axes of the last.
    fn predict(&mut self, change: &Matrix) {
        add_to(&mut self.of_step, change);
        // An error of the heading moves the end of the step aside.
        let swing = [[1.0, 0.0, -self.step.y], [0.0, 1.0, self.step.x], [0.0, 0.0, 1.0]];
        let both = product(&swing, &self.of_both);
        self.of_pose = moved(&swing, &self.of_pose);
        let mut crossed = both;
        add_to(&mut crossed, &transposed(&both));
        add_to(&mut self.of_pose, &self.of_step);
        add_to(&mut self.of_pose, &crossed);
        self.of_both = both;
        add_to(&mut self.of_both, &self.of_step);
    }

    /// The pose was seen to be off the expected one by `off`.
    fn correct(&mut self, off: [f64; 3], walls: Option<&Information>) {
        let mut spread = Information { rows: self.of_pose };
        add_to(&mut spread.rows, &diagonal(POSE_SIGMA_M, POSE_SIGMA_RAD));
        let Some(rows) = spread.covariance() else {
            return;
        };
        let expected = Information { rows };
        let told = match walls {
            Some(walls) => walls.scaled(WALLS_INDEPENDENCE).doubted(&expected),
            None => expected,
        };
        let gain = product(&transposed(&self.of_both), &told.rows);
        let by = times(&gain, off);
        self.step = Pose::new(
            self.step.x + by[0],
            self.step.y + by[1],
            wrap_rad(self.step.theta_rad + by[2]),
        );
        let of_pose = product(&self.of_pose, &told.rows);
        subtract_from(&mut self.of_step, &product(&gain, &self.of_both));
        let (from_both, from_pose) = (product(&of_pose, &self.of_both), product(&of_pose, &self.of_pose));
        subtract_from(&mut self.of_both, &from_both);
        subtract_from(&mut self.of_pose, &from_pose);
        for covariance in [&mut self.of_pose, &mut self.of_step] {
            make_symmetric(covariance);
        }
    }
}

/// Covariance of a pose that only the walls tell, by the axes of what they say; as wide as an unknown speed where they say nothing.
pub(super) fn by_walls(walls: &Information) -> Covariance {
    let told =
        walls
            .scaled(WALLS_INDEPENDENCE)
            .plus(&Information::from_sigmas(UNKNOWN_M, UNKNOWN_M, UNKNOWN_RAD));
    let mut rows = told
        .covariance()
        .unwrap_or_else(|| diagonal(UNKNOWN_M, UNKNOWN_RAD));
    add_to(&mut rows, &diagonal(POSE_SIGMA_M, POSE_SIGMA_RAD));
    Covariance { rows }
}

/// The covariance a · c · aᵀ of what a makes of something of covariance c.
fn moved(a: &Matrix, c: &Matrix) -> Matrix {
    product(&product(a, c), &transposed(a))
}

/// The covariance of x, y and heading with these standard deviations.
pub(super) fn diagonal(sigma_m: f64, sigma_rad: f64) -> Matrix {
    let (m2, rad2) = (sigma_m * sigma_m, sigma_rad * sigma_rad);
    [[m2, 0.0, 0.0], [0.0, m2, 0.0], [0.0, 0.0, rad2]]
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP: Pose = Pose {
        x: 0.05,
        y: 0.0,
        theta_rad: 0.0,
    };

    fn change() -> Matrix {
        diagonal(0.005, 0.02)
    }

    fn see(speed: &mut Speed, x_m: f64, sigma_along_m: f64) {
        let walls = Information::from_sigmas(sigma_along_m, 0.005, 0.002);
        let step = Pose { x: x_m, ..STEP };
        speed.see(
            &Seen {
                step,
                walls: Some(walls),
            },
            &change(),
        );
    }

    #[test]
    fn a_fix_after_an_open_stretch_is_no_change_of_speed() {
        let after_fix = |open_scans: u32| {
            let mut speed = Speed::default();
            (0..40).for_each(|_| see(&mut speed, 0.05, 0.005));
            (0..open_scans).for_each(|_| {
                let going_on_m = speed.step.x;
                see(&mut speed, going_on_m, 10.0);
            });
            // Something tells the place again: the scanner is 5 cm behind.
            see(&mut speed, 0.0, 0.005);
            speed.step.x
        };
        let (long, none) = (after_fix(30), after_fix(0));
        assert!(long > 0.045, "{long} m a scan");
        assert!(
            none < 0.04,
            "{none} m a scan: what is told all along is a change of speed"
        );
    }

    #[test]
    fn a_speed_that_never_changes_does_not_die_away_where_the_walls_tell_little() {
        let mut speed = Speed::default();
        (0..40).for_each(|_| see(&mut speed, 0.05, 0.005));
        // Walls slightly out of line hold the scanner back a little.
        (0..20).for_each(|_| {
            let held_back_m = 0.9 * speed.step.x;
            see(&mut speed, held_back_m, 0.1);
        });
        assert!(speed.step.x > 0.04, "{} m a scan", speed.step.x);
    }

    #[test]
    fn what_is_not_told_along_a_corridor_stays_along_it_in_a_turn() {
        let mut speed = Speed::default();
        let turning = Pose {
            theta_rad: 0.1,
            ..STEP
        };
        for k in 0..20 {
            // By the axes of the scanner, which has turned.
            let walls = Information::from_sigmas(1.0, 0.005, 0.002).turned(-0.1 * f64::from(k));
            let walls = Some(walls);
            speed.see(&Seen { step: turning, walls }, &change());
        }
        // 20 turns of 0.1 since the corridor lay ahead.
        let along = [2.0_f64.cos(), -2.0_f64.sin()];
        let across = [2.0_f64.sin(), 2.0_f64.cos()];
        let variance = |d: [f64; 2]| {
            (0..2)
                .map(|r| (0..2).map(|c| d[r] * speed.of_pose[r][c] * d[c]).sum::<f64>())
                .sum::<f64>()
        };
        assert!(variance(along) > 20.0 * variance(across), "{:?}", speed.of_pose);
    }
}
