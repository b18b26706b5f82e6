//! Which accounts of the motion are carried on.
//!
//! In: the tracks, and what each of them says of the next scan. Out: the tracks after it, best first. A track branches
//! when two places explain the scan nearly as well, and ends when another has explained the scans since clearly better.

use super::track::Track;
use crate::geometry::wrap_rad;
use crate::place::{Answer, Placement};

/// A place is carried as an alternative when its merit comes so near the best one.
const BRANCH_WITHIN: f64 = 0.25;
/// A track ends when its merit lags so far behind the best one's.
const END_BEHIND: f64 = 0.40;
/// Tracks at the most.
const MOST: usize = 4;
/// After so many scans without decision, the best track is taken.
const DECIDE_AFTER_SCANS: usize = 12;
/// Merit of a scan without a place.
const LOST_MERIT: f64 = 0.1;

/// How a track goes on.
#[derive(Clone, Copy)]
pub(super) struct Onward {
    /// Which of the tracks.
    pub track: usize,
    /// `None`: the scan has no place in it.
    pub placement: Option<Placement>,
    /// Merit with this scan.
    pub merit: f64,
}

/// How the tracks go on, best first; `answers` has one for each track.
pub(super) fn onward(tracks: &[Track], answers: &[Answer], scans_undecided: usize) -> Vec<Onward> {
    let mut all: Vec<Onward> = Vec::new();
    for (track, answer) in answers.iter().enumerate() {
        let before = tracks[track].merit;
        let best = answer.believed.first().map(|b| b.merit);
        let alternatives = answer
            .believed
            .iter()
            .filter(|b| best.is_some_and(|best| b.merit > best - BRANCH_WITHIN));
        all.extend(alternatives.map(|p| Onward {
            track,
            placement: Some(*p),
            merit: before + p.merit,
        }));
        if best.is_none() {
            all.push(Onward {
                track,
                placement: None,
                merit: before + LOST_MERIT,
            });
        }
    }
    all.sort_by(|a, b| b.merit.total_cmp(&a.merit));
    let best = all.first().map_or(0.0, |o| o.merit);
    let most = if scans_undecided > DECIDE_AFTER_SCANS {
        1
    } else {
        MOST
    };
    let mut kept: Vec<Onward> = Vec::new();
    for o in all {
        let is_new = !kept.iter().any(|k| is_same(k, &o));
        if o.merit > best - END_BEHIND && is_new && kept.len() < most {
            kept.push(o);
        }
    }
    kept
}

/// Whether two ways on have come to the same place: they differ only in how they came to it.
fn is_same(a: &Onward, b: &Onward) -> bool {
    match (a.placement, b.placement) {
        (Some(a), Some(b)) => {
            let (a, b) = (a.alignment.map_from_scan, b.alignment.map_from_scan);
            a.distance(b) < 0.15 && wrap_rad(a.theta_rad - b.theta_rad).abs() < 0.05
        }
        (None, None) => a.track == b.track,
        _ => false,
    }
}
