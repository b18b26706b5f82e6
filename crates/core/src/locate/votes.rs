//! Where one map lies in another, by the votes of its keyframes.

use super::{Fix, Locator, Verdict};
use crate::align::Information;
use crate::geometry::{Point, Pose, wrap_rad};
use crate::keyframe::Keyframe;

/// Fewest keyframes that have to agree, a metre apart or more.
const LEAST_AGREEING: usize = 5;
/// Share of the keyframes looked for that have to agree: of a hundred keyframes of another building, four or five agree by
/// chance.
const LEAST_AGREEING_SHARE: f64 = 0.1;
/// Another way to join them may have this share of the votes.
const MOST_OTHER: f64 = 0.5;
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
/// A keyframe sees the first map if that says something of this share of its beams.
const LEAST_KNOWN: f64 = 0.5;

/// Why two maps were not joined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotJoined {
    /// One of the maps has nothing to compare.
    #[error("one of the maps has no keyframes")]
    Empty,
    /// Too few places of the second map are found in the first.
    #[error(
        "they have too little in common: {agreeing} of {looked_for} places of the second map are found in the first and agree, {needed} are needed"
    )]
    TooLittle {
        /// Keyframes that agree.
        agreeing: usize,
        /// Keyframes that were looked for.
        looked_for: usize,
        /// Keyframes that have to agree.
        needed: usize,
    },
    /// Where the maps would overlap, they show different things.
    #[error(
        "they do not fit: {disagreeing} of {overlapping} places of the second map see other walls than the first map has there"
    )]
    Contradiction {
        /// Keyframes that disagree.
        disagreeing: usize,
        /// Keyframes of which the first map says something.
        overlapping: usize,
    },
    /// There is more than one way.
    #[error(
        "it is ambiguous: {agreeing} places of the second map agree on one way to join them, {other} on another, {apart_m:.1} m apart"
    )]
    Ambiguous {
        /// Keyframes that agree on the best way.
        agreeing: usize,
        /// Keyframes that agree on the next best.
        other: usize,
        /// How far apart the ways put the second map, metres.
        apart_m: f64,
    },
}

/// What a place must have to be believed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trust {
    /// Fewest keyframes that have to agree, a metre apart or more.
    pub least_agreeing: usize,
    /// A keyframe that sees the first map may disagree if less than this share of the beams that it says something of end on it.
    pub least_fit: f64,
    /// If it was not found there by itself, it then disagrees, or only if it fits another place by this share better.
    pub worse_by: Option<f64>,
    /// Of the keyframes that see the first map, the share that may disagree.
    pub most_disagreeing: f64,
}

impl Trust {
    /// Maps made at different times: things have moved since.
    pub const FINISHED: Self = Self {
        least_agreeing: LEAST_AGREEING,
        least_fit: 0.6,
        worse_by: None,
        most_disagreeing: 0.25,
    };

    /// A map that was left a moment ago. In a cluttered office scans fit poorly even where they belong, but nowhere else better;
    /// where a corridor is taken for another one, scans before and behind the stretch that is alike do.
    pub const LEFT: Self = Self {
        least_agreeing: LEAST_AGREEING,
        least_fit: 0.9,
        worse_by: Some(0.1),
        most_disagreeing: 0.25,
    };
}

/// A keyframe of the second map, and where it may be in the first.
#[derive(Clone)]
pub(crate) struct Found {
    keyframe: usize,
    verdict: Verdict,
    fixes: Vec<Fix>,
}

/// A keyframe of the second map in the first.
pub(crate) struct Placed {
    pub keyframe: usize,
    pub map_from_scan: Pose,
    pub information: Information,
}

/// Where the second map lies in the first.
pub(crate) struct Choice {
    pub first_from_second: Pose,
    /// Keyframes that were found there.
    pub agreeing: Vec<Placed>,
    /// Of the keyframes that see the first map from there, the share that disagrees.
    pub disagreeing_share: f64,
}

/// Looks for keyframes of the second map in the first.
pub(crate) fn look(locator: &Locator, keyframes: &[Keyframe]) -> Vec<Found> {
    let apart = apart(keyframes);
    let step = apart.len().div_ceil(MOST_LOOKED).max(1);
    apart
        .into_iter()
        .step_by(step)
        .map(|k| Found::of(locator, keyframes, k))
        .collect()
}

