//! How the scanner has moved, and where that lets it be next.
//!
//! In: the poses so far. Out: guesses for the next pose, and how likely any next pose is. A scanner moves as it has
//! moved before: logs of every scan go on by the last step, logs thinned to keyframes by some metre at a time, a
//! trolley never sideways. So the steps of the log itself are the motion model, a density estimated from them
//! (Parzen windows), and nothing has to be set for a robot or a hand.

mod speed;
mod usual;

use std::collections::VecDeque;

use crate::align::{Covariance, Guess, Information, Prior};
use crate::geometry::{Pose, wrap_rad};
use speed::{Seen, Speed, by_walls};
use usual::{ChangeOfSpeed, Driving, Surprise};

/// A change of speed counts where the walls tell the place to this in every direction, metres.
const WELL_TOLD_M: f64 = 0.01;

/// A log with more than one step in ten longer than this is one of keyframes, metres.
const SMOOTH_STEP_M: f64 = 0.5;
/// Steps after which the speed is known again.
const STEADY_STEPS: u32 = 3;
/// Steps that are remembered.
const MEMORY: usize = 64;
/// Shares of the density: going on as in the last step, any step as before, anything.
const SHARE_GOING_ON: f64 = 0.5;
const SHARE_AS_BEFORE: f64 = 0.4;
const SHARE_ANYTHING: f64 = 0.1;
/// Anything: standard deviations beside five times the usual surprise, metres and radians. A log of every scan does not
/// jump by metres, one of keyframes may.
const ANYTHING_M: f64 = 0.3;
const ANYTHING_RAD: f64 = 0.3;

/// A heading that is known less well than this is open, radians.
const OPEN_RAD: f64 = 0.1;

/// The scanner's last pose and how it moved to it.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    pub map_from_scan: Pose,
    /// From scan to scan, as far as the walls told it.
    speed: Speed,
    /// How much that changes, and how fast the scanner goes when it goes.
    change: ChangeOfSpeed,
    driving: Driving,
    /// By odometry, from the last placed scan to now, in the frame of the former.
    driven: Option<Pose>,
    /// Scans since, that could not be placed.
    pub lost_scans: u32,
    /// How far off predictions usually are.
    pub usual: Surprise,
    /// Steps since the speed was not known.
    steady: u32,
    /// The last steps, oldest first, each in the frame of the scan before it.
    steps: VecDeque<Pose>,
    /// How many of them are longer than [`SMOOTH_STEP_M`].
    long_steps: usize,
}

impl Motion {
    /// No motion yet.
    pub fn starting_at(map_from_scan: Pose) -> Self {
        Self {
            map_from_scan,
            speed: Speed::default(),
            change: ChangeOfSpeed::default(),
            driving: Driving::default(),
            driven: None,
            lost_scans: 0,
            usual: Surprise::default(),
            steady: 0,
            steps: VecDeque::new(),
            long_steps: 0,
        }
    }

    /// The same with what odometry says since the last placed scan.
    pub fn driven(&self, driven: Option<Pose>) -> Self {
        Self {
            driven,
            ..self.clone()
        }
    }

    /// The same after `scans` more that could not be placed.
    pub fn lost_for(&self, scans: u32) -> Self {
        Self {
            lost_scans: scans,
            ..self.clone()
        }
    }

    /// The motion after the next scan was placed, with what the walls say of the pose (map axes; `None`: it is certain).
    /// After a gap the speed is not known.
    ///
    /// Returns how far off the pose may be, map axes, about the scanner. The filter takes a pose that was found, after a gap or anew, for
    /// certain, because how it was missed says nothing of the speed; but the walls alone tell it.
    pub fn advance(&mut self, pose: Pose, walls: Option<&Information>) -> Covariance {
        let is_found = if self.lost_scans > 0 {
            self.speed = Speed::default();
            self.steady = 0;
            true
        } else if self.is_jump(pose) {
            self.speed.found_anew(&self.change.covariance(self.usual));
            true
        } else {
            self.steady += 1;
            self.follow(pose, walls);
            false
        };
        self.map_from_scan = pose;
        self.driven = None;
        self.lost_scans = 0;
        match walls {
            Some(walls) if is_found => by_walls(walls),
            _ => self.speed.covariance().turned(pose.theta_rad),
        }
    }

