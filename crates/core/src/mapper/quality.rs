//! How well a scan was placed, in a few numbers that can be kept for every scan of a log.
//!
//! In: a [`Step`]. Out: what it says of the moment at which the scan was placed. Closures and the end of a log move poses later,
//! and maps are turned; directions are therefore in the laser frame, where they stay what they are.

use super::Step;
use crate::align::Covariance;
use crate::place::Origin;

/// See the module. What is not known is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quality {
    /// Where the pose came from.
    pub won: Option<Origin>,
    /// By how much it led the best other one: the difference in merit. `None` where there was no other.
    pub lead: Option<f64>,
    /// How many poses were looked at.
    pub hypotheses: Option<usize>,
    /// Of the beams that the map said something of, the share that ended on it, 0..=1.
    pub fit: Option<f64>,
    /// Share of the beams that the map said something of, 0..=1.
    pub known: Option<f64>,
    /// Share of the beams that went through walls of the map, 0..=1.
    pub through: Option<f64>,
    /// Share of the returns that found a side of the map, 0..=1.
    pub matched: Option<f64>,
    /// See [`Step::rank`].
    pub rank: Option<u8>,
    /// Direction along which the walls left the place open, laser frame, radians.
    pub open_rad: Option<f64>,
    /// See [`Step::covariance`]; axes of the laser.
    pub covariance: Option<Covariance>,
}

impl Step {
    /// How well the scan was placed.
    #[must_use]
    pub fn quality(&self) -> Quality {
        let (alignment, agreement) = (self.alignment.as_ref(), self.agreement.as_ref());
        let heading_rad = alignment.map_or(0.0, |a| a.map_from_scan.theta_rad);
        let open = alignment.and_then(|a| a.unobservable);
        Quality {
            won: self.won,
            lead: self.lead,
            hypotheses: self.won.map(|_| self.hypotheses.len()),
            fit: agreement.map(|a| a.fit()),
            known: agreement.map(|a| a.known_share()),
            through: agreement.map(|a| a.through as f64 / a.beams.max(1) as f64),
            matched: alignment.map(|a| a.matched_share()),
            rank: self.rank,
            open_rad: open.map(|d| d.y.atan2(d.x) - heading_rad),
            covariance: self.covariance.map(|c| c.turned(-heading_rad)),
        }
    }
}
