//! Which keyframes the map around is made of when more are within reach than it needs; an earlier visit, too, to which a new
//! one is tied after a closure.
//!
//! In: keyframes within reach, how far they are along the pose graph, and which of them are in the map already. Out: those
//! that are to be merged. On a first visit there are 40 to 150 within reach; where a scanner comes by again and again, a
//! thousand, and the map around would cost more the longer the log (raw intel, last tenth of the scans: 2.5 times the first).
//!
//! Every place is to be seen from every side: keyframes are taken from all places and headings in turn, from each the nearest
//! along the graph first, those with the least drift.

use std::collections::HashMap;
use std::f64::consts::TAU;

use crate::geometry::Pose;
use crate::keyframe::Keyframe;

/// The map around needs no more keyframes than this. Raw intel is mapped as exactly with 200 as with all of them (0.0134 m);
/// but with 200 one of eight runs of raw csail, ranges alike to a millionth, took a step of 1.4 m wrongly, with 250 and
/// with 300 none.
const ENOUGH: usize = 250;
/// Keyframes within a square of this edge, metres, and a sixth of a turn show the same.
const SAME_M: f64 = 1.0;
const HEADINGS: f64 = 6.0;

/// Those of `around` (ascending) that are to be merged into a map of keyframes `present`, ascending.
pub(super) fn needed(
    keyframes: &[Keyframe],
    present: &[usize],
    around: &[usize],
    ways_m: &[Option<f64>],
) -> Vec<usize> {
    let mut is_present = vec![false; keyframes.len()];
    for &k in present {
        is_present[k] = true;
    }
    let mut needed = around.to_vec();
    if needed.len() > ENOUGH {
        let way_m = |k: usize| ways_m[k].unwrap_or(f64::INFINITY);
        needed.sort_by(|&a, &b| {
            let by_way = || way_m(a).total_cmp(&way_m(b));
            is_present[b].cmp(&is_present[a]).then_with(by_way)
        });
        let mut counts: HashMap<(i32, i32, i32), usize> = HashMap::new();
        let mut in_turn = Vec::with_capacity(needed.len());
        for k in needed {
            let count = counts.entry(view(keyframes[k].map_from_scan)).or_default();
            *count += 1;
            in_turn.push((*count, k));
        }
        in_turn.sort_by(|a, b| a.0.cmp(&b.0).then_with(|| way_m(a.1).total_cmp(&way_m(b.1))));
        needed = in_turn.into_iter().take(ENOUGH).map(|(_, k)| k).collect();
        needed.sort_unstable();
    }
    needed.retain(|&k| !is_present[k]);
    needed
}

/// At most `most` keyframes of every view, spread over all that have it, in order.
pub(super) fn few_of_each_view(keyframes: &[Keyframe], most: usize) -> Vec<(u32, &Keyframe)> {
    let views = || keyframes.iter().map(|k| view(k.map_from_scan));
    let mut counts: HashMap<(i32, i32, i32), usize> = HashMap::new();
    views().for_each(|view| *counts.entry(view).or_default() += 1);
    let mut seen: HashMap<(i32, i32, i32), usize> = HashMap::new();
    (0_u32..)
        .zip(keyframes)
        .zip(views())
        .filter(|(_, view)| {
            let (count, seen) = (counts[view], seen.entry(*view).or_default());
            *seen += 1;
            // The part of `most` that falls to the first `seen` of them grows with this one.
            *seen * most / count > (*seen - 1) * most / count || count <= most
        })
        .map(|(numbered, _)| numbered)
        .collect()
}

/// Square and heading that a pose lies in.
fn view(pose: Pose) -> (i32, i32, i32) {
    let part = |value: f64, size: f64| (value / size).floor() as i32;
    (
        part(pose.x, SAME_M),
        part(pose.y, SAME_M),
        part(pose.theta_rad, TAU / HEADINGS),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keyframe::drawn::{HALL, keyframe};

    /// Rounds of ten places, and ways as if the last was where the scanner is.
    fn rounds(count: usize) -> (Vec<Keyframe>, Vec<usize>, Vec<Option<f64>>) {
        let keyframes: Vec<Keyframe> = (0..10 * count)
            .map(|k| keyframe(HALL, Pose::new(1.5 * (k % 10) as f64 - 7.0, 0.3, 0.2)))
            .collect();
        let ways_m = (0..keyframes.len()).rev().map(|k| Some(k as f64)).collect();
        let all = (0..keyframes.len()).collect();
        (keyframes, all, ways_m)
    }

    #[test]
    fn a_first_visit_is_taken_whole() {
        let (keyframes, around, ways_m) = rounds(15);
        assert_eq!(needed(&keyframes, &[], &around, &ways_m), around);
        assert_eq!(needed(&keyframes, &around[20..], &around, &ways_m), around[..20]);
    }

    #[test]
    fn of_many_visits_all_places_have_the_nearest() {
        let (keyframes, around, ways_m) = rounds(100);
        let taken = needed(&keyframes, &[], &around, &ways_m);
        assert_eq!(taken, around[1000 - ENOUGH..]);
    }

    #[test]
    fn every_view_has_its_few_from_first_to_last() {
        let (keyframes, _, _) = rounds(30);
        let few: Vec<u32> = few_of_each_view(&keyframes, 3).iter().map(|f| f.0).collect();
        let of_place = |place: u32| {
            few.iter()
                .copied()
                .filter(|k| k % 10 == place)
                .collect::<Vec<_>>()
        };
        assert_eq!(of_place(0), [90, 190, 290]);
        assert_eq!(few.len(), 30);
        assert_eq!(few_of_each_view(&keyframes, 30).len(), keyframes.len());
    }

    #[test]
    fn what_is_in_the_map_counts() {
        let (keyframes, around, ways_m) = rounds(100);
        // Places 0 to 4 have been merged often enough.
        let present: Vec<usize> = (0..600).filter(|k| k % 10 < 5).collect();
        let taken = needed(&keyframes, &present, &around, &ways_m);
        assert_eq!(taken.len(), ENOUGH / 2);
        assert!(taken.iter().all(|k| k % 10 >= 5 && *k >= 750), "{taken:?}");
    }
}