    /// Takes in the step to the next pose.
    fn follow(&mut self, pose: Pose, walls: Option<&Information>) {
        let predicted = self.predicted().map_from_scan;
        let turn_rad = wrap_rad(predicted.theta_rad - pose.theta_rad).abs();
        self.usual = self.usual.after(predicted.distance(pose), turn_rad);
        let seen = Seen {
            step: self.map_from_scan.inverse() * pose,
            walls: walls.map(|w| w.turned(-self.map_from_scan.theta_rad)),
        };
        self.driving.take(seen.step.translation().norm());
        if walls.is_some_and(|w| w.weakest_direction().1 > WELL_TOLD_M.powi(-2)) {
            self.change
                .take(seen.step.translation() - self.speed.step.translation());
        }
        // In a log of keyframes there is no speed to go on with.
        let change = if self.is_smooth() {
            self.change.covariance(self.usual)
        } else {
            self.usual.covariance()
        };
        self.speed.see(&seen, &change);
        self.remember(seen.step);
    }

    fn remember(&mut self, step: Pose) {
        let is_long = |step: &Pose| step.translation().norm() > SMOOTH_STEP_M;
        if self.steps.len() == MEMORY {
            let forgotten = self.steps.pop_front();
            self.long_steps -= usize::from(forgotten.as_ref().is_some_and(is_long));
        }
        self.long_steps += usize::from(is_long(&step));
        self.steps.push_back(step);
    }

    /// Whether the next pose is where the scanner turned to while its heading was open: it did not turn there in one step.
    fn is_jump(&self, pose: Pose) -> bool {
        let turn_rad = wrap_rad(self.predicted().map_from_scan.theta_rad - pose.theta_rad).abs();
        self.open_sigmas().is_some() && turn_rad > 2.0 * OPEN_RAD
    }

    /// The speed: the motion from one scan to the next that is expected, in the frame of the former, metres and radians.
    pub fn step(&self) -> Pose {
        self.speed.step
    }

    /// Where the walls have not told the heading for some time, as in a round room: how far off the pose may be by now, standard
    /// deviations in metres and radians.
    pub fn open_sigmas(&self) -> Option<(f64, f64)> {
        let sigmas = self.speed.pose_sigmas();
        (self.is_smooth() && sigmas.1 > OPEN_RAD).then_some(sigmas)
    }

    /// What is expected of the next pose. Where the heading is open, the motion has to tell what the walls do not, and all that is
    /// known of it counts: what never moves sideways turns instead.
    pub fn prior(&self) -> Prior {
        let predicted = self.predicted();
        let change = self.change.covariance(self.usual);
        let information = self
            .open_sigmas()
            .and_then(|_| self.speed.step_information(&change));
        match information {
            Some(information) => Prior {
                map_from_scan: predicted.map_from_scan,
                information: information.turned(self.map_from_scan.theta_rad),
            },
            None => predicted.prior(),
        }
    }

    /// Where the scanner is when it keeps on moving as before, or as odometry says: wheels slip by a tenth of the way.
    pub fn predicted(&self) -> Guess {
        match self.driven {
            Some(driven) => Guess {
                map_from_scan: self.map_from_scan * driven,
                sigma_m: 0.02 + 0.1 * driven.translation().norm(),
                sigma_rad: 0.02 + 0.1 * driven.theta_rad.abs(),
            },
            None => self.after_step(self.speed.step),
        }
    }

    /// Whether scans follow each other so closely that the next is sure to lie near the predicted pose.
    pub fn is_smooth(&self) -> bool {
        self.lost_scans == 0
            && self.steady >= STEADY_STEPS
            && self.usual.shift_m < 0.15
            && self.usual.turn_rad < 0.15
            && 10 * self.long_steps <= self.steps.len()
    }

    /// Where it is when it has stopped.
    pub fn standing(&self) -> Guess {
        Guess {
            map_from_scan: self.map_from_scan,
            ..self.after_step(self.speed.step)
        }
    }

    /// Where it is after steps that it has made before: at most `most`, as different from each other as can be.
    pub fn as_before(&self, most: usize) -> Vec<Guess> {
        let mut chosen: Vec<Pose> = Vec::new();
        let mut candidates: Vec<(Pose, f64)> = self
            .steps
            .iter()
            .rev()
            .map(|&s| (s, self.as_before_density(s)))
            .collect();
        while chosen.len() < most
            && let Some(&(step, _)) = candidates.iter().max_by(|a, b| a.1.total_cmp(&b.1))
        {
            chosen.push(step);
            candidates.retain(|(c, _)| squares(*c, step, spread(step)) > 4.0);
        }
        chosen.into_iter().map(|step| self.after_step(step)).collect()
    }

