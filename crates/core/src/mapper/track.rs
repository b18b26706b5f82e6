//! One account of how the scanner has moved, and the map that follows from it.
//!
//! Where the walls cannot tell between two places, both accounts are carried on over the next scans, each with its own
//! merging, until one of them explains the scans worse. The loser's merging goes with it.
//!
//! Where nothing fits, the scan begins a map of its own and mapping goes on in that. It is joined to the map before when
//! its scans are recognised there in exactly one way; when instead the next scan fits into the map before, that is
//! taken up again. Nothing is merged just to keep going.

use super::atlas::Atlas;
use super::left::Left;
use super::{LooseStretch, NotPlaced, Outcome, Settings, Step};
use crate::align::Covariance;
use crate::geometry::Pose;
use crate::join::SavedMap;
use crate::keyframe::{Keyframe, Seen};
use crate::map::Map;
use crate::place::{Answer, Motion, Placement, Question, place};

/// See the module.
#[derive(Clone, Default)]
pub(super) struct Track {
    motion: Option<Motion>,
    /// Odometry of the last placed scan.
    odometry: Option<Pose>,
    atlas: Atlas,
    /// Maps that were left when the scanner was lost, the last one at the end.
    left: Vec<Left>,
    held: Vec<Held>,
    /// What its placements have gathered since another track branched off.
    pub merit: f64,
}

/// How a scan is held: by a keyframe, with which it moves when loops are closed, or not at all.
#[derive(Clone, Copy)]
enum Held {
    By {
        atlas: u32,
        keyframe: usize,
        keyframe_from_scan: Pose,
    },
    Nowhere(NotPlaced),
}

/// How a scan goes on.
#[derive(Clone, Copy)]
pub(super) enum Way {
    /// In the map so far; the first scan of a map has no placement.
    On(Option<Placement>),
    /// In a map that was left, by its place among them.
    Back(usize, Placement),
    /// In a map of its own.
    Apart,
}

impl Track {
    /// Finds the next scan's place in the map so far.
    pub fn place(&self, seen: &Seen, odometry: Option<Pose>, settings: &Settings) -> Answer {
        let driven = self
            .odometry
            .zip(odometry)
            .map(|(before, now)| before.inverse() * now);
        match &self.motion {
            Some(motion) => place_in(&self.atlas, &motion.driven(driven), seen, settings),
            None => Answer::default(),
        }
    }

    /// Finds its place in the maps that were left, the last one first. A single scan is believed only when nothing else
    /// comes near, and in maps that were left just now.
    pub fn place_back(&self, seen: &Seen, settings: &Settings) -> Option<(usize, Answer)> {
        let mut near = (0..self.left.len()).rev().filter(|&k| self.left[k].is_near());
        near.find_map(|k| {
            let left = &self.left[k];
            let motion = left.motion.lost_for(left.scans);
            let answer = place_in(&left.atlas, &motion, seen, settings);
            let stands_out = |p: &Placement| p.lead.is_none_or(|lead| lead >= settings.place.far_lead);
            answer
                .placement
                .as_ref()
                .is_some_and(stands_out)
                .then_some((k, answer))
        })
    }

    /// The motion from scan to scan, in the scanner's frame; none where scans do not follow each other closely.
    pub fn speed(&self) -> Pose {
        match &self.motion {
            Some(motion) if motion.is_smooth() => motion.step(),
            _ => Pose::IDENTITY,
        }
    }

    /// Makes all keyframes straight again, with another share of the motion from scan to scan in a turn of the beam.
    pub fn straighten(&mut self, share: f64, settings: &Settings) {
        self.atlas.straighten(share, settings);
        for left in &mut self.left {
            left.straighten(share, settings);
        }
    }

    /// The keyframes of the present map, oldest first.
    pub fn keyframes(&self) -> &[Keyframe] {
        self.atlas.keyframes()
    }

    /// Whether nothing has been placed yet.
    pub fn is_empty(&self) -> bool {
        self.motion.is_none()
    }

