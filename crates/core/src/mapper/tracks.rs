//! Which accounts of the motion are carried on.
//!
//! In: the tracks, and what each of them says of the next scan. Out: the ways on, best first. A track branches when two
//! places explain the scan nearly as well, or when the best one explains it so poorly that it may be somewhere else;
//! it ends when another has explained the scans since clearly better.

use super::track::{Track, Way};
use crate::place::{Answer, Placement};

/// A place is carried as an alternative when its merit comes so near the best one.
const BRANCH_WITHIN: f64 = 0.25;
/// A track ends when its merit lags so far behind the best one's.
const END_BEHIND: f64 = 0.40;
/// Tracks at the most.
const MOST: usize = 6;
/// After so many scans without decision, the best track is taken.
const DECIDE_AFTER_SCANS: usize = 20;
/// Merit of a scan that is kept apart: a place that explains it worse is doubted.
const APART_MERIT: f64 = 0.1;
/// What a scan's merit in a map of its own is too high by: there is less in it that could contradict.
const FLATTERY: f64 = 0.15;

/// How a track goes on.
#[derive(Clone, Copy)]
pub(super) struct Onward {
    /// Which of the tracks.
    pub track: usize,
    /// Where.
    pub way: Way,
    /// Merit with this scan.
    pub merit: f64,
    /// Whether it is the best of them.
    pub leads: bool,
}

/// How the tracks go on, best first; `answers` has one for each track, and `backs` what the maps say that were left.
pub(super) fn onward(
    tracks: &[Track],
    answers: &[Answer],
    backs: &[Option<(usize, Answer)>],
    scans_undecided: usize,
) -> Vec<Onward> {
    let mut all: Vec<Onward> = Vec::new();
    let best_merit = |a: &Answer| a.believed.first().map_or(f64::NEG_INFINITY, |b| b.merit);
    // A map of its own has no errors yet and flatters every scan: it is for when no track has a good place.
    let is_poor = answers.iter().all(|a| best_merit(a) < APART_MERIT);
    for (track, answer) in answers.iter().enumerate() {
        let flattery = if tracks[track].is_apart() { FLATTERY } else { 0.0 };
        let before = tracks[track].merit - flattery;
        let mut add = |way, merit| {
            all.push(Onward {
                track,
                way,
                merit: before + merit,
                leads: false,
            });
        };
        let Some(best) = answer.believed.first().map(|b| b.merit) else {
            if tracks[track].is_empty() {
                add(Way::On(None), 0.0);
            } else if let Some((k, p)) = backs[track].as_ref().and_then(|(k, a)| Some((*k, a.placement?))) {
                add(Way::Back(k, p), p.merit);
            } else if is_poor {
                add(Way::Apart, APART_MERIT);
            }
            continue;
        };
        for p in answer.believed.iter().filter(|b| b.merit > best - BRANCH_WITHIN) {
            add(Way::On(Some(*p)), p.merit);
        }
        if is_poor && track == 0 {
            add(Way::Apart, APART_MERIT);
        }
    }
    kept(
        all,
        if scans_undecided > DECIDE_AFTER_SCANS {
            1
        } else {
            MOST
        },
    )
}

/// The best ways, each to another place.
fn kept(mut all: Vec<Onward>, most: usize) -> Vec<Onward> {
    all.sort_by(|a, b| b.merit.total_cmp(&a.merit));
    let best = all.first().map_or(0.0, |o| o.merit);
    let mut kept: Vec<Onward> = Vec::new();
    for o in all {
        let is_new = !kept.iter().any(|k| is_same(k, &o));
        if o.merit > best - END_BEHIND && is_new && kept.len() < most {
            kept.push(Onward {
                leads: kept.is_empty(),
                ..o
            });
        }
    }
    kept
}

/// Whether two ways on have come to the same place: they differ only in how they came to it.
fn is_same(a: &Onward, b: &Onward) -> bool {
    match (a.way, b.way) {
        (Way::On(Some(a)), Way::On(Some(b))) => is_near(&a, &b),
        _ => false,
    }
}

fn is_near(a: &Placement, b: &Placement) -> bool {
    let (a, b) = (a.alignment.map_from_scan, b.alignment.map_from_scan);
    a.is_within(0.15, 0.05, b)
}
