//! What has been mapped so far: keyframes, what ties them together, and the part of the map around.
//!
//! The map is a function of the keyframes and their poses. The part of it that the next scan is matched with (the
//! paper's G(t−1), as far as it agrees with itself) is kept up to date scan by scan, so that it holds only keyframes
//! between which little drift has gathered ([`local`]). The map of all keyframes is made when it is asked for.

mod edges;
mod enough;
mod local;
pub(super) mod loose;
mod saved;
mod settle;
mod shown;
mod straighten;

use super::{Revoked, Settings, Step};
use edges::{doubted, edge_to_next, is_doubtful, loosened};
use enough::needed;
use local::Local;
use std::sync::Arc;

use crate::align::Information;
use crate::geometry::{Point, Pose};
use crate::keyframe::{Keyframe, Seen, middle_of};
use crate::loops::graph::{Edge, contradicted, optimise};
use crate::loops::ways::{ways, ways_m};
use crate::loops::{Recognised, recognise, ties};
use crate::map::Map;
use crate::merge::eraser::{boxes, disordered_runs};
use crate::merge::finish::finish;
use crate::merge::growing_map::GrowingMap;
use crate::merge::moving::find_moving;

/// Keyframes within this way along the graph are within reach of the map around, metres. Drift stays below the gate of merging.
const LOCAL_M: f64 = 12.0;
/// Way after which the map around is brought up to where the scanner is, metres.
const RENEW_AFTER_M: f64 = 6.0;
/// A keyframe to which the way has become longer than this, metres, does not stay in the map around, unless it is as far
/// off as the crow flies.
const DRIFTED_M: f64 = LOCAL_M + RENEW_AFTER_M;
/// Way between two looks for a known place, metres.
const LOOK_AFTER_M: f64 = 1.0;

/// Way between two ties to an earlier visit, and how near the middles of what both saw must be, metres.
const TIE_AFTER_M: f64 = 1.0;
const TIE_WITHIN_M: f64 = 3.0;
/// What a tie is less certain by than its walls say, metres and radians: the map has errors of its own.
const TIE_SIGMA_M: f64 = 0.03;
const TIE_SIGMA_RAD: f64 = 0.003;

/// Two closures within a few metres of each other agree when they differ by less than this, metres.
const AGREE_M: f64 = 0.4;
/// Closures that ask for more drift than is usual must agree over this way, metres: one that looks alike slides along.
const CONFIRM_FAR_M: f64 = 4.0;

/// How far somebody goes and turns while he is lost: standard deviations, metres and radians.
pub(super) const LOST_M: f64 = 1.5;
pub(super) const LOST_RAD: f64 = 0.6;

/// A scan is merged when the scanner has moved or turned so far since the last merged one (metres, radians), ...
const KEYFRAME_M: f64 = 0.25;
const KEYFRAME_RAD: f64 = 0.17;
/// ... when the map says nothing about so many of its beams, ...
const KEYFRAME_NEW_SHARE: f64 = 0.2;
/// ... and after so many scans in any case: standing still gathers evidence, too.
const KEYFRAME_SCANS: usize = 10;

/// See the module.
#[derive(Clone, Default)]
pub(crate) struct Atlas {
    /// Number of this map among those of a track.
    pub id: u32,
    keyframes: Vec<Keyframe>,
    edges: Vec<Edge>,
    local: Local,
    /// Closures that agree with each other and wait for another to agree with them.
    waiting: Vec<Edge>,
    /// Something that was merged with this keyframe, or later, has moved since.
    stale_from: Option<usize>,
    /// Poses have moved since the map around was made.
    has_moved: bool,
    /// Keyframes within reach when the map around was last brought up to where the scanner is, ascending.
    around: Vec<usize>,
    /// Way since the newest keyframe was last tied to an old one, metres.
    untied_m: f64,
    /// Way since the map around was brought up to where the scanner is, and since the last look for a known place, metres.
    unrenewed_m: f64,
    unlooked_m: f64,
    /// The first keyframe whose step is still to be judged by what was seen on both sides of it.
    unjudged_from: usize,
}

impl Atlas {
    /// An empty map with a number of its own.
    pub fn numbered(id: u32) -> Self {
        Self {
            id,
            ..Self::default()
        }
    }

    /// The part of the map around.
    pub fn local(&self) -> &GrowingMap {
        self.local.map()
    }

    /// The polylines of it that the last scan was merged into, by slot.
    pub fn merged_into(&self) -> &[u32] {
        self.local.merged_into()
    }