impl Found {
    /// Looks for keyframe `k` in the first map.
    pub fn of(locator: &Locator, keyframes: &[Keyframe], k: usize) -> Self {
        let found = locator.find_points(&keyframes[k].points);
        Self {
            keyframe: k,
            verdict: found.verdict,
            fixes: found.fixes.into_iter().take(MOST_POSES).collect(),
        }
    }

    /// Whether keyframe `k` shows so much else that it is to be looked for, too; `times` as much as usual.
    pub fn is_far(&self, keyframes: &[Keyframe], k: usize, times: f64) -> bool {
        way_m(&keyframes[self.keyframe], &keyframes[k]) >= times * LOOK_AFTER_M
    }

    /// How well it fits where it fits best.
    fn best_fit(&self) -> f64 {
        let fits = self.fixes.iter().map(|f| f.agreement.fit());
        fits.fold(0.0, f64::max)
    }

    /// The keyframe that was looked for.
    pub fn keyframe(&self) -> usize {
        self.keyframe
    }
}

/// Keyframes some way apart.
fn apart(keyframes: &[Keyframe]) -> Vec<usize> {
    let mut out: Vec<usize> = Vec::new();
    for (k, keyframe) in keyframes.iter().enumerate() {
        if out
            .last()
            .is_none_or(|&last| way_m(&keyframes[last], keyframe) >= LOOK_AFTER_M)
        {
            out.push(k);
        }
    }
    out
}

/// From one keyframe to another, metres; a radian counts as one.
fn way_m(last: &Keyframe, keyframe: &Keyframe) -> f64 {
    let step = last.map_from_scan.inverse() * keyframe.map_from_scan;
    step.translation().norm() + step.theta_rad.abs()
}

/// The place of the second map that most keyframes agree on, if it is the only one.
pub(crate) fn choose(
    locator: &Locator,
    looked: &[Found],
    keyframes: &[Keyframe],
    trust: Trust,
) -> Result<Choice, NotJoined> {
    let ways = ways(looked, keyframes);
    let best = ways.first();
    let agreeing = best.map_or(0, |w| w.1);
    let needed = trust
        .least_agreeing
        .max((LEAST_AGREEING_SHARE * looked.len() as f64).ceil() as usize);
    let Some(&(first_from_second, _)) = best.filter(|w| w.1 >= needed) else {
        return Err(NotJoined::TooLittle {
            agreeing,
            looked_for: looked.len(),
            needed,
        });
    };
    let middle = middle(looked, keyframes);
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
    let (overlapping, disagreeing) = contradiction(locator, looked, keyframes, first_from_second, trust);
    if disagreeing as f64 > trust.most_disagreeing * overlapping as f64 {
        return Err(NotJoined::Contradiction {
            disagreeing,
            overlapping,
        });
    }
    Ok(Choice {
        first_from_second,
        disagreeing_share: disagreeing as f64 / overlapping.max(1) as f64,
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
    let fix = found
        .fixes
        .iter()
        .find(|fix| fix.map_from_scan.is_within(AGREE_M, AGREE_RAD, expected))?;
    (found.verdict != Verdict::NotFound).then_some(Placed {
        keyframe: found.keyframe,
        map_from_scan: fix.map_from_scan,
        information: fix.information,
    })
}

/// How many keyframes see the first map from where they would be, and how many of them see something else.
fn contradiction(
    locator: &Locator,
    looked: &[Found],
    keyframes: &[Keyframe],
    way: Pose,
    trust: Trust,
) -> (usize, usize) {
    let (mut overlapping, mut disagreeing) = (0, 0);
    for found in looked {
        let keyframe = &keyframes[found.keyframe];
        let Some(fix) = locator.fix_near(&keyframe.points, way * keyframe.map_from_scan, AGREE_M / 3.0)
        else {
            continue;
        };
        if fix.agreement.known_share() >= LEAST_KNOWN {
            overlapping += 1;
            let fit = fix.agreement.fit();
            let is_worse = || trust.worse_by.is_none_or(|by| found.best_fit() > fit + by);
            let disagrees = fit < trust.least_fit && is_worse() && placed(found, keyframes, way).is_none();
            disagreeing += usize::from(disagrees);
        }
    }
    (overlapping, disagreeing)
}

fn middle(looked: &[Found], keyframes: &[Keyframe]) -> Pose {
    let places = looked
        .iter()
        .map(|f| keyframes[f.keyframe].map_from_scan.translation());
    let mean = places.fold(Point::default(), |sum, p| sum + p) / looked.len().max(1) as f64;
    Pose::new(mean.x, mean.y, 0.0)
}
