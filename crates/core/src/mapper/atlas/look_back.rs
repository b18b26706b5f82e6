//! Known places that were passed without being recognised, looked for when no scan follows.
//!
//! When a place was passed again, the last three metres were all there was to recognise it by, and the way ahead may have been
//! what would have told it from others. In the end every place is known from both sides.

use super::{AGREE_M, Atlas, CONFIRM_FAR_M};
use crate::loops::Recognised;
use crate::mapper::Settings;

/// Way between two looks, metres.
const LOOK_BACK_AFTER_M: f64 = 2.0;

impl Atlas {
    /// Closes loops that were missed. Returns whether poses moved.
    pub fn close_missed(&mut self, settings: &Settings) -> bool {
        let found = self.missed(settings);
        let accepted: Vec<&Recognised> = found
            .iter()
            .filter(|f| self.is_to_be_closed(f, &found, settings))
            .collect();
        if accepted.is_empty() {
            return false;
        }
        self.edges.extend(accepted.iter().map(|f| f.edge));
        self.optimise();
        for newer in accepted.iter().map(|f| f.edge.to) {
            self.tie_visits(newer, settings);
        }
        self.revoke();
        true
    }

    /// Visits that no closure ties to an earlier one at the same place.
    fn missed(&self, settings: &Settings) -> Vec<Recognised> {
        let mut found = Vec::new();
        let mut looked_m = f64::NEG_INFINITY;
        for (newer, keyframe) in self.keyframes.iter().enumerate() {
            if keyframe.way_m >= looked_m + LOOK_BACK_AFTER_M {
                looked_m = keyframe.way_m;
                found.extend(self.known_place(newer, settings));
            }
        }
        found
    }

    /// As on the way: what moves things little is taken, anything else if another agrees with it.
    fn is_to_be_closed(&self, f: &Recognised, found: &[Recognised], settings: &Settings) -> bool {
        let is_near = self.jump_m(&f.edge) <= settings.recognise.confirm_beyond_m;
        let way_m = |f: &Recognised| self.keyframes[f.edge.to].way_m;
        let confirms = |other: &Recognised| {
            let apart_m = (way_m(other) - way_m(f)).abs();
            other.edge.to != f.edge.to
                && (!f.is_far || apart_m >= CONFIRM_FAR_M)
                && self.disagreement_m(&other.edge, &f.edge) <= AGREE_M
        };
        (is_near && !f.is_far) || found.iter().any(confirms)
    }
}