    /// The keyframes, oldest first.
    pub fn keyframes(&self) -> &[Keyframe] {
        &self.keyframes
    }

    /// Takes in another map, tied to this one by `edge` (from a keyframe of this map to one of the other); its first
    /// keyframe was expected at `begun`, give or take the way of somebody who is lost. Returns the motion of the other map's
    /// frame into this one's, by its newest keyframe, and the number that its first keyframe gets.
    pub fn absorb(&mut self, other: Self, edge: Edge, begun: Pose, settings: &Settings) -> (Pose, usize) {
        let here_from_other = self.pose(edge.from) * edge.motion * other.pose(edge.to).inverse();
        let (last, last_pose) = self.newest();
        let (_, other_newest) = other.newest();
        let offset = self.append(other, here_from_other, 0);
        self.edges.push(Edge {
            from: last,
            to: offset,
            motion: last_pose.inverse() * begun,
            information: Information::from_sigmas(LOST_M, LOST_M, LOST_RAD),
            is_loop: true,
        });
        self.edges.push(Edge {
            to: edge.to + offset,
            information: loosened(&edge.information),
            ..edge
        });
        self.waiting.clear();
        self.optimise();
        self.renew_local(settings);
        (self.newest().1 * other_newest.inverse(), offset)
    }

    /// Number and pose of the newest keyframe; the map's frame when there is none.
    pub fn newest(&self) -> (usize, Pose) {
        let number = self.keyframes.len().saturating_sub(1);
        (number, self.pose(number))
    }

    /// Pose of a keyframe.
    pub fn pose(&self, keyframe: usize) -> Pose {
        self.keyframes
            .get(keyframe)
            .map_or(Pose::IDENTITY, |k| k.map_from_scan)
    }

    /// Poses of all keyframes.
    fn poses(&self) -> Vec<Pose> {
        self.keyframes.iter().map(|k| k.map_from_scan).collect()
    }

    /// Whether a scan at `pose` shall be merged.
    pub fn wants(&self, pose: Pose, step: &Step) -> bool {
        let Some(keyframe) = self.keyframes.last() else {
            return true;
        };
        let last = keyframe.map_from_scan;
        let new_share = step.agreement.map_or(1.0, |a| 1.0 - a.known_share());
        !last.is_within(KEYFRAME_M, KEYFRAME_RAD, pose)
            || new_share > KEYFRAME_NEW_SHARE
            || step.scan - keyframe.number >= KEYFRAME_SCANS
    }

    /// Takes a scan in: moving objects are found, the rest is merged.
    /// `speed` is the motion from scan to scan.
    pub fn add_keyframe(
        &mut self,
        step: &mut Step,
        seen: &Seen,
        pose: Pose,
        speed: Pose,
        settings: &Settings,
    ) {
        if let Some(last) = self.keyframes.last() {
            let from = self.keyframes.len() - 1;
            let edge = edge_to_next(from, last.map_from_scan, pose, step.alignment.as_ref());
            let edge = doubted(edge, last.map_from_scan, pose, step, &settings.place);
            let way_m = edge.motion.translation().norm();
            self.unrenewed_m += way_m;
            self.unlooked_m += way_m;
            self.untied_m += way_m;
            self.edges.push(edge);
        }
        let way_m = self
            .keyframes
            .last()
            .map_or(0.0, |k| k.way_m + k.map_from_scan.distance(pose));
        self.keyframes.push(Keyframe {
            way_m,
            number: step.scan,
            scan: Arc::new(seen.scan.clone()),
            is_moving: vec![false; seen.extraction.polylines.len()],
            extraction: Arc::clone(&seen.extraction),
            points: Arc::clone(&seen.points),
            middle: middle_of(&seen.points),
            disordered_runs: disordered_runs(seen.scan, seen.extraction.noise_m, &settings.eraser).into(),
            is_doubtful: is_doubtful(step),
            step: speed,
            map_from_scan: pose,
        });
        self.tie(step);
        self.take_moving_out(step, settings);
        let newest = self.keyframes.len() - 1;
        step.merged = Some(self.local.add(&self.keyframes, newest, settings));
    }

