//! False closures put into the graph of a real map.
//!
//! In: a keyframe log with published poses. Out: how far the map is from those poses with and without false closures, and
//! how many of them were found out. Shared by a test and the example `false_closures`.

use std::path::Path;

use polymapper_core::geometry::Pose;
use polymapper_core::join::{SavedEdge, SavedMap};
use polymapper_core::mapper::{Mapper, Settings};
use polymapper_io::log::{self, Entry, LogError, ReadOptions};

/// A map of a log, settled, and the pose that the log has for each keyframe.
pub struct Built {
    pub saved: SavedMap,
    pub published: Vec<Pose>,
}

/// Maps a log of which every scan has a published pose.
pub fn built(path: &Path) -> Result<Built, LogError> {
    let mut mapper = Mapper::new(Settings::default());
    let mut poses = Vec::new();
    let options = ReadOptions {
        use_odometry: true,
        ..ReadOptions::default()
    };
    for entry in log::open(path, options)? {
        if let Entry::Scan(entry) = entry? {
            mapper.add_scan(&entry.scan, None);
            poses.push(entry.odometry.unwrap_or(Pose::IDENTITY));
        }
    }
    let mut saved = mapper.saved();
    saved.agree(&Settings::default());
    let published = saved.keyframes.iter().map(|k| poses[k.number]).collect();
    Ok(Built { saved, published })
}

/// Where the keyframes are when the false closures come in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Where the right closures have put them.
    Settled,
    /// Where the motion from one to the next has put them: no closure has been used yet.
    Drifted,
}

/// What false closures do to a map.
#[derive(Clone, Copy, Debug)]
pub struct Harm {
    /// Closures and ties in the map.
    pub right: usize,
    /// False ones put in, and how many of them were taken out again.
    pub injected: usize,
    pub revoked: usize,
    /// Right ones that were taken out.
    pub lost: usize,
    /// Mean error of the motion between any two keyframes, metres, without the false closures and with them.
    pub without_m: f64,
    pub with_m: f64,
    /// Mean shift of the keyframes by them, metres.
    pub shift_m: f64,
}

impl Harm {
    /// Change of the error, as a share.
    pub fn change(&self) -> f64 {
        self.with_m / self.without_m - 1.0
    }
}

/// Puts in false closures, `share` of the number of right ones, in runs of `run` that agree with each other.
pub fn inject(built: &Built, start: Start, share: f64, run: usize, seed: u64) -> Harm {
    let mut without = built.saved.clone();
    if start == Start::Drifted {
        drift(&mut without);
    }
    let loops: Vec<SavedEdge> = built.saved.edges.iter().filter(|e| e.is_loop).copied().collect();
    let wanted = (share * loops.len() as f64).round() as usize;
    let mut with = without.clone();
    with.edges
        .extend(false_closures(built, &loops, wanted, run, seed));
    let injected = with.edges.len() - built.saved.edges.len();
    with.agree(&Settings::default());
    without.agree(&Settings::default());
    let count = |map: &SavedMap, wrong: bool| {
        let is_such = |e: &&SavedEdge| e.is_loop && is_wrong(built, e) == wrong;
        map.edges.iter().filter(is_such).count()
    };
    let left = count(&with, true).saturating_sub(count(&without, true));
    let shifts = with.keyframes.iter().zip(&without.keyframes);
    let shift_m: f64 = shifts
        .map(|(a, b)| a.map_from_scan.distance(b.map_from_scan))
        .sum();
    Harm {
        right: loops.len(),
        injected,
        revoked: injected.saturating_sub(left),
        lost: count(&without, false).saturating_sub(count(&with, false)),
        without_m: error_m(&without, &built.published),
        with_m: error_m(&with, &built.published),
        shift_m: shift_m / built.published.len().max(1) as f64,
    }
}

/// Moves every keyframe to where the motion since the one before puts it.
fn drift(map: &mut SavedMap) {
    for to in 1..map.keyframes.len() {
        let step = map
            .edges
            .iter()
            .find(|e| !e.is_loop && e.to == to && e.from + 1 == to);
        let motion = step.map_or_else(
            || map.keyframes[to - 1].map_from_scan.inverse() * map.keyframes[to].map_from_scan,
            |e| e.motion,
        );
        // The pose before has been moved, the difference above is of poses before that.
        map.keyframes[to].map_from_scan = map.keyframes[to - 1].map_from_scan * motion;
    }
}

/// Closures between places that are truly ten metres apart and more. One in a run says by chance that the scanner stood
/// within a metre of the old place, in any heading; the others that it moved on from there as it did, as a corridor that looks
/// like another makes believe. They are as sure as a right one.
fn false_closures(
    built: &Built,
    right: &[SavedEdge],
    wanted: usize,
    run: usize,
    seed: u64,
) -> Vec<SavedEdge> {
    let mut dice = Dice(seed);
    let pose = |k: usize| built.saved.keyframes[k].map_from_scan;
    let count = built.saved.keyframes.len();
    let mut out = Vec::new();
    for _ in 0..1000 * (wanted + 1) {
        if out.len() >= wanted || right.is_empty() {
            break;
        }
        let (from, to) = (dice.below(count), dice.below(count));
        if from + run > to || to + run > count || built.published[from].distance(built.published[to]) < 10.0 {
            continue;
        }
        let motion = Pose::new(
            2.0 * dice.share() - 1.0,
            2.0 * dice.share() - 1.0,
            std::f64::consts::TAU * dice.share(),
        );
        let old_from_new = pose(from) * motion * pose(to).inverse();
        for k in 0..run.min(wanted - out.len()) {
            out.push(SavedEdge {
                from: from + k,
                to: to + k,
                motion: pose(from + k).inverse() * old_from_new * pose(to + k),
                information: right[dice.below(right.len())].information,
                is_loop: true,
            });
        }
    }
    out
}

/// Whether a closure is false by the published poses: more than two metres off.
fn is_wrong(built: &Built, edge: &SavedEdge) -> bool {
    let truly = built.published[edge.from].inverse() * built.published[edge.to];
    truly.distance(edge.motion) > 2.0
}

/// Mean error of the motion between any two keyframes (every so many, where there are very many), metres.
fn error_m(saved: &SavedMap, published: &[Pose]) -> f64 {
    let step = published.len().div_ceil(300).max(1);
    let chosen: Vec<usize> = (0..published.len()).step_by(step).collect();
    let pose = |k: usize| saved.keyframes[k].map_from_scan;
    let (mut sum_m, mut pairs) = (0.0, 0.0);
    for (n, &a) in chosen.iter().enumerate() {
        for &b in &chosen[n + 1..] {
            let truly = published[a].inverse() * published[b];
            sum_m += (pose(a).inverse() * pose(b)).distance(truly);
            pairs += 1.0;
        }
    }
    sum_m / f64::max(pairs, 1.0)
}

/// Marsaglia's xorshift (2003), the same on every platform.
struct Dice(u64);

impl Dice {
    fn share(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 * 0.5_f64.powi(53)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.share() * count as f64) as usize
    }
}
