//! Two visits to a place, tied together all along.
//!
//! In: the keyframes of an earlier visit, and the newer ones that a closed loop has brought near them. Out: an edge
//! for each of the newer ones that fits where it now lies. One closure ties one keyframe: those before it follow by
//! their own drift, and without further ties the place would stand twice, some decimetres apart.

use super::graph::Edge;
use crate::align::{AlignSettings, Guess, align_to_grid};
use crate::geometry::SideGrid;
use crate::keyframe::Keyframe;
use crate::place::judge::judge;

/// How far a keyframe may be off after a closure: standard deviations, metres and radians.
const OFF_M: f64 = 0.15;
const OFF_RAD: f64 = 0.05;
/// Shares of the beams that must agree with the earlier visit, and that it must say something of.
const LEAST_FIT: f64 = 0.7;
const LEAST_KNOWN: f64 = 0.4;
/// Distance at which a return lies on a side, metres, as for closures.
const GATE_M: f64 = 0.12;

/// Edges from keyframes of `earlier` to those of `newer` that can be aligned to what the earlier visit saw.
pub(crate) fn ties(
    keyframes: &[Keyframe],
    earlier: &[usize],
    newer: &[usize],
    align: &AlignSettings,
) -> Vec<Edge> {
    let mut sides = SideGrid::default();
    let mut owner = 0;
    for keyframe in earlier.iter().map(|&k| &keyframes[k]) {
        for polyline in keyframe.standing_polylines() {
            let walls = polyline.polyline.vertices();
            sides.insert(owner, keyframe.map_from_scan.transform(walls));
            owner += 1;
        }
    }
    newer
        .iter()
        .filter_map(|&k| tie(keyframes, earlier, k, &sides, align))
        .collect()
}

fn tie(
    keyframes: &[Keyframe],
    earlier: &[usize],
    newer: usize,
    sides: &SideGrid,
    align: &AlignSettings,
) -> Option<Edge> {
    let keyframe = &keyframes[newer];
    let guess = Guess {
        map_from_scan: keyframe.map_from_scan,
        sigma_m: OFF_M,
        sigma_rad: OFF_RAD,
    };
    let prior = guess.prior();
    let found = align_to_grid(&keyframe.points, sides, |_, _| true, &guess, Some(&prior), align)?;
    let agreement = judge(&keyframe.points, sides, found.map_from_scan, GATE_M);
    let is_near = found.map_from_scan.distance(keyframe.map_from_scan) < 3.0 * OFF_M;
    if !is_near || agreement.fit() < LEAST_FIT || agreement.known_share() < LEAST_KNOWN {
        return None;
    }
    let here = keyframe.seen_around();
    let from = earlier.iter().copied().min_by(|&a, &b| {
        let distance = |k: usize| keyframes[k].seen_around().distance(here);
        distance(a).total_cmp(&distance(b))
    })?;
    let map_from_old = keyframes[from].map_from_scan;
    Some(Edge {
        from,
        to: newer,
        motion: map_from_old.inverse() * found.map_from_scan,
        information: found.information.turned(-map_from_old.theta_rad),
        is_loop: true,
    })
}
