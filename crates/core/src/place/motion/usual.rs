//! What the scanner usually does: how far off predictions are, how much its speed changes, how fast it drives.
//!
//! In: every step. Out: standard deviations, so that one set of settings serves a log of every scan, one of keyframes, a robot
//! and a hand.

use crate::geometry::Point;

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

    /// Covariance of the next change (x, y, heading), scanner's axes, when poses usually lie `usual` from the predicted ones:
    /// those know no more than that.
    pub fn covariance(&self, usual: Surprise) -> [[f64; 3]; 3] {
        let (most_m2, turn_rad2) = (usual.shift_m * usual.shift_m, usual.turn_rad * usual.turn_rad);
        let mut squares_m2 = [most_m2, 0.0, most_m2];
        if self.count >= FEWEST_CHANGES {
            let [xx, xy, yy] = self.squares_m2;
            let share = (most_m2 / (xx + yy)).min(1.0);
            squares_m2 = [xx, xy, yy].map(|m2| share * m2);
            squares_m2[0] += STEADIEST_M * STEADIEST_M;
            squares_m2[2] += STEADIEST_M * STEADIEST_M;
        }
        let [xx, xy, yy] = squares_m2;
        [[xx, xy, 0.0], [xy, yy, 0.0], [0.0, 0.0, turn_rad2]]
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
