//! How a scanner is mounted: the static transforms from its frame up to the root.

use std::collections::BTreeMap;

use super::messages::StampedTransform;
use super::transform::Transform;

/// More frames than a robot has.
const MAX_FRAMES: usize = 4096;
/// Longer chains are circles.
const MAX_CHAIN: usize = 64;

/// `base_from_laser`, the base being the root of the static transforms.
pub(super) struct Mount(Transform);

impl Mount {
    pub fn is_upside_down(&self) -> bool {
        self.0.up() < 0.0
    }

    /// Angle between the scanner's plane and the level, degrees.
    pub fn lean_deg(&self) -> f64 {
        self.0.up().abs().min(1.0).acos().to_degrees()
    }
}

/// All static transforms, by the name of the child.
#[derive(Default)]
pub(super) struct Mounts {
    parents: BTreeMap<String, (String, Transform)>,
}

impl Mounts {
    /// Takes a transform; one that is no number is left out.
    pub fn insert(&mut self, transform: StampedTransform) {
        let child = frame(&transform.child_frame);
        let is_known = self.parents.contains_key(child);
        if transform.transform.is_finite() && (is_known || self.parents.len() < MAX_FRAMES) {
            let parent = frame(&transform.header.frame).to_owned();
            self.parents
                .insert(child.to_owned(), (parent, transform.transform));
        }
    }

    /// How the scanner with this frame is mounted; level and upright where nothing is known.
    pub fn of(&self, laser: &str) -> Mount {
        let (_, transform) = self.chain(laser, |_| false);
        Mount(transform)
    }

    /// Goes up from `from` to the first frame that `is_end`, or to the root: its name, and `end_from_frame`.
    pub fn chain<'a>(&'a self, from: &'a str, is_end: impl Fn(&str) -> bool) -> (&'a str, Transform) {
        let mut at = frame(from);
        let mut transform = Transform::IDENTITY;
        for _ in 0..MAX_CHAIN {
            if is_end(at) {
                break;
            }
            let Some((parent, parent_from_child)) = self.parents.get(at) else {
                break;
            };
            transform = parent_from_child.after(&transform);
            at = parent;
        }
        (at, transform)
    }
}

/// The name of a frame without the slash that old ROS puts before it.
pub(super) fn frame(name: &str) -> &str {
    name.trim_start_matches('/')
}
