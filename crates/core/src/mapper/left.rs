//! Maps that were left when the scanner was lost, and how the present one is found in them.
//!
//! In: the keyframes of the present map. Out: an edge that ties it to the one that was left, when its scans fit there
//! in exactly one way: first where the scanner was lost, then at one other place a keyframe. Wherever it is found, it must
//! have begun where the other ended: a corridor looks like the next, and like itself when it is turned round.

use super::Settings;
use super::atlas::Atlas;
use crate::geometry::{Pose, wrap_rad};
use crate::keyframe::Keyframe;
use crate::loops::graph::Edge;
use crate::loops::{Lookup, find_in};
use crate::place::Motion;

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
/// A map begins where the one before ended: how far off its first scan may be, metres and radians, and how much farther
/// for every metre of its own way.
const BEGUN_M: f64 = 4.0;
const BEGUN_RAD: f64 = 1.2;
const BEGUN_PER_M: f64 = 0.03;
/// Two places in a row agree when they put the scanner less far apart than this, metres and radians.
const AGREE_M: f64 = 0.5;
const AGREE_RAD: f64 = 0.1;
/// A smaller map is not looked for.
const LEAST_KEYFRAMES: usize = 3;
/// Keyframes between two places that are looked at.
const CURSOR_STEP: usize = 3;

/// A map that was left, and the motion when it was.
#[derive(Clone)]
pub(super) struct Left {
    pub motion: Motion,
    pub atlas: Atlas,
    /// Scans since.
    pub scans: u32,
    /// The keyframe where it is looked for next.
    cursor: usize,
    /// Pose of the present map in this one, by a place that waits for another to agree.
    waiting: Option<Pose>,
}

impl Left {
    /// A map that is left now.
    pub fn now(motion: Motion, atlas: Atlas) -> Self {
        Self {
            motion,
            atlas,
            scans: 1,
            cursor: 0,
            waiting: None,
        }
    }

    /// Adjusts its poses and walls together. Returns the scans that were placed again.
    pub fn settle(&mut self, settings: &Settings) -> Vec<usize> {
        let (moved, placed_again) = self.atlas.settle(settings);
        self.motion.map_from_scan = moved * self.motion.map_from_scan;
        placed_again
    }

    /// Looks for the present map, whose keyframes are `new`, in this one.
    pub fn find(&mut self, new: &[Keyframe], settings: &Settings) -> Option<Edge> {
        let old = self.atlas.keyframes();
        let newest = new.len().checked_sub(1).filter(|&newest| newest > 0)?;
        if old.len() < LEAST_KEYFRAMES {
            return None;
        }
        let is_where_left = newest <= LOOK_WHERE_LEFT;
        let lookup = if is_where_left {
            self.where_left(new, settings)
        } else {
            self.elsewhere(new)?
        };
        let Some(edge) = find_in(&lookup, &settings.align, &settings.recognise) else {
            self.cursor = (self.cursor + CURSOR_STEP) % old.len();
            return None;
        };
        let old_from_new = old[edge.from].map_from_scan * edge.motion * new[edge.to].map_from_scan.inverse();
        let is_whole = old[old.len() - 1].way_m <= OTHER_STRETCH_M;
        let is_sure = is_where_left || self.is_confirmed(old_from_new, new[edge.to].map_from_scan);
        let is_possible =
            self.begins_here(old_from_new, new) || new[newest].way_m >= LONG_STRETCH_M || is_whole;
        if !is_possible {
            // A place that looks alike: the next one may be it.
            self.cursor = (self.cursor + CURSOR_STEP) % self.atlas.keyframes().len();
        }
        (is_sure && is_possible).then_some(edge)
    }

    /// The first keyframe of the present map, about where the scanner would be if it had gone on.
    fn where_left<'a>(&'a self, new: &'a [Keyframe], settings: &Settings) -> Lookup<'a> {
        let old = self.atlas.keyframes();
        Lookup {
            old,
            at: old.len() - 1,
            new,
            anchor: 0,
            centre: self.motion.predicted().map_from_scan,
            window_m: LEFT_WINDOW_M + LEFT_WINDOW_PER_SCAN_M * f64::from(self.scans).min(8.0),
            stretch_m: settings.recognise.stretch_m,
        }
    }

    /// The newest keyframe, at the next place; `None` until the present map is long enough.
    fn elsewhere<'a>(&'a self, new: &'a [Keyframe]) -> Option<Lookup<'a>> {
        let old = self.atlas.keyframes();
        let (tip, newest) = (old.len() - 1, new.len() - 1);
        let stretch_m = if new[newest].way_m >= LONG_STRETCH_M {
            LONG_STRETCH_M
        } else {
            OTHER_STRETCH_M
        };
        // No farther than the map that was left goes.
        let stretch_m = stretch_m.min(old[tip].way_m);
        let at = tip - self.cursor;
        (new[newest].way_m >= stretch_m).then_some(Lookup {
            old,
            at,
            new,
            anchor: newest,
            centre: old[at].map_from_scan,
            window_m: OTHER_WINDOW_M,
            stretch_m,
        })
    }

    /// Whether the present map, placed so in this one, begins where this one was left.
    fn begins_here(&self, old_from_new: Pose, new: &[Keyframe]) -> bool {
        let (first, newest) = (&new[0], &new[new.len() - 1]);
        let begun = old_from_new * first.map_from_scan;
        let left = self.motion.predicted().map_from_scan;
        let drift = BEGUN_PER_M * newest.way_m;
        begun.distance(left) < BEGUN_M + drift
            && wrap_rad(begun.theta_rad - left.theta_rad).abs() < BEGUN_RAD + 0.1 * drift
    }

    /// Whether the place before put the scanner, now at `new_from_scan` in the present map, at the same pose.
    fn is_confirmed(&mut self, old_from_new: Pose, new_from_scan: Pose) -> bool {
        let before = self.waiting.replace(old_from_new);
        before.is_some_and(|before| {
            let (a, b) = (before * new_from_scan, old_from_new * new_from_scan);
            a.distance(b) < AGREE_M && wrap_rad(a.theta_rad - b.theta_rad).abs() < AGREE_RAD
        })
    }
}
