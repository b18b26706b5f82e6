//! Where the robot's odometry says that it was at the time of a scan.
//!
//! In go `nav_msgs/Odometry`, or moving transforms where there is none; out comes `odometry_from_laser` at a time, put
//! between the two samples around it. Samples that run backwards by more than [`RESTART_S`] are a recording that
//! starts anew; less is jitter and left out. Transforms below `map` are corrections by a mapper, not odometry.

use std::collections::{BTreeMap, VecDeque};

use polymapper_core::geometry::{Pose, wrap_rad};

use super::messages::{Odometry, StampedTransform};
use super::mount::{Mounts, frame};

/// Samples kept of each frame: 40 s at 100 Hz.
const MAX_SAMPLES: usize = 4096;
const MAX_FRAMES: usize = 256;
/// Farther in time than this a sample says nothing about a scan.
const MOST_APART_S: f64 = 0.5;
/// A step back by more than this is a new start.
const RESTART_S: f64 = 5.0;

/// The odometry so far.
#[derive(Default)]
pub(super) struct Track {
    /// Topic of the odometry messages in use.
    topic: Option<String>,
    /// Samples by the frame whose pose they are.
    samples: BTreeMap<String, VecDeque<(f64, Pose)>>,
    newest_s: Option<f64>,
}

impl Track {
    /// Takes a message; the first topic with odometry is the one that counts.
    pub fn add_odometry(&mut self, topic: &str, odometry: &Odometry) {
        if self.topic.is_none() {
            // Messages say more plainly than transforms what they are.
            self.samples.clear();
        }
        if self.topic.get_or_insert_with(|| topic.to_owned()) != topic {
            return;
        }
        if let Some(pose) = odometry.pose.planar() {
            self.add(&odometry.child_frame, odometry.header.stamp_s, pose);
        }
    }

    /// Takes moving transforms, unless there are odometry messages.
    pub fn add_transforms(&mut self, transforms: Vec<StampedTransform>) {
        if self.topic.is_some() {
            return;
        }
        for transform in transforms {
            let below_map = frame(&transform.header.frame) == "map";
            if let (false, Some(pose)) = (below_map, transform.transform.planar()) {
                self.add(&transform.child_frame, transform.header.stamp_s, pose);
            }
        }
    }

    fn add(&mut self, child: &str, stamp_s: f64, pose: Pose) {
        let child = frame(child);
        if !self.samples.contains_key(child) {
            if self.samples.len() >= MAX_FRAMES {
                return;
            }
            self.samples.insert(child.to_owned(), VecDeque::new());
        }
        let Some(samples) = self.samples.get_mut(child) else {
            return;
        };
        if let Some(&(last_s, _)) = samples.back() {
            if stamp_s < last_s - RESTART_S {
                samples.clear();
                self.newest_s = None;
            } else if stamp_s <= last_s {
                return;
            }
        }
        if samples.len() >= MAX_SAMPLES {
            samples.pop_front();
        }
        samples.push_back((stamp_s, pose));
        self.newest_s = Some(self.newest_s.map_or(stamp_s, |n| n.max(stamp_s)));
    }

    /// Whether samples up to this time have come.
    pub fn reaches(&self, stamp_s: f64) -> bool {
        self.newest_s.is_some_and(|newest_s| newest_s >= stamp_s)
    }

    /// `odometry_from_laser` at a time.
    pub fn laser_at(&self, stamp_s: f64, laser: &str, mounts: &Mounts) -> Option<Pose> {
        let (robot, robot_from_laser) = mounts.chain(laser, |f| self.samples.contains_key(f));
        let samples = self.samples.get(robot).or_else(|| {
            // No transform leads to the frame of the odometry: it is taken as the laser's.
            let mut all = self.samples.values();
            all.next().filter(|_| all.next().is_none())
        })?;
        Some(at(samples, stamp_s)? * robot_from_laser.planar()?)
    }

    /// What was used, in words for the user.
    pub fn note(&self) -> Option<String> {
        match &self.topic {
            Some(topic) => Some(format!("odometry from {topic}")),
            None if self.samples.is_empty() => None,
            None => Some("odometry from the moving transforms".to_owned()),
        }
    }
}

/// The pose at a time, between the samples around it.
fn at(samples: &VecDeque<(f64, Pose)>, stamp_s: f64) -> Option<Pose> {
    let after = samples.partition_point(|&(s, _)| s < stamp_s);
    let next = samples.get(after);
    let before = after.checked_sub(1).and_then(|k| samples.get(k));
    match (before, next) {
        (Some(&(s0, a)), Some(&(s1, b))) if stamp_s - s0 <= MOST_APART_S && s1 - stamp_s <= MOST_APART_S => {
            let share = (stamp_s - s0) / (s1 - s0);
            let turn_rad = wrap_rad(b.theta_rad - a.theta_rad);
            Some(Pose::new(
                a.x + share * (b.x - a.x),
                a.y + share * (b.y - a.y),
                a.theta_rad + share * turn_rad,
            ))
        }
        (Some(&(s, pose)), _) if stamp_s - s <= MOST_APART_S => Some(pose),
        (_, Some(&(s, pose))) if s - stamp_s <= MOST_APART_S => Some(pose),
        _ => None,
    }
}