    /// Whether the present map is kept apart from a larger one.
    pub fn is_apart(&self) -> bool {
        self.main().id != self.atlas.id
    }

    /// The scan has no place anywhere.
    pub fn miss(&mut self, reason: NotPlaced) {
        self.held.push(Held::Nowhere(reason));
        if let Some(motion) = &mut self.motion {
            motion.lost_scans += 1;
        }
        self.left.iter_mut().for_each(|l| l.scans += 1);
    }

    /// Goes on to the next scan's place, and says where that is and how far off it may be (see [`Step::covariance`]).
    pub fn advance(&mut self, way: &Way, odometry: Option<Pose>) -> (Pose, Option<Covariance>) {
        self.left.iter_mut().for_each(|l| l.scans += 1);
        let pose = match way {
            Way::On(placement) => placement.map_or(Pose::IDENTITY, |p| p.alignment.map_from_scan),
            Way::Back(k, placement) => {
                self.go_back(*k);
                placement.alignment.map_from_scan
            }
            Way::Apart => self.go_apart(),
        };
        let covariance = match &mut self.motion {
            Some(motion) => {
                let walls = match way {
                    Way::On(Some(p)) | Way::Back(_, p) => Some(p.alignment.information),
                    _ => None,
                };
                let covariance = motion.advance(pose, walls.as_ref());
                walls.map(|_| covariance)
            }
            None => {
                self.motion = Some(Motion::starting_at(pose));
                Some(Covariance::default())
            }
        };
        self.odometry = odometry;
        (pose, covariance)
    }

    /// Leaves the map; the next one begins where the scanner would be if it had gone on.
    fn go_apart(&mut self) -> Pose {
        let Some(motion) = &mut self.motion else {
            return Pose::IDENTITY;
        };
        let expected = motion.predicted().map_from_scan;
        let id = 1 + self.left.iter().map(|l| l.atlas.id).fold(self.atlas.id, u32::max);
        let atlas = std::mem::replace(&mut self.atlas, Atlas::numbered(id));
        self.left.push(Left::now(motion.clone(), atlas));
        motion.lost_scans += 1;
        expected
    }

    /// Takes up a map that was left, and leaves the present one in its stead.
    fn go_back(&mut self, k: usize) {
        let Some(motion) = &mut self.motion else { return };
        let left = &mut self.left[k];
        std::mem::swap(&mut left.atlas, &mut self.atlas);
        std::mem::swap(&mut left.motion, motion);
        motion.lost_scans = left.scans;
        *left = Left::now(left.motion.clone(), std::mem::take(&mut left.atlas));
    }

    /// Whether the placed scan shall be merged. Where the heading is open and the map contradicts the scan, it may lie elsewhere:
    /// merged, it would make the map agree with it.
    pub fn wants(&self, pose: Pose, step: &Step, settings: &Settings) -> bool {
        let is_open = self.motion.as_ref().is_some_and(|m| m.open_sigmas().is_some());
        let is_contradicted = step.agreement.is_some_and(|a| {
            a.fit() < settings.place.open_fit && a.known_share() > settings.place.open_known
        });
        self.atlas.wants(pose, step) && !(is_open && is_contradicted)
    }

    /// Merges the placed scan.
    pub fn merge(&mut self, pose: Pose, step: &mut Step, seen: &Seen, settings: &Settings) {
        let speed = self.speed();
        self.left.iter_mut().for_each(|l| l.keyframes += 1);
        self.atlas.add_keyframe(step, seen, pose, speed, settings);
    }

    /// Looks for known places; the scanner moves along when one moves the newest keyframe.
    pub fn close_loops(&mut self, step: &mut Step, settings: &Settings) {
        let moved = self.atlas.close_loops(step, settings);
        self.follow(moved);
    }

    /// Looks for the present map in those that were left.
    pub fn join_left(&mut self, step: &mut Step, settings: &Settings) {
        for k in (0..self.left.len()).rev() {
            if self.join(k, step, settings) {
                return;
            }
        }
    }

