//! One account of how the scanner has moved, and the map that follows from it.
//!
//! Where the walls cannot tell between two places, both accounts are carried on over the next scans, each with its own
//! merging, until one of them explains the scans worse. The loser's merging goes with it.

use super::atlas::Atlas;
use super::{NotPlaced, Outcome, Settings, Step};
use crate::geometry::Pose;
use crate::keyframe::Seen;
use crate::place::{Answer, Motion, Placement, Question, place};

/// See the module.
#[derive(Clone, Default)]
pub(super) struct Track {
    motion: Option<Motion>,
    /// Odometry of the last placed scan.
    odometry: Option<Pose>,
    atlas: Atlas,
    held: Vec<Held>,
    /// What its placements have gathered since another track branched off.
    pub merit: f64,
}

/// How a scan is held: by a keyframe, with which it moves when loops are closed, or not at all.
#[derive(Clone, Copy)]
enum Held {
    By {
        keyframe: usize,
        keyframe_from_scan: Pose,
    },
    Nowhere(NotPlaced),
}

impl Track {
    /// Finds the next scan's place.
    pub fn place(&self, seen: &Seen, odometry: Option<Pose>, settings: &Settings) -> Answer {
        let Some(mut motion) = self.motion.clone() else {
            return Answer::default();
        };
        if let (Some(before), Some(now)) = (self.odometry, odometry) {
            motion.driven = Some(before.inverse() * now);
        }
        let question = Question {
            points: &seen.points,
            polylines: &seen.extraction.polylines,
            map: self.atlas.local(),
            merged_into: self.atlas.merged_into(),
            motion: &motion,
        };
        place(question, &settings.align, &settings.place)
    }

    /// Whether nothing has been placed yet.
    pub fn is_empty(&self) -> bool {
        self.motion.is_none()
    }

    /// Where the last placed scan is.
    pub fn pose(&self) -> Option<Pose> {
        self.motion.as_ref().map(|m| m.map_from_scan)
    }

    /// The scan has no place here.
    pub fn miss(&mut self, reason: NotPlaced) {
        self.held.push(Held::Nowhere(reason));
        if let Some(motion) = &mut self.motion {
            motion.lost_scans += 1;
        }
    }

    /// Goes on to a placed scan; the first one makes the frame of the map.
    pub fn advance(&mut self, placement: Option<&Placement>, odometry: Option<Pose>) {
        let pose = placement.map_or(Pose::IDENTITY, |p| p.alignment.map_from_scan);
        match &mut self.motion {
            Some(motion) => motion.advance(pose),
            None => self.motion = Some(Motion::starting_at(pose)),
        }
        self.odometry = odometry;
    }

    /// Whether the placed scan shall be merged.
    pub fn wants(&self, step: &Step) -> bool {
        self.pose().is_some_and(|pose| self.atlas.wants(pose, step))
    }

    /// Merges the placed scan.
    pub fn merge(&mut self, step: &mut Step, seen: &Seen, settings: &Settings) {
        if let Some(pose) = self.pose() {
            self.atlas.add_keyframe(step, seen, pose, settings);
        }
    }

    /// Looks for known places; the scanner moves along when one moves the newest keyframe.
    pub fn close_loops(&mut self, step: &mut Step, settings: &Settings) {
        let moved = self.atlas.close_loops(step, settings);
        if let Some(motion) = &mut self.motion {
            motion.map_from_scan = moved * motion.map_from_scan;
        }
    }

    /// Holds the placed scan by the newest keyframe.
    pub fn hold(&mut self) -> Outcome {
        let pose = self.pose().unwrap_or(Pose::IDENTITY);
        let (keyframe, map_from_keyframe) = self.atlas.newest();
        self.held.push(Held::By {
            keyframe,
            keyframe_from_scan: map_from_keyframe.inverse() * pose,
        });
        Outcome::Placed { map_from_scan: pose }
    }

    /// What became of every scan so far, in the map frame as it is now.
    pub fn outcomes(&self) -> Vec<Outcome> {
        let outcome = |held: &Held| match *held {
            Held::By {
                keyframe,
                keyframe_from_scan,
            } => Outcome::Placed {
                map_from_scan: self.atlas.pose(keyframe) * keyframe_from_scan,
            },
            Held::Nowhere(reason) => Outcome::NotPlaced { reason },
        };
        self.held.iter().map(outcome).collect()
    }

    /// The map of all scans so far.
    pub fn map(&self, settings: &Settings) -> crate::map::Map {
        self.atlas.map(settings)
    }
}
