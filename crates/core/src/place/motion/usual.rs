//! What the scanner usually does: how far off predictions are, how much its speed changes, how fast it drives.
//!
//! In: every step. Out: standard deviations, so that one set of settings serves a log of every scan, one of keyframes, a robot
//! and a hand.

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
    pub fn after(self, shift_m: f64, turn_rad: f64) -> Self {
        const GAIN: f64 = 0.1;
        Self {
            shift_m: (self.shift_m + GAIN * (shift_m - self.shift_m)).max(0.03),
            turn_rad: (self.turn_rad + GAIN * (turn_rad - self.turn_rad)).max(0.02),
        }
    }
}

/// From so many changes of speed on their mean is believed, and so many make it up.
const FEWEST_CHANGES: u32 = 20;
const MOST_CHANGES: u32 = 300;
/// Standard deviation of the change of speed at the least, metres a scan.
const STEADIEST_M: f64 = 0.002;

/// How much the speed changes from scan to scan where the walls tell it: a running mean. Where they do not, it changes no more
/// than there; a robot that drives along a round wall goes on driving. It is the mean of squares: a robot that stops
/// once in a hundred scans stops within one. (Of absolute values, one recorded log stood still for a metre.)
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChangeOfSpeed {
    mean_square_m2: f64,
    count: u32,
}

impl ChangeOfSpeed {
    /// Takes a change into the mean.
    pub fn take(&mut self, change_m: f64) {
        self.count = (self.count + 1).min(MOST_CHANGES);
        self.mean_square_m2 += (change_m * change_m - self.mean_square_m2) / f64::from(self.count);
    }

    /// Standard deviation of a change, metres a scan, when poses usually lie `usual_m` from the predicted ones.
    pub fn sigma_m(self, usual_m: f64) -> f64 {
        if self.count < FEWEST_CHANGES {
            return usual_m;
        }
        self.mean_square_m2.sqrt().clamp(STEADIEST_M, usual_m)
    }
}

/// How far the scanner goes from scan to scan when it goes: the mean of its steps, each counted as its length, so that
/// standing counts nothing. Who stands may drive off at once: expected to stand on, to 2 cm, a scanner stayed behind for ten
/// scans at the end of a corridor whose walls tell little, by 0.6 m, in three of six runs of a recorded log.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Driving {
    sum_m: f64,
    sum_m2: f64,
}

impl Driving {
    /// Takes a step into the mean.
    pub fn take(&mut self, step_m: f64) {
        self.sum_m += step_m;
        self.sum_m2 += step_m * step_m;
    }

    /// The usual step, metres.
    pub fn step_m(self) -> f64 {
        if self.sum_m > 0.0 {
            self.sum_m2 / self.sum_m
        } else {
            0.0
        }
    }
}
