//! Fig. 3: two scans far apart, matched by shape alone.

use polymapper_core::geometry::{Pose, wrap_rad};
use polymapper_draw::Scene;

use super::Undrawn;
use super::survey::Survey;
use crate::shape_match::{ShapeMatch, Verdict, apart};

/// First scans that are tried.
const TRIED: usize = 60;
/// Least difference of two scans that are far apart.
const FAR_M: f64 = 1.0;
const FAR_RAD: f64 = 30.0 * std::f64::consts::PI / 180.0;
/// The match is right when it is this near to the map's word.
const RIGHT_M: f64 = 0.1;
const RIGHT_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Draws the pair, or one that is far apart and matched rightly.
pub fn draw(survey: &Survey, pair: Option<(usize, usize)>) -> Result<Scene, Undrawn> {
    let (a, b) = match pair {
        Some(pair) => pair,
        None => find(survey).ok_or(Undrawn(
            "no two scans a metre or 30° apart are matched as the map has them; choose some with --pair",
        ))?,
    };
    let found = ShapeMatch::of(&survey.scans[a].scan, &survey.scans[b].scan);
    let (first, second) = (survey.scans[a].index, survey.scans[b].index);
    let mut scene = found.scene(&format!(
        "{}, scans\u{a0}{first} (green) and {second} (blue)",
        survey.name
    ));
    if let Some(motion) = motion(survey, a, b) {
        scene.caption += &format!(" By the map they are {} apart.", apart(motion));
    }
    Ok(scene)
}

/// The pose of scan `b` in the frame of `a`, by the map.
fn motion(survey: &Survey, a: usize, b: usize) -> Option<Pose> {
    Some(survey.scans[a].map_from_scan?.inverse() * survey.scans[b].map_from_scan?)
}

/// Of first scans spread evenly over the log and the next scans far from them, the one with most to show among those that
/// are matched surely and rightly.
fn find(survey: &Survey) -> Option<(usize, usize)> {
    let count = survey.scans.len();
    let right = (0..count).step_by(count.div_ceil(TRIED).max(1)).filter_map(|a| {
        let (b, motion) = next_far(survey, a)?;
        let found = ShapeMatch::of(&survey.scans[a].scan, &survey.scans[b].scan);
        is_right(&found, motion).then(|| (a, b, worth(&found, motion)))
    });
    let (a, b, _) = right.max_by(|x, y| x.2.total_cmp(&y.2))?;
    Some((a, b))
}

/// The next scan that is a metre or 30° from scan `a`.
fn next_far(survey: &Survey, a: usize) -> Option<(usize, Pose)> {
    (a + 1..survey.scans.len())
        .filter_map(|b| Some((b, motion(survey, a, b)?)))
        .find(|(_, motion)| motion.translation().norm() >= FAR_M || motion.theta_rad.abs() >= FAR_RAD)
}

fn is_right(found: &ShapeMatch, motion: Pose) -> bool {
    found.verdict == Verdict::Sure
        && found.matching.correspondences.len() >= 3
        && found.first_from_second().is_some_and(|pose| {
            pose.distance(motion) <= RIGHT_M && wrap_rad(pose.theta_rad - motion.theta_rad).abs() <= RIGHT_RAD
        })
}

/// How much there is to show: way and turn, each up to twice of what counts as far, so that both are wanted, and up to
/// eight correspondences, a fifth each.
fn worth(found: &ShapeMatch, motion: Pose) -> f64 {
    let way = motion.translation().norm() / FAR_M;
    let turn = motion.theta_rad.abs() / FAR_RAD;
    let pairs = found.matching.correspondences.len().min(8) as f64;
    way.min(2.0) + turn.min(2.0) + 0.2 * pairs
}
