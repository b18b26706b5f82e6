//! Maps that were left when the scanner was lost, and how the present one is found in them.
//!
//! In: the keyframes of the present map. Out: an edge that ties it to the one that was left, when its scans fit there
//! in exactly one way: first where the scanner was lost, then at the one place in all of the map that the keyframes of the last
//! metres agree on ([`anywhere`]). It should have begun where the other ended, for a corridor looks like the next, and like itself when
//! it is turned round; if it did not (somebody carried the scanner), more of it must fit, and hardly a scan may see other walls.

mod anywhere;

use super::Settings;
use super::atlas::{Atlas, LOST_M, LOST_RAD};
use crate::geometry::Pose;
use crate::keyframe::Keyframe;
use crate::locate::votes::Choice;
use crate::loops::graph::Edge;
use crate::loops::{Drift, Lookup, find_in};
use crate::place::Motion;
use anywhere::Anywhere;

/// A map is looked for where it was left over so many keyframes, then elsewhere.
const LOOK_WHERE_LEFT: usize = 8;
/// How far from the place where it was left it may be, metres, and how much farther for every scan since.
const LEFT_WINDOW_M: f64 = 1.5;
const LEFT_WINDOW_PER_SCAN_M: f64 = 0.5;
/// Half the window around other places, metres.
const OTHER_WINDOW_M: f64 = 4.0;
/// Way that is compared there, metres: a few metres of corridor look like those of any other, and a map joined at the wrong
/// place is worse than one kept apart.
const OTHER_STRETCH_M: f64 = 8.0;
/// Way that is compared when it is there, metres. So much of a building tells where it is by itself, even if somebody carried
/// the scanner; and so does a map that was left which is compared as a whole.
const LONG_STRETCH_M: f64 = 20.0;
/// Share of the scans that may then see other walls than the map that was left has. (A corridor that had not been seen before was
/// taken for another one, 105 m off: 20 m of it fitted, but one scan in five saw other walls.)
const MOST_DISAGREEING: f64 = 0.1;
/// A map begins where the one before ended: how far off its first scan may be, metres and radians, and how much farther
/// for every metre of its own way.
const BEGUN_M: f64 = 4.0;
const BEGUN_RAD: f64 = 1.2;
const BEGUN_PER_M: f64 = 0.03;
/// The scans put the scanner less far from where the votes do than this, metres and radians.
const AGREE_M: f64 = 1.0;
const AGREE_RAD: f64 = 0.15;
/// A smaller map is not looked for.
const LEAST_KEYFRAMES: usize = 3;

/// A map that was left, and the motion when it was.
#[derive(Clone)]
pub(super) struct Left {
    pub motion: Motion,
    pub atlas: Atlas,
    /// Scans since.
    pub scans: u32,
    /// Keyframes since.
    pub keyframes: usize,
    /// The present map's number, and what was made to look for it in all of this one.
    anywhere: Option<(u32, Anywhere)>,
}

impl Left {
    /// A map that is left now.
    pub fn now(motion: Motion, atlas: Atlas) -> Self {
        Self {
            motion,
            atlas,
            scans: 1,
            keyframes: 0,
            anywhere: None,
        }
    }

    /// Whether a single scan may lead back into it: no longer than the scanner is looked for where it was left. After that it may be
    /// anywhere, and only its new map as a whole tells where. (A map of 37 right keyframes was given up for one scan that
    /// fitted a map left 75 scans before: 13 m off in a simulated warehouse.)
    pub fn is_near(&self) -> bool {
        self.keyframes <= LOOK_WHERE_LEFT
    }

    /// Adjusts its poses and walls together. Returns the scans that were placed again.
    pub fn settle(&mut self, settings: &Settings) -> Vec<usize> {
        let (moved, placed_again) = self.atlas.settle(settings);
        self.motion.map_from_scan = moved * self.motion.map_from_scan;
        self.anywhere = None;
        placed_again
    }

    /// Makes its keyframes straight again.
    pub fn straighten(&mut self, share: f64, settings: &Settings) {
        self.atlas.straighten(share, settings);
        self.anywhere = None;
    }

