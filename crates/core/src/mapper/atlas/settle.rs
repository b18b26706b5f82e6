//! What is done when no scan follows: keyframes that the finished map contradicts are looked for again, doubtful steps that
//! are not judged yet are judged by what was seen on both sides, and poses and walls are adjusted together.

use super::Atlas;
use super::edges::{edge_to_next, loosened};
use super::enough::few_of_each_view;
use crate::adjust::adjusted;
use crate::align::Information;
use crate::geometry::{Pose, SideGrid};
use crate::keyframe::Keyframe;
use crate::loops::graph::Edge;
use crate::loops::{is_to_judge, place_again, steps_again};
use crate::mapper::Settings;
use crate::merge::eraser::boxes;
use crate::merge::growing_map::GrowingMap;
use crate::merge::merge_all;
use crate::merge::refit::refit;

/// An edge of a keyframe that was placed again is broken when it is stretched farther, squared standard deviations
/// (χ² with three degrees of freedom: 99.9 %).
const BROKEN_SQUARES: f64 = 16.3;
/// The walls that poses are adjusted with are drawn by so many keyframes of each view; where they lie is then found by the returns
/// of all. (Raw intel: with 2, 3, 4, 6 and with all of them the error of the relations is the same, and with 3 settling takes three quarters
/// of the time.)
const ENOUGH_OF_A_VIEW: usize = 3;
/// How far apart the keyframes may then be all the same: standard deviations, metres and radians.
const LOOSE_M: f64 = 1.0;
const LOOSE_RAD: f64 = 1.0;

impl Atlas {
    /// Gives keyframes another place that lie wrong, and adjusts poses and walls. (Adjusted before as well, the same are
    /// found, and it takes twice the time.) Returns the motion of the map frame that the newest keyframe has made, and the
    /// scans that were placed again.
    pub fn settle(&mut self, settings: &Settings) -> (Pose, Vec<usize>) {
        let (newest, before) = self.newest();
        let mut placed_again = self.look_again(settings);
        // (Of 53 keyframe logs, most of them perturbed in the last digits, judging all steps once more made one worse and none better.)
        placed_again.extend(self.step_again(&self.doubtful(self.unjudged_from), settings));
        if !placed_again.is_empty() {
            placed_again.sort_unstable();
            placed_again.dedup();
            self.optimise();
        }
        self.adjust(settings);
        self.has_moved = true;
        (self.pose(newest) * before.inverse(), placed_again)
    }

    /// Adjusts the poses of all keyframes and the walls together. A wall that stood twice stands once after it, and is
    /// straighter: the returns are assigned again as long as something moves.
    fn adjust(&mut self, settings: &Settings) {
        for _ in 0..settings.adjust.rounds {
            let sides = self.walls(settings);
            let poses = adjusted(&self.keyframes, &self.edges, &sides, &settings.adjust);
            let mut farthest_m = 0.0_f64;
            for (keyframe, pose) in self.keyframes.iter_mut().zip(poses) {
                farthest_m = farthest_m.max(keyframe.map_from_scan.distance(pose));
                keyframe.map_from_scan = pose;
            }
            if farthest_m < settings.adjust.again_beyond_m {
                break;
            }
        }
    }

    /// The sides of a map of the keyframes, as many of them as it takes to see every wall. Laid on the returns, a door frame tells
    /// the place along a corridor (simulated corridor of 40 m, F at 2 cm: 0.83 without, 0.99 with).
    fn walls(&self, settings: &Settings) -> SideGrid {
        let few = few_of_each_view(&self.keyframes, ENOUGH_OF_A_VIEW);
        let erased = boxes(&self.keyframes, &settings.eraser);
        let mut map = GrowingMap::default();
        merge_all(&mut map, few.iter().copied(), &erased, &settings.merge);
        let few: Vec<&Keyframe> = few.into_iter().map(|(_, keyframe)| keyframe).collect();
        refit(&mut map, &few, &settings.merge);
        map.skeleton
    }

    /// All keyframes merged, in order.
    pub fn merged(&self, settings: &Settings) -> GrowingMap {
        let erased = boxes(&self.keyframes, &settings.eraser);
        let mut map = GrowingMap::default();
        merge_all(&mut map, (0..).zip(&self.keyframes), &erased, &settings.merge);
        map
    }

    /// Keyframes from `first` on that were placed when other places came near.
    fn doubtful(&self, first: usize) -> Vec<usize> {
        (first..self.keyframes.len())
            .filter(|&k| self.keyframes[k].is_doubtful)
            .collect()
    }

    /// Measures the doubtful steps anew behind which the scanner has gone on far enough to judge them, before what follows
    /// goes by them: a map that slipped by a niche takes the next corridor for one 4 m off. Returns the scans to which
    /// those led that were others than they were believed to be.
    pub(super) fn judge_steps(&mut self, settings: &Settings) -> Vec<usize> {
        let mut due = self.doubtful(self.unjudged_from);
        due.retain(|&k| is_to_judge(&self.keyframes, k));
        let Some(&last) = due.last() else {
            return Vec::new();
        };
        self.unjudged_from = last + 1;
        let again = self.step_again(&due, settings);
        if !again.is_empty() {
            self.optimise();
            self.has_moved = true;
        }
        again
    }