    /// Ties the newest keyframe to an old one: where the map around holds an earlier visit, the scan was aligned to that
    /// as well, and when poses move later the two visits must stay together.
    fn tie(&mut self, step: &Step) {
        let newest = self.keyframes.len() - 1;
        let Some(alignment) = step.alignment.filter(|_| self.untied_m > TIE_AFTER_M) else {
            return;
        };
        let here = self.keyframes[newest].seen_around();
        let old = self
            .around
            .iter()
            .filter(|&&k| self.keyframes[newest].way_m - self.keyframes[k].way_m > 2.0 * LOCAL_M)
            .map(|&k| (k, self.keyframes[k].seen_around().distance(here)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((old, _)) = old.filter(|o| o.1 < TIE_WITHIN_M) else {
            return;
        };
        let from = self.keyframes[old].map_from_scan;
        self.untied_m = 0.0;
        self.edges.push(Edge {
            from: old,
            to: newest,
            motion: from.inverse() * self.keyframes[newest].map_from_scan,
            information: alignment
                .information
                .turned(-from.theta_rad)
                .with_noise(TIE_SIGMA_M, TIE_SIGMA_RAD),
            is_loop: true,
        });
    }

    fn take_moving_out(&mut self, step: &mut Step, settings: &Settings) {
        let newest = self.keyframes.len() - 1;
        for (keyframe, polyline) in find_moving(&self.keyframes, self.local.map(), &settings.moving) {
            self.keyframes[keyframe].is_moving[polyline] = true;
            if keyframe == newest {
                step.moving.push(polyline);
            } else {
                let first = self.stale_from.map_or(keyframe, |first| first.min(keyframe));
                self.stale_from = Some(first);
            }
        }
    }

    /// Judges steps again of which enough has been seen on both sides, looks for a known place, moves the keyframes if
    /// a step was another one or a place is found, and makes the map around anew when it is due. Returns the motion of
    /// the map frame that the newest keyframe has made.
    pub fn close_loops(&mut self, step: &mut Step, settings: &Settings) -> Pose {
        let (newest, before) = self.newest();
        step.made_again = self.judge_steps(settings);
        let mut is_closed = false;
        if self.unlooked_m > LOOK_AFTER_M {
            self.unlooked_m = 0.0;
            if let Some(found) = self.known_place(settings) {
                is_closed = self.close(found, settings);
                if is_closed {
                    step.recognised = Some(self.keyframes[found.edge.from].number);
                    step.revoked = self.revoke();
                }
            }
        }
        if is_closed || self.has_moved {
            self.renew_local(settings);
        }
        if let Some(first) = self.stale_from.take() {
            self.local.merge_again(&self.keyframes, first, settings);
        }
        if self.unrenewed_m > RENEW_AFTER_M {
            self.follow_local(settings);
        }
        self.pose(newest) * before.inverse()
    }

    /// Takes a closure into the graph, at once if it moves things little, else when others agree with it.
    /// Returns whether poses moved.
    fn close(&mut self, found: Recognised, settings: &Settings) -> bool {
        let Recognised { edge, is_far } = found;
        if self
            .waiting
            .iter()
            .any(|w| self.disagreement_m(w, &edge) > AGREE_M)
        {
            self.waiting.clear();
        }
        self.waiting.push(edge);
        let is_near = self.jump_m(&edge) <= settings.recognise.confirm_beyond_m;
        let first_m = self.keyframes[self.waiting[0].to].way_m;
        let way_m = self.keyframes[edge.to].way_m - first_m;
        let is_confirmed = self.waiting.len() > 1 && (!is_far || way_m >= CONFIRM_FAR_M);
        if !is_confirmed && (is_far || !is_near) {
            return false;
        }
        self.edges.append(&mut self.waiting);
        self.optimise();
        self.tie_visits(settings);
        true
    }

    /// Takes closures out of the graph that all the others contradict.
    pub fn revoke(&mut self) -> Vec<Revoked> {
        let poses = self.poses();
        let contradicted = contradicted(&poses, &self.edges);
        let told = |&k: &usize| {
            let edge = &self.edges[k];
            Revoked {
                scan: self.keyframes[edge.to].number,
                recognised: self.keyframes[edge.from].number,
                off_m: (poses[edge.from] * edge.motion).distance(poses[edge.to]),
                sigmas: edge.square(&poses).sqrt(),
            }
        };
        let revoked = contradicted.iter().map(told).collect();
        for &k in contradicted.iter().rev() {
            self.edges.remove(k);
        }
        if !contradicted.is_empty() {
            self.optimise();
        }
        revoked
    }

    /// Ties the keyframes of the last metres to the earlier visit of the place that was recognised.
    fn tie_visits(&mut self, settings: &Settings) {
        let newest_m = self.keyframes.last().map_or(0.0, |k| k.way_m);
        let ways = self.ways_around();
        let (mut earlier, mut newer) = (within(&ways, LOCAL_M), Vec::new());
        let mut tied_m = f64::INFINITY;
        for &k in earlier.iter().rev() {
            let way_m = self.keyframes[k].way_m;
            if newest_m - way_m < LOCAL_M && tied_m - way_m > TIE_AFTER_M {
                newer.push(k);
                tied_m = way_m;
            }
        }
        earlier.retain(|&k| newest_m - self.keyframes[k].way_m > 2.0 * LOCAL_M);
        let earlier = needed(&self.keyframes, &[], &earlier, &ways);
        let ties = ties(&self.keyframes, &earlier, &newer, &settings.align);
        if !ties.is_empty() {
            self.edges.extend(ties.into_iter().map(|tie| Edge {
                information: tie.information.with_noise(TIE_SIGMA_M, TIE_SIGMA_RAD),
                ..tie
            }));
            self.optimise();
        }
    }

    /// How far a closure would move its newer keyframe, metres.
    fn jump_m(&self, edge: &Edge) -> f64 {
        (self.pose(edge.from) * edge.motion).distance(self.pose(edge.to))
    }

    /// How far apart two closures would put the newer keyframe, metres.
    fn disagreement_m(&self, a: &Edge, b: &Edge) -> f64 {
        let by_a = self.pose(a.from) * a.motion * self.pose(a.to).inverse() * self.pose(b.to);
        by_a.distance(self.pose(b.from) * b.motion)
    }

    fn known_place(&self, settings: &Settings) -> Option<Recognised> {
        let newest = self.keyframes.len() - 1;
        let ways = ways(&self.places(), &self.edges, newest, f64::INFINITY);
        let found = recognise(
            &self.keyframes,
            &ways,
            2.0 * LOCAL_M,
            &settings.align,
            &settings.recognise,
        )?;
        let information = loosened(&found.edge.information);
        Some(Recognised {
            edge: Edge {
                information,
                ..found.edge
            },
            ..found
        })
    }

    /// Moves the keyframes so that they agree with all edges.
    pub fn optimise(&mut self) {
        let mut poses = self.poses();
        optimise(&mut poses, &self.edges);
        for (keyframe, pose) in self.keyframes.iter_mut().zip(poses) {
            keyframe.map_from_scan = pose;
        }
    }

    /// Makes the map around anew.
    fn renew_local(&mut self, settings: &Settings) {
        let ways = self.ways_around();
        self.around = within(&ways, LOCAL_M);
        let needed = needed(&self.keyframes, &[], &self.around, &ways);
        self.local.renew(&self.keyframes, &needed, settings);
        self.unrenewed_m = 0.0;
        self.stale_from = None;
        self.has_moved = false;
    }

    /// Brings the map around up to where the scanner is now.
    fn follow_local(&mut self, settings: &Settings) {
        let (newest, here) = self.newest();
        let ways = ways_m(&self.places(), &self.edges, newest, DRIFTED_M);
        let has_drifted = |&k: &usize| ways[k].is_none() && self.pose(k).distance(here) < DRIFTED_M;
        if self.local.order().iter().any(has_drifted) {
            self.renew_local(settings);
            return;
        }
        self.around = within(&ways, LOCAL_M);
        let needed = needed(&self.keyframes, self.local.order(), &self.around, &ways);
        self.local.take_in(&self.keyframes, &needed, settings);
        self.unrenewed_m = 0.0;
    }

    /// The ways to the keyframes within reach of the newest.
    fn ways_around(&self) -> Vec<Option<f64>> {
        let newest = self.keyframes.len() - 1;
        ways_m(&self.places(), &self.edges, newest, LOCAL_M)
    }

    fn places(&self) -> Vec<Point> {
        self.keyframes
            .iter()
            .map(|k| k.map_from_scan.translation())
            .collect()
    }

    /// The map of all keyframes, after the final pass.
    pub fn map(&self, settings: &Settings) -> Map {
        finish(
            &self.keyframes,
            boxes(&self.keyframes, &settings.eraser),
            &settings.merge,
        )
    }
}

/// Keyframes to which the way is no longer than `limit_m`, ascending.
fn within(ways_m: &[Option<f64>], limit_m: f64) -> Vec<usize> {
    let is_within = |way: &Option<f64>| way.is_some_and(|m| m <= limit_m);
    (0..ways_m.len()).filter(|&k| is_within(&ways_m[k])).collect()
}
