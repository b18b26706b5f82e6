//! How far the scanner moves on while its beam goes round (not in the paper, which takes scans as taken at once).
//!
//! In: pairs of keyframes. Out: the share of the motion from scan to scan that one turn of the beam takes. It is 1 for a
//! scanner that goes round once a scan counter-clockwise, −1 clockwise, and near 0 for one that turns much faster than scans
//! are logged. No log need say so: of two scans taken at different speeds or from different sides, the walls lie on each other
//! only if both are made straight with the right share ([`evidence()`]).
//!
//! Untold, a scanner in the hand at 10 Hz makes a room turn: what is passed on the left seems to go by faster than what is
//! passed on the right, because it is measured later. (URG on a robot at 1 m/s, 47 m: 20° off at the end.)

mod evidence;

use crate::align::AlignSettings;
use crate::keyframe::Keyframe;
use evidence::evidence;

/// The share so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sweep {
    /// Information on the share, and that times the share.
    information: f64,
    weighted: f64,
    /// What scans are made straight with.
    applied: f64,
}

/// Information before anything was seen: it is 0, give or take 0.3.
const BEFORE: f64 = 11.0;
/// Returns of a wall err together, and so do pairs of the same walls: so much of the information counts.
const INDEPENDENCE: f64 = 0.1;
/// A share is used when it is so many standard deviations from 0,
const SURE_SIGMAS: f64 = 3.0;
/// and so far: logs of SICKs, whose mirrors go round 75 times a second, come out at 0.0 to 0.3; made straight with 0.2, raw intel and
/// aces got no better (all relations 13.5 and 35.8 mm instead of 13.4 and 35.6).
const LEAST: f64 = 0.35;
/// What was used is changed when the share has moved so far from it.
const CHANGED: f64 = 0.1;
/// The same when no scan follows.
const CHANGED_AT_LAST: f64 = 0.01;
/// No beam takes longer to go round than from scan to scan.
const MOST: f64 = 1.0;
/// Information from which on the share is known well enough: 0.02.
const ENOUGH: f64 = 1000.0;
/// Keyframes before the newest that it is compared with: over the next half metre the speed has changed, over three metres the
/// side that things are seen from.
const PAIRS: [usize; 2] = [2, 10];

impl Sweep {
    /// What scans are made straight with: the share of the motion from scan to scan that a turn of the beam takes.
    pub fn applied(&self) -> f64 {
        self.applied
    }

    /// Takes in the newest of the keyframes. Returns whether what is applied has changed.
    pub fn observe(&mut self, keyframes: &[Keyframe], align: &AlignSettings) -> bool {
        let Some((newest, earlier)) = keyframes.split_last() else {
            return false;
        };
        if self.information > ENOUGH {
            return false;
        }
        for other in PAIRS
            .iter()
            .filter_map(|&back| earlier.len().checked_sub(back))
            .map(|k| &earlier[k])
        {
            if let Some(found) = evidence(other, newest, self.share(), align) {
                self.information += INDEPENDENCE * found.information;
                self.weighted += INDEPENDENCE * found.information * found.share;
            }
        }
        self.apply(CHANGED)
    }

    /// Applies what is known by now, when no scan follows. Returns whether it differs from what was applied.
    pub fn settle(&mut self) -> bool {
        self.apply(CHANGED_AT_LAST)
    }

    fn share(&self) -> f64 {
        (self.weighted / (self.information + BEFORE)).clamp(-MOST, MOST)
    }

    fn apply(&mut self, changed: f64) -> bool {
        let share = self.share();
        let sigma = 1.0 / (self.information + BEFORE).sqrt();
        let is_sure = share.abs() > (SURE_SIGMAS * sigma).max(LEAST);
        let wanted = if is_sure { share } else { 0.0 };
        let is_changed = (wanted - self.applied).abs() > changed;
        if is_changed {
            self.applied = wanted;
        }
        is_changed
    }
}