    /// Looks for the present map in this one.
    pub fn find(&mut self, present: &Atlas, settings: &Settings) -> Option<Edge> {
        let new = present.keyframes();
        let newest = new.len().checked_sub(1).filter(|&newest| newest > 0)?;
        if self.atlas.keyframes().len() < LEAST_KEYFRAMES {
            return None;
        }
        if newest <= LOOK_WHERE_LEFT {
            let lookup = self.where_left(new, settings);
            let edge = find_in(&lookup, &settings.align, &settings.recognise)?;
            let old_from_new = self.old_from_new(&edge, new);
            return self.begins_here(old_from_new, new).then_some(edge);
        }
        self.elsewhere(present, settings)
    }

    /// The first keyframe of the present map, about where the scanner would be if it had gone on.
    fn where_left<'a>(&'a self, new: &'a [Keyframe], settings: &Settings) -> Lookup<'a> {
        let old = self.atlas.keyframes();
        let window_m = LEFT_WINDOW_M + LEFT_WINDOW_PER_SCAN_M * f64::from(self.scans).min(8.0);
        Lookup {
            old,
            at: old.len() - 1,
            new,
            anchor: 0,
            centre: self.motion.predicted().map_from_scan,
            drift: Drift::lost(LOST_M, LOST_RAD, window_m),
            stretch_m: settings.recognise.stretch_m,
        }
    }

    /// The place that the last keyframes agree on, if their scans fit there together.
    fn elsewhere(&mut self, present: &Atlas, settings: &Settings) -> Option<Edge> {
        let new = present.keyframes();
        if new[new.len() - 1].way_m < OTHER_STRETCH_M.min(self.way_m()) {
            return None;
        }
        if self.anywhere.as_ref().is_none_or(|(id, _)| *id != present.id) {
            self.anywhere = Some((present.id, Anywhere::of(&self.atlas, settings)));
        }
        let (_, anywhere) = self.anywhere.as_mut()?;
        let choice = anywhere.look(new)?;
        let lookup = self.at_choice(&choice, new)?;
        let edge = find_in(&lookup, &settings.align, &settings.recognise)?;
        let (voted, found) = (lookup.centre, self.atlas.pose(edge.from) * edge.motion);
        let agrees = found.is_within(AGREE_M, AGREE_RAD, voted);
        agrees.then_some(edge)
    }

    /// What has to fit for the present map to be where its keyframes say: the newest of them that is sure of it, and
    /// the way around. `None` while there is too little, or while too much speaks against it.
    fn at_choice<'a>(&'a self, choice: &Choice, new: &'a [Keyframe]) -> Option<Lookup<'a>> {
        let old = self.atlas.keyframes();
        let begins_here = self.begins_here(choice.first_from_second, new);
        let stretch_m = if begins_here {
            OTHER_STRETCH_M
        } else {
            LONG_STRETCH_M
        };
        // No farther than the map that was left goes.
        let stretch_m = stretch_m.min(self.way_m());
        let anchor = choice.agreeing.last()?.keyframe;
        let is_doubtful = !begins_here && choice.disagreeing_share > MOST_DISAGREEING;
        if is_doubtful || new[anchor].way_m < stretch_m {
            return None;
        }
        let centre = choice.first_from_second * new[anchor].map_from_scan;
        let distance = |k: &usize| old[*k].map_from_scan.distance(centre);
        let at = (0..old.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        Some(Lookup {
            old,
            at,
            new,
            anchor,
            centre,
            drift: Drift::anywhere(OTHER_WINDOW_M),
            stretch_m,
        })
    }

    /// How long the way through it is, metres.
    fn way_m(&self) -> f64 {
        self.atlas.keyframes().last().map_or(0.0, |k| k.way_m)
    }

    fn old_from_new(&self, edge: &Edge, new: &[Keyframe]) -> Pose {
        self.atlas.pose(edge.from) * edge.motion * new[edge.to].map_from_scan.inverse()
    }

    /// Whether the present map, placed so in this one, begins where this one was left.
    fn begins_here(&self, old_from_new: Pose, new: &[Keyframe]) -> bool {
        let (first, newest) = (&new[0], &new[new.len() - 1]);
        let begun = old_from_new * first.map_from_scan;
        let left = self.motion.predicted().map_from_scan;
        let drift = BEGUN_PER_M * newest.way_m;
        begun.is_within(BEGUN_M + drift, BEGUN_RAD + 0.1 * drift, left)
    }
}
