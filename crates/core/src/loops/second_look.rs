//! A second look at the keyframes that the finished map contradicts.
//!
//! In: all keyframes. Out: the poses of those that have another place, and an edge that ties each to a keyframe that saw
//! the same. When a scan was placed, the map around was all there was to judge it by; a scan at the beginning of a corridor had nothing. In
//! the end what all others saw, before and after, tells how well it lies, and the few that lie worst are looked for anew.

use super::elsewhere::{WINDOW_M, is_elsewhere};
use super::graph::Edge;
use super::oddity::oddity;
use super::recognise::{Drift, Place, RecogniseSettings, View};
use crate::align::AlignSettings;
use crate::geometry::Pose;
use crate::keyframe::Keyframe;

/// Keyframes so near in the log do not bear witness: they may be wrong together.
const ACCOMPLICES: usize = 3;
/// Witnesses have seen the same: the middles of what they saw are nearer than this, metres. The most that are heard.
const SAME_VIEW_M: f64 = 6.0;
const MOST_WITNESSES: usize = 12;
/// No more than one keyframe in ten gets a second look. (In three logs, wrong ones were among the worst twelfth.)
const ONE_IN: usize = 10;
/// By how much it agrees better, [`Agreement::score`](crate::place::Agreement::score), at most 1.
const LEAST_GAIN: f64 = 0.1;

/// Gives the doubtful keyframes that lie wrong another place. Returns an edge to each (`to`) from one that saw the same.
pub(crate) fn place_again(
    keyframes: &mut [Keyframe],
    doubtful: &[usize],
    align: &AlignSettings,
    settings: &RecogniseSettings,
) -> Vec<Edge> {
    let mut worst: Vec<(f64, usize)> = doubtful
        .iter()
        .filter_map(|&k| Some((score_among_others(keyframes, k)?, k)))
        .collect();
    worst.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let few = keyframes.len().div_ceil(ONE_IN);
    let mut waiting: Vec<Edge> = worst
        .iter()
        .take(few)
        .filter(|w| w.0 < 1.0 - LEAST_GAIN)
        .filter_map(|&(score, k)| other_place(keyframes, k, score, align, settings))
        .collect();
    let mut placed = Vec::new();
    // One that is put right makes the step to the next ordinary.
    while let Some(next) = waiting.iter().position(|e| is_likelier(keyframes, e)) {
        let edge = waiting.remove(next);
        keyframes[edge.to].map_from_scan = there(keyframes, &edge);
        placed.push(edge);
    }
    placed
}

fn there(keyframes: &[Keyframe], edge: &Edge) -> Pose {
    keyframes[edge.from].map_from_scan * edge.motion
}

/// Whether the steps to and from a keyframe become no odder by an edge. A scanner moves as it has moved elsewhere.
fn is_likelier(keyframes: &[Keyframe], edge: &Edge) -> bool {
    let now = keyframes[edge.to].map_from_scan;
    oddity_at(keyframes, edge.to, there(keyframes, edge)) <= oddity_at(keyframes, edge.to, now)
}

/// Keyframes that saw what keyframe `k` saw, nearest first.
fn witnesses(keyframes: &[Keyframe], k: usize) -> Vec<usize> {
    let here = keyframes[k].seen_around();
    let mut near: Vec<(f64, usize)> = (0..keyframes.len())
        .filter(|&j| j.abs_diff(k) > ACCOMPLICES)
        .map(|j| (keyframes[j].seen_around().distance(here), j))
        .filter(|n| n.0 < SAME_VIEW_M)
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    near.into_iter().take(MOST_WITNESSES).map(|n| n.1).collect()
}

/// How well a keyframe agrees with what the others saw; `None` when nobody saw the same.
fn score_among_others(keyframes: &[Keyframe], k: usize) -> Option<f64> {
    let witnesses = witnesses(keyframes, k);
    if witnesses.is_empty() {
        return None;
    }
    let place = Place::of(witnesses.iter().map(|&j| &keyframes[j]));
    let here = keyframes[k].map_from_scan;
    Some(place.agreement(&[View::new(&keyframes[k], here)], here).score())
}

fn other_place(
    keyframes: &[Keyframe],
    k: usize,
    score: f64,
    align: &AlignSettings,
    settings: &RecogniseSettings,
) -> Option<Edge> {
    let witnesses = witnesses(keyframes, k);
    let place = Place::of(witnesses.iter().map(|&j| &keyframes[j]));
    let here = keyframes[k].map_from_scan;
    let views = [View::new(&keyframes[k], here)];
    let found = place.locate(&views, here, Drift::anywhere(WINDOW_M), align, settings)?;
    let pose = found.map_from_scan;
    let gain = place.agreement(&views, pose).score() - score;
    let from = *witnesses.first()?;
    let map_from_witness = keyframes[from].map_from_scan;
    (is_elsewhere(pose, here) && gain >= LEAST_GAIN).then(|| Edge {
        from,
        to: k,
        motion: map_from_witness.inverse() * pose,
        information: found.information.turned(-map_from_witness.theta_rad),
        is_loop: true,
    })
}

/// How unlike all other steps of the log those to and from keyframe `k` would be if it lay at `pose`, metres.
fn oddity_at(keyframes: &[Keyframe], k: usize, pose: Pose) -> f64 {
    let to = k
        .checked_sub(1)
        .map(|b| keyframes[b].map_from_scan.inverse() * pose);
    let from = keyframes.get(k + 1).map(|a| pose.inverse() * a.map_from_scan);
    to.into_iter()
        .chain(from)
        .map(|step| oddity(keyframes, k, step))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keyframe::drawn::{HALL, keyframe};

    /// A walk through the hall on which one scan was placed 1.2 m too far on.
    fn walk() -> Vec<Keyframe> {
        let mut keyframes: Vec<Keyframe> = (0..15)
            .map(|k| keyframe(HALL, Pose::new(f64::from(k) - 7.0, 0.2, 0.0)))
            .collect();
        keyframes[6].map_from_scan = Pose::new(0.2, 0.2, 0.0);
        keyframes
    }

    #[test]
    fn a_scan_that_the_others_contradict_is_placed_again() {
        let mut keyframes = walk();
        let all: Vec<usize> = (0..keyframes.len()).collect();
        let settings = (AlignSettings::default(), RecogniseSettings::default());
        let edges = place_again(&mut keyframes, &all, &settings.0, &settings.1);
        assert_eq!(edges.iter().map(|e| e.to).collect::<Vec<_>>(), [6]);
        let off_m = keyframes[6].map_from_scan.distance(Pose::new(-1.0, 0.2, 0.0));
        assert!(off_m < 0.02, "{off_m}");
    }

    #[test]
    fn what_lay_right_stays_to_the_bit() {
        let mut keyframes = walk();
        let before: Vec<Pose> = keyframes.iter().map(|k| k.map_from_scan).collect();
        let others: Vec<usize> = (0..keyframes.len()).filter(|&k| k != 6).collect();
        let settings = (AlignSettings::default(), RecogniseSettings::default());
        assert!(place_again(&mut keyframes, &others, &settings.0, &settings.1).is_empty());
        let after: Vec<Pose> = keyframes.iter().map(|k| k.map_from_scan).collect();
        assert_eq!(before, after);
    }
}