    /// How likely a pose is to be the next, against the likeliest one: the natural logarithm of the ratio of the
    /// densities, at most 0. `peak` is [`Self::peak`].
    pub fn log_likelihood(&self, pose: Pose, peak: f64) -> f64 {
        let step = self.map_from_scan.inverse() * pose;
        let ratio = (self.density(step) / peak).min(1.0);
        ratio.max(1e-12).ln()
    }

    /// Density of the likeliest step.
    pub fn peak(&self) -> f64 {
        self.steps
            .iter()
            .chain([&self.expected_step()])
            .map(|s| self.density(*s))
            .fold(0.0, f64::max)
    }

    /// The step that is expected: by odometry, or the last one again.
    pub fn expected_step(&self) -> Pose {
        self.driven.unwrap_or(self.speed.step)
    }

    fn density(&self, step: Pose) -> f64 {
        let expected = self.expected_step();
        let going_on = match self.driven {
            Some(_) => spread(expected),
            None => (
                self.usual.shift_m.max(spread(expected).0),
                self.usual.turn_rad.max(spread(expected).1),
            ),
        };
        let lost = 1.0 + f64::from(self.lost_scans);
        let anything = (
            lost * (ANYTHING_M + 5.0 * self.usual.shift_m),
            lost * (ANYTHING_RAD + 5.0 * self.usual.turn_rad),
        );
        SHARE_GOING_ON * gaussian(step, expected, self.widened(going_on))
            + SHARE_AS_BEFORE * self.as_before_density(step)
            + SHARE_ANYTHING * gaussian(step, expected, self.widened(anything))
    }

    fn as_before_density(&self, step: Pose) -> f64 {
        let sum: f64 = self
            .steps
            .iter()
            .map(|s| gaussian(step, *s, self.widened(spread(*s))))
            .sum();
        sum / self.steps.len().max(1) as f64
    }

    /// What a standard deviation of the next step is while the heading is open.
    fn widened(&self, (m, rad): (f64, f64)) -> (f64, f64) {
        let (open_m, open_rad) = self.open_sigmas().unwrap_or_default();
        (open_m.hypot(m), open_rad.hypot(rad))
    }

    fn after_step(&self, step: Pose) -> Guess {
        Guess {
            map_from_scan: self.map_from_scan * step,
            sigma_m: 0.02 + 0.3 * step.translation().norm().max(self.driving.step_m()),
            sigma_rad: 0.02 + 0.3 * step.theta_rad.abs(),
        }
    }
}

/// Standard deviations of a step that is made again, metres and radians: the longer, the less exactly.
fn spread(step: Pose) -> (f64, f64) {
    (
        0.02 + 0.1 * step.translation().norm(),
        0.03 + 0.1 * step.theta_rad.abs(),
    )
}

/// Squared distance of two steps in standard deviations.
fn squares(a: Pose, b: Pose, (sigma_m, sigma_rad): (f64, f64)) -> f64 {
    let shift = a.distance(b) / sigma_m;
    let turn = wrap_rad(a.theta_rad - b.theta_rad) / sigma_rad;
    shift * shift + turn * turn
}

