//! When a keyframe that is looked for again lies in another place.

use crate::geometry::Pose;

/// How far from where it lies a keyframe is looked for, metres.
pub(super) const WINDOW_M: f64 = 2.5;
/// Another place is farther off than this, metres or radians: nearer ones are for the adjustment.
const OTHER_M: f64 = 0.25;
const OTHER_RAD: f64 = 0.07;

/// Whether a pose is another place than `here`.
pub(super) fn is_elsewhere(pose: Pose, here: Pose) -> bool {
    !pose.is_within(OTHER_M, OTHER_RAD, here)
}
