//! Two maps joined by shape, and what must be kept of a map for that.
//!
//! In: two maps with their keyframes ([`SavedMap`]). Out: one map with all keyframes, or why they were not joined.
//!
//! 1. Keyframes of the second map, a metre and more apart, are looked for in the first one by themselves (`locate`); each
//!    pose found says where the second map would lie (`locate::votes`).
//! 2. The place that most keyframes agree on is taken if enough do, if few of those that see the first map there
//!    disagree, and if no other place has half as many. Maps of two houses agree by chance in a keyframe or
//!    two; a house with two equal wings is ambiguous.
//! 3. Keyframes that were found are tied to the first map, the poses adjusted (`loops`), then all along where both saw the
//!    same walls, and adjusted again. The map is made anew from all keyframes.

use crate::align::Information;
use crate::geometry::Pose;
use crate::locate::votes::{Found, Placed, Trust, choose, look};
use crate::locate::{LocateSettings, Locator};
use crate::loops::graph::Edge;
use crate::loops::ties;
use crate::map::Map;
use crate::mapper::atlas::Atlas;
use crate::mapper::{Revoked, Settings};
use crate::scan::Scan;

pub use crate::locate::votes::NotJoined;

/// A keyframe as it is kept.
#[derive(Clone, Debug)]
pub struct SavedKeyframe {
    /// Number of the scan in the log.
    pub number: usize,
    /// Its ranges.
    pub scan: Scan,
    /// Range noise that its polylines were extracted with, metres.
    pub noise_m: f64,
    /// Numbers of its polylines that belong to moving objects.
    pub moving: Vec<usize>,
    /// The scanner in the map.
    pub map_from_scan: Pose,
}

/// What is measured between two keyframes.
#[derive(Clone, Copy, Debug)]
pub struct SavedEdge {
    /// Keyframe, by its place among the keyframes.
    pub from: usize,
    /// The other one.
    pub to: usize,
    /// Pose of `to` seen from `from`.
    pub motion: Pose,
    /// Its information, axes of `from`.
    pub information: Information,
    /// Found by recognising a place.
    pub is_loop: bool,
}

/// What must be kept of a map so that it can be continued.
#[derive(Clone, Debug, Default)]
pub struct SavedMap {
    /// Scans that the map is made of, oldest first.
    pub keyframes: Vec<SavedKeyframe>,
    /// What holds them together.
    pub edges: Vec<SavedEdge>,
}

/// Two maps that have become one.
#[derive(Clone, Debug)]
pub struct Joined {
    /// The keyframes of both; those of the second come after, their scans counted on.
    pub saved: SavedMap,
    /// The map of all.
    pub map: Map,
    /// Keyframes that were found in the first map and agree.
    pub agreeing: usize,
    /// Keyframes of the second map that are tied to the first.
    pub tied: usize,
}

/// What the walls of a map know is worse than their noise says, metres and radians.
const FOUND_SIGMA_M: f64 = 0.02;
const FOUND_SIGMA_RAD: f64 = 0.005;
/// What a tie is less certain by than its walls say, metres and radians, as within a map.
const TIE_SIGMA_M: f64 = 0.03;
const TIE_SIGMA_RAD: f64 = 0.003;

impl SavedMap {
    /// The polygonal map.
    #[must_use]
    pub fn map(&self, settings: &Settings) -> Map {
        Atlas::restored(self, settings).map(settings)
    }

    /// Moves the keyframes so that they agree with all edges, and takes out the recognised places that all others contradict.
    /// Returns those.
    pub fn agree(&mut self, settings: &Settings) -> Vec<Revoked> {
        let mut atlas = Atlas::restored(self, settings);
        atlas.optimise();
        let revoked = atlas.revoke();
        *self = atlas.saved();
        revoked
    }

    /// Joins `second` to this map. `scans_before` is the number of scans of this map's log: those of the second are counted on.
    ///
    /// # Errors
    /// The maps have too little in common, contradict each other, or could be joined in more than one way.
    pub fn join(&self, second: &Self, scans_before: usize, settings: &Settings) -> Result<Joined, NotJoined> {
        if self.keyframes.is_empty() || second.keyframes.is_empty() {
            return Err(NotJoined::Empty);
        }
        let mut first = Atlas::restored(self, settings);
        let second = Atlas::restored(second, settings);
        let locator = Locator::new(&first.map(settings), LocateSettings::default());
        let looked: Vec<Found> = look(&locator, second.keyframes());
        let placed = choose(&locator, &looked, second.keyframes(), Trust::FINISHED)?;
        let agreeing = placed.agreeing.len();
        let offset = first.keyframes().len();
        let edges: Vec<Edge> = placed
            .agreeing
            .iter()
            .filter_map(|found| edge_to(&first, found, offset))
            .collect();
        first.append(second, placed.first_from_second, scans_before);
        first.tie_by(edges);
        first.optimise();
        let tied = tie_all_along(&mut first, offset, settings);
        first.settle(settings);
        Ok(Joined {
            map: first.map(settings),
            saved: first.saved(),
            agreeing,
            tied,
        })
    }
}

/// Ties a keyframe of the second map to the keyframe of the first that stood nearest.
fn edge_to(first: &Atlas, found: &Placed, offset: usize) -> Option<Edge> {
    let distance = |k: &usize| first.pose(*k).distance(found.map_from_scan);
    let from = (0..first.keyframes().len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    let map_from_old = first.pose(from);
    Some(Edge {
        from,
        to: offset + found.keyframe,
        motion: map_from_old.inverse() * found.map_from_scan,
        information: found
            .information
            .turned(-map_from_old.theta_rad)
            .with_noise(FOUND_SIGMA_M, FOUND_SIGMA_RAD),
        is_loop: true,
    })
}

/// Ties every keyframe of the second map that now lies on walls of the first. Returns how many.
fn tie_all_along(atlas: &mut Atlas, offset: usize, settings: &Settings) -> usize {
    let earlier: Vec<usize> = (0..offset).collect();
    let newer: Vec<usize> = (offset..atlas.keyframes().len()).collect();
    let found = ties(atlas.keyframes(), &earlier, &newer, &settings.align);
    let tied = found.len();
    atlas.tie_by(found.into_iter().map(|tie| Edge {
        information: tie.information.with_noise(TIE_SIGMA_M, TIE_SIGMA_RAD),
        ..tie
    }));
    atlas.optimise();
    tied
}
