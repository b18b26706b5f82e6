//! Where one map lies in another, by the votes of its keyframes.

use super::{LEAST_AGREEING, LEAST_AGREEING_SHARE, MOST_DISAGREEING, MOST_OTHER, NotJoined};
use crate::align::Information;
use crate::geometry::{Point, Pose, wrap_rad};
use crate::keyframe::Keyframe;
use crate::locate::{Fix, Locator, Verdict};

/// Way between two keyframes that are looked for, metres; a turn by a radian counts as a metre.
const LOOK_AFTER_M: f64 = 1.0;
/// Keyframes looked for at most.
const MOST_LOOKED: usize = 150;
/// Poses of a keyframe that vote, at most.
const MOST_POSES: usize = 3;
/// Votes agree when they put a keyframe within this of each other, metres and radians. Maps that were made apart have
/// drifted apart.
const AGREE_M: f64 = 1.0;
const AGREE_RAD: f64 = 0.15;
/// A keyframe sees the first map if that says something of this share of its beams, and agrees with it if this share of
/// these end on the map.
const LEAST_KNOWN: f64 = 0.5;
const LEAST_FIT: f64 = 0.6;

/// A keyframe of the second map, and where it may be in the first.
pub(super) struct Found {
    keyframe: usize,
    verdict: Verdict,
    fixes: Vec<Fix>,
}

/// A keyframe of the second map in the first.
pub(super) struct Placed {
    pub keyframe: usize,
    pub map_from_scan: Pose,
    pub information: Information,
}

/// Where the second map lies in the first.
pub(super) struct Choice {
    pub first_from_second: Pose,
    /// Keyframes that were found there.
    pub agreeing: Vec<Placed>,
}

/// Looks for keyframes of the second map in the first.
pub(super) fn look(locator: &Locator, keyframes: &[Keyframe]) -> Vec<Found> {
    let apart = apart(keyframes);
    let step = apart.len().div_ceil(MOST_LOOKED).max(1);
    apart
        .into_iter()
        .step_by(step)
        .map(|k| {
            let found = locator.find_points(&keyframes[k].points);
            Found {
                keyframe: k,
                verdict: found.verdict,
                fixes: found.fixes.into_iter().take(MOST_POSES).collect(),
            }
        })
        .collect()
}

/// Keyframes some way apart.
fn apart(keyframes: &[Keyframe]) -> Vec<usize> {
    let mut out: Vec<usize> = Vec::new();
    for (k, keyframe) in keyframes.iter().enumerate() {
        let is_far = out.last().is_none_or(|&last| {
            let step = keyframes[last].map_from_scan.inverse() * keyframe.map_from_scan;
            step.translation().norm() + step.theta_rad.abs() >= LOOK_AFTER_M
        });
        if is_far {
            out.push(k);
        }
    }
    out
}

/// The place of the second map that most keyframes agree on, if it is the only one.
pub(super) fn choose(
    locator: &Locator,
    looked: &[Found],
    keyframes: &[Keyframe],
) -> Result<Choice, NotJoined> {
    let ways = ways(looked, keyframes);
    let best = ways.first();
    let agreeing = best.map_or(0, |w| w.1);
    let needed = LEAST_AGREEING.max((LEAST_AGREEING_SHARE * looked.len() as f64).ceil() as usize);
    let Some(&(first_from_second, _)) = best.filter(|w| w.1 >= needed) else {
        return Err(NotJoined::TooLittle {
            agreeing,
            looked_for: looked.len(),
            needed,
        });
    };
    let middle = middle(keyframes);
    let differs = |way: &&(Pose, usize)| {
        (way.0 * middle).distance(first_from_second * middle) > 2.0 * AGREE_M
            || wrap_rad(way.0.theta_rad - first_from_second.theta_rad).abs() > 2.0 * AGREE_RAD
    };
    if let Some(other) = ways.iter().find(differs)
        && other.1 as f64 >= MOST_OTHER * agreeing as f64
    {
        return Err(NotJoined::Ambiguous {
            agreeing,
            other: other.1,
            apart_m: (other.0 * middle).distance(first_from_second * middle),
        });
    }
    let (overlapping, disagreeing) = contradiction(locator, looked, keyframes, first_from_second);
    if disagreeing as f64 > MOST_DISAGREEING * overlapping as f64 {
        return Err(NotJoined::Contradiction {
            disagreeing,
            overlapping,
        });
    }
    Ok(Choice {
        first_from_second,
        agreeing: looked
            .iter()
            .filter_map(|f| placed(f, keyframes, first_from_second))
            .collect(),
    })
}

/// Every way to lay the second map into the first that a keyframe is sure of, with the number of keyframes that
/// agree; most first.
fn ways(looked: &[Found], keyframes: &[Keyframe]) -> Vec<(Pose, usize)> {
    let mut out: Vec<(Pose, usize)> = looked
        .iter()
        .filter(|f| f.verdict != Verdict::NotFound)
        .flat_map(|f| f.fixes.iter().map(move |fix| (f, fix)))
        .map(|(f, fix)| {
            let way = fix.map_from_scan * keyframes[f.keyframe].map_from_scan.inverse();
            let count = looked
                .iter()
                .filter(|other| placed(other, keyframes, way).is_some())
                .count();
            (way, count)
        })
        .collect();
    // Stable: of equals the first keyframe's.
    out.sort_by_key(|way| std::cmp::Reverse(way.1));
    out
}

/// The pose of a keyframe that agrees with a way, if one does.
fn placed(found: &Found, keyframes: &[Keyframe], first_from_second: Pose) -> Option<Placed> {
    let expected = first_from_second * keyframes[found.keyframe].map_from_scan;
    let fix = found.fixes.iter().find(|fix| {
        fix.map_from_scan.distance(expected) < AGREE_M
            && wrap_rad(fix.map_from_scan.theta_rad - expected.theta_rad).abs() < AGREE_RAD
    })?;
    (found.verdict != Verdict::NotFound).then_some(Placed {
        keyframe: found.keyframe,
        map_from_scan: fix.map_from_scan,
        information: fix.information,
    })
}

/// How many keyframes see the first map from where they would be, and how many of them see something else.
fn contradiction(locator: &Locator, looked: &[Found], keyframes: &[Keyframe], way: Pose) -> (usize, usize) {
    let (mut overlapping, mut disagreeing) = (0, 0);
    for found in looked {
        let keyframe = &keyframes[found.keyframe];
        let Some(fix) = locator.fix_near(&keyframe.points, way * keyframe.map_from_scan, AGREE_M / 3.0)
        else {
            continue;
        };
        if fix.agreement.known_share() >= LEAST_KNOWN {
            overlapping += 1;
            let agrees = fix.agreement.fit() >= LEAST_FIT || placed(found, keyframes, way).is_some();
            disagreeing += usize::from(!agrees);
        }
    }
    (overlapping, disagreeing)
}

fn middle(keyframes: &[Keyframe]) -> Pose {
    let sum = keyframes
        .iter()
        .fold(Point::default(), |sum, k| sum + k.map_from_scan.translation());
    let mean = sum / keyframes.len().max(1) as f64;
    Pose::new(mean.x, mean.y, 0.0)
}