/// Density over (x, y, θ), without the constant (2π)^(3/2).
fn gaussian(step: Pose, mean: Pose, spread: (f64, f64)) -> f64 {
    (-0.5 * squares(step, mean, spread)).exp() / (spread.0 * spread.0 * spread.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_steady_drive_is_expected_to_go_on_and_surprises_less_and_less() {
        let step = Pose::new(0.1, 0.0, 0.01);
        let mut motion = Motion::starting_at(Pose::IDENTITY);
        for _ in 0..60 {
            motion.advance(motion.map_from_scan * step, None);
        }
        let next = motion.map_from_scan * step;
        assert!(motion.predicted().map_from_scan.distance(next) < 1e-9);
        assert!(motion.usual.shift_m < 0.04, "{:?}", motion.usual);
    }

    #[test]
    fn along_a_corridor_the_speed_goes_on_as_it_was_before() {
        let drive = |walls: Information| {
            let mut motion = Motion::starting_at(Pose::IDENTITY);
            let room = Information::from_sigmas(0.005, 0.005, 0.002);
            for _ in 0..20 {
                motion.advance(motion.map_from_scan * Pose::new(0.10, 0.0, 0.0), Some(&room));
            }
            // Something that walks along makes the steps look shorter.
            for _ in 0..3 {
                motion.advance(motion.map_from_scan * Pose::new(0.05, 0.0, 0.0), Some(&walls));
            }
            motion.speed.step.x
        };
        let corridor = drive(Information::from_sigmas(0.3, 0.005, 0.002));
        assert!(corridor > 0.09, "{corridor} m a step");
        let room = drive(Information::from_sigmas(0.005, 0.005, 0.002));
        assert!((room - 0.05).abs() < 0.01, "{room} m a step where the walls tell");
    }

    /// A robot that drove ahead, has turned on the spot in a corner, and drives into a round room: for `scans` walls tell nothing but
    /// where the room's middle is.
    fn in_a_round_room(scans: usize) -> Motion {
        let room = Information::from_sigmas(0.005, 0.005, 0.002);
        let mut motion = Motion::starting_at(Pose::IDENTITY);
        let ahead = Pose::new(0.05, 0.0, 0.0);
        let about = Pose::new(0.0, 0.0, 0.08);
        let steps = [[ahead; 40].as_slice(), &[about; 10], &[ahead; 10]].concat();
        for step in steps {
            motion.advance(motion.map_from_scan * step, Some(&room));
        }
        let round = Information::from_sigmas(0.005, 0.005, 1.0);
        for _ in 0..scans {
            motion.advance(motion.map_from_scan * ahead, Some(&round));
        }
        motion
    }

    #[test]
    fn a_heading_that_walls_do_not_tell_is_open_after_some_scans() {
        assert_eq!(in_a_round_room(1).open_sigmas(), None);
        let (_, rad) = in_a_round_room(20).open_sigmas().unwrap();
        assert!(rad > 0.2, "{rad} rad");
    }

    #[test]
    fn while_the_heading_is_open_turning_is_likelier_than_moving_sideways() {
        let motion = in_a_round_room(20);
        let information = motion.prior().information.turned(-motion.map_from_scan.theta_rad);
        // As far as either moves the middle of the room, a quarter of a metre ahead.
        let (sideways, turning) = ([0.0, 0.02, 0.0], [0.0, 0.0, 0.08]);
        assert!(information.quadratic(turning) < information.quadratic(sideways));
    }

    #[test]
    fn a_heading_found_anew_is_no_turn_of_the_scanner() {
        let mut motion = in_a_round_room(20);
        let (before, usual) = (motion.step(), motion.usual);
        let room = Information::from_sigmas(0.005, 0.005, 0.002);
        motion.advance(motion.map_from_scan * Pose::new(0.05, 0.0, 0.9), Some(&room));
        assert_eq!(motion.step(), before);
        assert!((motion.usual.turn_rad - usual.turn_rad).abs() < 1e-12);
        assert_eq!(motion.open_sigmas(), None, "it is known now");
    }

    #[test]
    fn a_pose_found_after_a_gap_is_as_uncertain_as_the_walls_leave_it() {
        let found = |walls: &Information| {
            let mut motion = Motion {
                lost_scans: 3,
                ..Motion::starting_at(Pose::IDENTITY)
            };
            let rows = motion.advance(Pose::new(4.0, 0.0, 1.0), Some(walls)).rows;
            [0, 1, 2].map(|k| rows[k][k].sqrt())
        };
        let [along_m, across_m, turn_rad] = found(&Information::from_sigmas(0.3, 0.005, 0.002));
        assert!((along_m - 0.6).abs() < 0.01, "{along_m} m");
        assert!(across_m < 0.02 && turn_rad < 0.01, "{across_m} m, {turn_rad} rad");
        let [x_m, y_m, _] = found(&Information::default());
        assert!(x_m >= 10.0 && y_m >= 10.0, "no walls: {x_m} m, {y_m} m");
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
        let mut found = Motion {
            lost_scans: 3,
            ..Motion::starting_at(Pose::IDENTITY)
        };
        found.advance(Pose::new(4.0, 0.0, 0.0), None);
        assert!(
            found.speed.step.translation().norm() < 1e-12,
            "four metres in four scans is no speed"
        );
    }
}
