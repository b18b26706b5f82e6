//! How unlike the rest of a log a step from keyframe to keyframe is: a scanner moves as it has moved elsewhere.

use crate::geometry::{Pose, wrap_rad};
use crate::keyframe::Keyframe;

/// Other steps of the log that must be like a step for it to be an ordinary one.
const LIKE_IT: usize = 5;
/// Steps so near in the log are no examples: they may be wrong, too.
const TOO_NEAR: usize = 3;
/// When so many keyframes follow one, there are examples enough.
pub(super) const ENOUGH_AFTER: usize = TOO_NEAR + LIKE_IT + 1;

/// How unlike the steps of the log that are not near keyframe `k` a step is, metres (1 rad counts as 1 m).
pub(super) fn oddity(keyframes: &[Keyframe], k: usize, step: Pose) -> f64 {
    let mut unlike: Vec<f64> = (1..keyframes.len())
        .filter(|j| (j - 1).abs_diff(k) > TOO_NEAR)
        .map(|j| keyframes[j - 1].map_from_scan.inverse() * keyframes[j].map_from_scan)
        .map(|other| step.distance(other) + wrap_rad(step.theta_rad - other.theta_rad).abs())
        .collect();
    unlike.sort_by(f64::total_cmp);
    unlike.get(LIKE_IT - 1).copied().unwrap_or(f64::INFINITY)
}
