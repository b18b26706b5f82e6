//! The motion round a bend that the walls leave open.
//!
//! In: the information of an alignment's walls. Out: the same without what it says of that motion, and a prior that holds
//! the pose there. Round walls are drawn with corners where the last scans had them, so that every scan seems to stand where the
//! last one stood: the little that they say is not to be believed (simulated ring-shaped corridor, 5.6 m reach: a third of
//! the way lost). What straight walls say is weak but right: left out in corridors, too, a real log's loops were ten times as far
//! off.

use crate::align::{Alignment, Information};

/// Standard deviation of a step along the open motion, metres: so steady is a scanner from one scan to the next.
const STEADY_M: f64 = 0.005;

/// Turn of a bend, radians a metre: a corridor round 20 m and less.
const LEAST_BEND_PER_M: f64 = 0.05;

/// A motion of the scanner, metres, metres, radians (map axes, turn about the scanner), a metre long.
#[derive(Clone, Copy)]
pub(crate) struct Open([f64; 3]);

impl Open {
    /// What the walls of an alignment leave open, if it is a way round a bend. The heading goes with the place as the walls have it: round a
    /// ring the scanner turns as it moves on.
    pub fn of(alignment: &Alignment) -> Option<Self> {
        let along = alignment.unobservable?;
        let rows = &alignment.information.rows;
        let turn = if rows[2][2] > 0.0 {
            -(rows[2][0] * along.x + rows[2][1] * along.y) / rows[2][2]
        } else {
            0.0
        };
        (turn.abs() > LEAST_BEND_PER_M).then_some(Self([along.x, along.y, turn]))
    }

    /// The information without what it says of this motion.
    pub fn taken_out(&self, information: &Information) -> Information {
        let pull = information.times(self.0);
        let all = information.quadratic(self.0);
        let mut left = *information;
        if all > 0.0 {
            left.add_residual(pull, -1.0 / all);
        }
        left
    }

    /// Information that holds the pose along this motion and leaves free what the walls determine.
    pub fn held(&self, walls: &Information) -> Information {
        let pull = walls.times(self.0);
        let all = walls.quadratic(self.0);
        let mut held = Information::default();
        if all > 0.0 {
            let unit = pull.map(|p| p / all);
            held.add_residual(unit, 1.0 / (STEADY_M * STEADY_M));
        }
        held
    }
}