    /// Measures steps to `doubtful` keyframes anew that were others than they were believed to be. Returns the scans to
    /// which they led.
    fn step_again(&mut self, doubtful: &[usize], settings: &Settings) -> Vec<usize> {
        let found = steps_again(&self.keyframes, doubtful, &settings.align);
        for step in &found {
            let from = step.to - 1;
            self.edges.retain(|e| !(e.from == from && e.to == step.to));
            let there = step.alignment.map_from_scan;
            let edge = edge_to_next(from, self.pose(from), there, Some(&step.alignment));
            self.edges.push(edge);
        }
        found.iter().map(|s| self.keyframes[s.to].number).collect()
    }

    /// Gives keyframes that lie wrong another place. Returns their scans.
    fn look_again(&mut self, settings: &Settings) -> Vec<usize> {
        let doubtful = self.doubtful(0);
        let frame = self.pose(0);
        let found = place_again(
            &mut self.keyframes,
            &doubtful,
            &settings.align,
            &settings.recognise,
        );
        self.keep_frame(frame);
        for edge in &found {
            self.break_edges(edge.to);
            self.edges.push(Edge {
                information: loosened(&edge.information),
                ..*edge
            });
        }
        found.iter().map(|e| self.keyframes[e.to].number).collect()
    }

    /// The map hangs on its first keyframe: when that was given another place, all others move instead.
    fn keep_frame(&mut self, first: Pose) {
        if self.pose(0) != first {
            let back = first * self.pose(0).inverse();
            for keyframe in &mut self.keyframes {
                keyframe.map_from_scan = back * keyframe.map_from_scan;
            }
        }
    }

    /// What was measured when a keyframe was placed wrongly counts no longer: recognised places go, and the way from one
    /// keyframe to the next is whatever it was.
    fn break_edges(&mut self, keyframe: usize) {
        let poses = self.poses();
        let is_broken =
            |e: &Edge| (e.from == keyframe || e.to == keyframe) && e.square(&poses) > BROKEN_SQUARES;
        self.edges.retain(|e| !(e.is_loop && is_broken(e)));
        for edge in self.edges.iter_mut().filter(|e| is_broken(e)) {
            edge.motion = poses[edge.from].inverse() * poses[edge.to];
            edge.information = Information::from_sigmas(LOOSE_M, LOOSE_M, LOOSE_RAD);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keyframe::Keyframe;
    use crate::keyframe::drawn::{HALL, keyframe};

    #[test]
    fn a_map_that_was_turned_stays_turned() {
        let map_from_hall = Pose::new(3.0, -2.0, 0.4);
        let keyframes: Vec<Keyframe> = (0..10)
            .map(|k| {
                let pose = Pose::new(f64::from(k) - 5.0, 0.2, 0.0);
                Keyframe {
                    map_from_scan: map_from_hall * pose,
                    ..keyframe(HALL, pose)
                }
            })
            .collect();
        let first = keyframes[0].map_from_scan;
        let mut atlas = Atlas {
            keyframes,
            ..Atlas::default()
        };
        atlas.settle(&Settings::default());
        assert_eq!(atlas.pose(0), first);
        let last = map_from_hall * Pose::new(4.0, 0.2, 0.0);
        assert!(atlas.pose(9).distance(last) < 0.01, "{:?}", atlas.pose(9));
    }
    /// A walk through the hall: from its seventh keyframe on all lie 1.2 m too far on, which was doubtful.
    fn walk_that_slipped() -> Atlas {
        let keyframes: Vec<Keyframe> = (0..16)
            .map(|k| {
                let truth = Pose::new(f64::from(k) - 7.0, 0.2, 0.0);
                let slipped_m = if k >= 6 { 1.2 } else { 0.0 };
                Keyframe {
                    number: k as usize,
                    way_m: f64::from(k) + slipped_m,
                    is_doubtful: k == 6,
                    map_from_scan: Pose::new(truth.x + slipped_m, truth.y, 0.0),
                    ..keyframe(HALL, truth)
                }
            })
            .collect();
        let edge = |k: usize| {
            edge_to_next(
                k,
                keyframes[k].map_from_scan,
                keyframes[k + 1].map_from_scan,
                None,
            )
        };
        let edges = (0..keyframes.len() - 1).map(edge).collect();
        Atlas {
            keyframes,
            edges,
            ..Atlas::default()
        }
    }

    #[test]
    fn a_step_is_judged_again_while_scans_follow_once_enough_has_been_seen() {
        let settings = Settings::default();
        let mut early = walk_that_slipped();
        early.keyframes.truncate(14);
        early.edges.truncate(13);
        assert!(early.judge_steps(&settings).is_empty(), "too little was seen");
        let mut atlas = walk_that_slipped();
        assert_eq!(atlas.judge_steps(&settings), [6]);
        let off_m = atlas.pose(15).distance(Pose::new(8.0, 0.2, 0.0));
        assert!(off_m < 0.05, "{off_m}");
        assert!(atlas.has_moved && atlas.judge_steps(&settings).is_empty());
    }
}
