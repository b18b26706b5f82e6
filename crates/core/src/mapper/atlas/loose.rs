//! Stretches of the way that are known poorly in a finished map.

use std::fmt;

use super::Atlas;
use crate::loops::graph::loose;

/// From one scan to a later one, what all that was measured leaves far open: between round walls, along a bare corridor, where
/// two places looked alike. The map may be wrong there and fit all the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LooseStretch {
    /// The last scan before it, counted as they were added.
    pub from_scan: usize,
    /// The first scan behind it.
    pub to_scan: usize,
    /// Standard deviation of the motion along the whole of it, or along the step in it that is known least, whichever is larger;
    /// metres, in the direction in which least is known.
    pub sigma_m: f64,
    /// Standard deviation of the turn there, radians.
    pub sigma_rad: f64,
}

impl LooseStretch {
    /// The same with the numbers that scans have elsewhere, given in the order in which they were added.
    #[must_use]
    pub fn numbered(self, numbers: &[usize]) -> Self {
        Self {
            from_scan: numbers[self.from_scan],
            to_scan: numbers[self.to_scan],
            ..self
        }
    }
}

impl fmt::Display for LooseStretch {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self {
            from_scan,
            to_scan,
            sigma_m,
            sigma_rad,
        } = self;
        let sigma_deg = sigma_rad.to_degrees();
        write!(
            f,
            "the way from scan {from_scan} to {to_scan} is known to {sigma_m:.2} m and {sigma_deg:.1}° only (one standard deviation)"
        )
    }
}

impl Atlas {
    /// In the order of the scans.
    pub fn loose_stretches(&self) -> Vec<LooseStretch> {
        loose(&self.poses(), &self.edges)
            .into_iter()
            .map(|stretch| LooseStretch {
                from_scan: self.keyframes[stretch.from].number,
                to_scan: self.keyframes[stretch.to].number,
                sigma_m: stretch.covariance.widest_m(),
                sigma_rad: stretch.covariance.rows[2][2].max(0.0).sqrt(),
            })
            .collect()
    }
}
