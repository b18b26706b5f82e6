//! Where the present map lies in the whole of one that was left, by the votes of its keyframes.
//!
//! In: the keyframes of the present map as they come. Out: the one pose of it in the other map that most of the last of
//! them agree on. Every keyframe is looked for in all of the map that was left at once, by itself (`locate`), and votes as when
//! two finished maps are joined (`join`): enough must agree, no other place may have half as many votes, and few
//! of those that would see the map that was left may see other walls there.

use std::sync::Arc;

use crate::keyframe::Keyframe;
use crate::locate::votes::{Choice, Found, Trust, choose};
use crate::locate::{LocateSettings, Locator};
use crate::mapper::Settings;
use crate::mapper::atlas::Atlas;

/// Keyframes vote over this way, metres: those before are off by what the present map has drifted since (1 %), which is to be less
/// than votes may differ.
const VOTING_M: f64 = 50.0;
/// After this way a map is so large that a look takes longer than mapping a scan, metres: looks are then farther apart, at most
/// so many times, for the same work.
const LARGE_M: f64 = 400.0;
const MOST_SPACING: f64 = 2.0;
/// Poses that a keyframe is aligned at: three of them vote, and along a corridor the search for more takes most of the time.
const CANDIDATES: usize = 8;
/// Fewest keyframes that have to agree, if the map that was left is so short that there can be no more.
const LEAST_AGREEING: usize = 3;

/// A map that was left, made ready, and the keyframes of the present one that were looked for in it.
#[derive(Clone)]
pub(super) struct Anywhere {
    locator: Arc<Locator>,
    trust: Trust,
    /// How many times as far apart as usual keyframes are looked for.
    spacing: f64,
    looked: Vec<Found>,
}

impl Anywhere {
    /// Makes a map ready.
    pub fn of(atlas: &Atlas, settings: &Settings) -> Self {
        let sides = atlas.merged(settings).skeleton;
        let way_m = atlas.keyframes().last().map_or(0.0, |k| k.way_m);
        let most = LEAST_AGREEING.max(way_m as usize);
        let trust = Trust {
            least_agreeing: Trust::LEFT.least_agreeing.min(most),
            ..Trust::LEFT
        };
        let settings = LocateSettings {
            candidates: CANDIDATES,
            ..LocateSettings::default()
        };
        Self {
            trust,
            spacing: (way_m / LARGE_M).clamp(1.0, MOST_SPACING),
            locator: Arc::new(Locator::of_sides(sides, settings)),
            looked: Vec::new(),
        }
    }

    /// Looks for the keyframes that have come since. Returns where the present map lies in the one that was left, if the
    /// last of them agree on one place.
    pub fn look(&mut self, new: &[Keyframe]) -> Option<Choice> {
        let newest_m = new.last()?.way_m;
        let is_past = |k: &Keyframe| newest_m - k.way_m > VOTING_M;
        let next = self.looked.last().map_or(0, |last| last.keyframe() + 1);
        let next = next.max(new.partition_point(is_past));
        let mut has_looked = false;
        for k in next..new.len() {
            if self
                .looked
                .last()
                .is_none_or(|last| last.is_far(new, k, self.spacing))
            {
                self.looked.push(Found::of(&self.locator, new, k));
                has_looked = true;
            }
        }
        if !has_looked {
            return None;
        }
        let voting = self.looked.partition_point(|f| is_past(&new[f.keyframe()]));
        choose(&self.locator, &self.looked[voting..], new, self.trust).ok()
    }
}