    fn follow(&mut self, moved: Pose) {
        if let Some(motion) = &mut self.motion {
            motion.map_from_scan = moved * motion.map_from_scan;
        }
    }

    /// Looks for the present map in one that was left. Returns whether it was found and taken in.
    fn join(&mut self, k: usize, step: &mut Step, settings: &Settings) -> bool {
        let left = &mut self.left[k];
        let Some(edge) = left.find(&self.atlas, settings) else {
            return false;
        };
        step.recognised = Some(left.atlas.keyframes()[edge.from].number);
        let left = self.left.remove(k);
        let new = std::mem::replace(&mut self.atlas, left.atlas);
        let new_id = new.id;
        let begun = left.motion.predicted().map_from_scan;
        let (moved, offset) = self.atlas.absorb(new, edge, begun, settings);
        self.follow(moved);
        self.rehold(new_id, offset);
        true
    }

    /// Scans held by a map that was taken in are held by the one that took it in.
    fn rehold(&mut self, absorbed: u32, offset: usize) {
        for held in &mut self.held {
            if let Held::By { atlas, keyframe, .. } = held
                && *atlas == absorbed
            {
                *atlas = self.atlas.id;
                *keyframe += offset;
            }
        }
    }

    /// Holds the placed scan by the newest keyframe.
    pub fn hold(&mut self) -> Outcome {
        let pose = self.motion.as_ref().map_or(Pose::IDENTITY, |m| m.map_from_scan);
        let (keyframe, map_from_keyframe) = self.atlas.newest();
        let held = Held::By {
            atlas: self.atlas.id,
            keyframe,
            keyframe_from_scan: map_from_keyframe.inverse() * pose,
        };
        self.held.push(held);
        self.outcome(&held)
    }

    /// The map with the most keyframes: the others are kept apart.
    fn main(&self) -> &Atlas {
        let size = |atlas: &Atlas| atlas.keyframes().len();
        self.left
            .iter()
            .map(|l| &l.atlas)
            .fold(&self.atlas, |best, atlas| {
                let is_more = size(atlas) > size(best) || (size(atlas) == size(best) && atlas.id < best.id);
                if is_more { atlas } else { best }
            })
    }

    fn outcome(&self, held: &Held) -> Outcome {
        let main = self.main();
        match *held {
            Held::By {
                atlas,
                keyframe,
                keyframe_from_scan,
            } if atlas == main.id => Outcome::Placed {
                map_from_scan: main.pose(keyframe) * keyframe_from_scan,
            },
            Held::By { .. } => Outcome::NotPlaced {
                reason: NotPlaced::SeparateSubmap,
            },
            Held::Nowhere(reason) => Outcome::NotPlaced { reason },
        }
    }

    /// What became of every scan so far, in the map frame as it is now.
    pub fn outcomes(&self) -> Vec<Outcome> {
        self.held.iter().map(|held| self.outcome(held)).collect()
    }

    /// Adjusts poses and walls of every map together; the scanner moves along. Returns the scans that were placed again.
    pub fn settle(&mut self, settings: &Settings) -> Vec<usize> {
        let (moved, mut placed_again) = self.atlas.settle(settings);
        self.follow(moved);
        for left in &mut self.left {
            placed_again.extend(left.settle(settings));
        }
        placed_again.sort_unstable();
        placed_again
    }

    /// Stretches of the way that are known poorly.
    pub fn loose_stretches(&self) -> Vec<LooseStretch> {
        self.main().loose_stretches()
    }

    /// What must be kept of the map.
    pub fn saved(&self) -> SavedMap {
        self.main().saved()
    }

    /// The map of all scans that are placed.
    pub fn map(&self, settings: &Settings) -> Map {
        self.main().map(settings)
    }
}

fn place_in(atlas: &Atlas, motion: &Motion, seen: &Seen, settings: &Settings) -> Answer {
    let question = Question {
        points: &seen.points,
        polylines: &seen.extraction.polylines,
        map: atlas.local(),
        merged_into: atlas.merged_into(),
        motion,
    };
    place(question, &settings.align, &settings.place)
}
