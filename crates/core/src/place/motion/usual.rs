//! What the scanner usually does: how far off predictions are, how much its speed changes, how fast it drives.
//!
//! In: every step. Out: standard deviations, so that one set of settings serves a log of every scan, one of keyframes, a robot
//! and a hand.

use super::speed::diagonal;
use crate::geometry::Point;
use crate::geometry::matrix::Matrix;

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
    /// The same after another pose was that far off the predicted one.
    pub fn after(self, shift_m: f64, turn_rad: f64) -> Self {
        const GAIN: f64 = 0.1;
        Self {
            shift_m: (self.shift_m + GAIN * (shift_m - self.shift_m)).max(0.03),
            turn_rad: (self.turn_rad + GAIN * (turn_rad - self.turn_rad)).max(0.02),
        }
    }

    /// Of x, y and the heading, whichever way the scanner looks.
    pub fn covariance(self) -> Matrix {
        diagonal(self.shift_m, self.turn_rad)
    }
}

/// From so many changes of speed on their mean is believed, and so many make it up.
const FEWEST_CHANGES: u32 = 20;
const MOST_CHANGES: u32 = 300;
/// Standard deviation of the change of speed at the least, metres a scan.
const STEADIEST_M: f64 = 0.002;

/// How much the speed changes from scan to scan where the walls tell it: a running mean. Where they do not, it changes no more
/// than there: a robot that drives along a round wall goes on driving, and what never moves sideways does not there. It is the mean
/// of squares: a robot that stops once in a hundred scans stops within one. (Of absolute values, one recorded log stood
/// still for a metre.)
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChangeOfSpeed {
    /// Means of x², xy and y² of the change, scanner's axes, m².
    squares_m2: [f64; 3],
    count: u32,
}

impl ChangeOfSpeed {
    /// Takes a change into the mean, scanner's axes, metres a scan.
    pub fn take(&mut self, change: Point) {
        self.count = (self.count + 1).min(MOST_CHANGES);
        let squares_m2 = [change.x * change.x, change.x * change.y, change.y * change.y];
        for (mean, new) in self.squares_m2.iter_mut().zip(squares_m2) {
            *mean += (new - *mean) / f64::from(self.count);
        }
    }

    /// Covariance of the next change (x, y, heading), scanner's axes, metres and radians a scan; poses usually lie `usual` from the
    /// predicted ones, and it is no larger than that.
    pub fn covariance(&self, usual: Surprise) -> Matrix {
        let mut covariance = usual.covariance();
        if self.count >= FEWEST_CHANGES {
            let [xx, xy, yy] = self.squares_m2;
            let share = (covariance[0][0] / (xx + yy)).min(1.0);
            let least_m2 = STEADIEST_M * STEADIEST_M;
            covariance[0] = [share * xx + least_m2, share * xy, 0.0];
            covariance[1] = [share * xy, share * yy + least_m2, 0.0];
        }
        covariance
    }
}

/// How far the scanner goes from scan to scan when it goes: the mean of its steps, each counted as its length, so that
/// standing counts nothing. Who stands may drive off at once: expected to stand on, to 2 cm, a scanner stayed behind for ten
/// scans at the end of a corridor whose walls tell little, by 0.6 m, in two of three runs of a recorded log, ranges alike to a millionth.
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
