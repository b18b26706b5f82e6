//! From correspondences and votes to ranked poses.

use super::Hypothesis;
use super::correspondence::{Candidates, Correspondence};
use super::gaussian::PoseGaussian;
use super::headings::{headings, log_normal};
use super::induced::{INDEPENDENT_WALL_M, WALL_SIGMA_M, WALL_WORTH_M};
use super::judge::{FIT_REACH_M, Judge};
use super::votes::{Window, translations};
use super::walls::{REACH_M, walls_of};
use crate::align::Information;
use crate::geometry::{Point, Polyline, Pose, wrap_rad};

/// Headings tried: the four of an orthogonal building, and as many again for oblique walls and clutter.
const HEADINGS: usize = 10;
/// Places tried a heading.
const PLACES: usize = 10;
/// Poses refined, of those that look best unrefined.
const REFINED: usize = 30;
/// Every which point is asked to choose those.
const GLANCE_STEP: usize = 3;
/// Poses handed on.
const KEPT: usize = 12;
/// Poses nearer than both of these are one.
const APART_M: f64 = 0.25;
const APART_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Error of a heading from the histograms, radians (6°), for the matching around it.
const HEADING_SIGMA_RAD: f64 = 0.1;
/// The farthest place looked for, metres from the estimate; bounds the grid of votes to 300 × 300 cells.
const FARTHEST_M: f64 = 30.0;
/// Information along a direction, 1/m², below which the place along it counts as not seen: less than one wall stands across
/// it. Corridors have door jambs and things that move with the scanner (ends of view), and those add up to a fraction of a wall: of the wrong
/// best poses in a corridor of 2 km three quarters are marked so, of all poses there a quarter.
const ONE_WALL: f64 = WALL_WORTH_M / (INDEPENDENT_WALL_M * WALL_SIGMA_M * WALL_SIGMA_M);
/// Seeds of agreement taken from one matching, the longest first.
const SEEDS: usize = 6;
/// Poses that differ by more than this squared Mahalanobis distance do not agree (99 % of χ², 3 degrees of freedom).
const AGREE_MAHALANOBIS2: f64 = 11.34;

/// The poses that explain both sides best, best first.
pub(super) fn ranked(
    scan: &[Polyline],
    estimate: &PoseGaussian,
    candidates: &Candidates,
    judge: &Judge,
) -> Vec<Hypothesis> {
    let mut starts = Vec::new();
    let scan_walls = walls_of(scan);
    let heading_information = estimate.information.rows[2][2];
    let log_prior = |h: f64| log_normal(h, estimate.mean.theta_rad, heading_information);
    for heading_rad in headings(&scan_walls, judge.grid.walls(), log_prior, HEADINGS) {
        let at_heading = around_heading(estimate, heading_rad);
        agreeing(&candidates.matching(&at_heading), &at_heading, &mut starts);
        let window = Window {
            centre: estimate.mean.translation(),
            half_m: window_m(&estimate.information),
        };
        let places = translations(&scan_walls, judge.grid.walls(), heading_rad, window, PLACES);
        starts.extend(places.into_iter().map(|(t, _)| Pose::new(t.x, t.y, heading_rad)));
    }
    distinct(refined(&best_starts(starts, judge), judge))
}

/// Three standard deviations of the estimate, within reason.
fn window_m(information: &Information) -> f64 {
    let rows = information.rows;
    let least = rows[0][0].min(rows[1][1]);
    if least > 0.0 {
        (3.0 / least.sqrt()).min(FARTHEST_M)
    } else {
        FARTHEST_M
    }
}

fn around_heading(estimate: &PoseGaussian, heading_rad: f64) -> PoseGaussian {
    let mean = estimate.mean;
    let rows = estimate.information.rows;
    let sigma_m = |k: usize| 1.0 / rows[k][k].sqrt();
    PoseGaussian {
        mean: Pose::new(mean.x, mean.y, heading_rad),
        information: Information::from_sigmas(sigma_m(0), sigma_m(1), HEADING_SIGMA_RAD),
    }
}

/// Poses on which correspondences agree: each long one in turn is taken for true, and those that agree with it
/// are added. Walls of different directions so fix together what each leaves open.
fn agreeing(matching: &[Correspondence], estimate: &PoseGaussian, starts: &mut Vec<Pose>) {
    let length_m = |c: &Correspondence| c.pieces.iter().map(|p| p.length_m()).sum::<f64>();
    let mut order: Vec<&Correspondence> = matching.iter().collect();
    order.sort_by(|a, b| length_m(b).total_cmp(&length_m(a)));
    for seed in order.iter().take(SEEDS) {
        let mut pose = PoseGaussian::fused([&seed.induced, estimate], seed.induced.mean).mean;
        for _ in 0..2 {
            let agree = order.iter().map(|c| &c.induced).filter(|g| {
                let widened = PoseGaussian {
                    mean: pose,
                    information: Information::from_sigmas(0.2, 0.2, 0.05),
                };
                g.mahalanobis2(&widened) < AGREE_MAHALANOBIS2
            });
            pose = PoseGaussian::fused(agree.chain([estimate]), pose).mean;
        }
        starts.push(pose);
    }
}

/// Those that look best before refinement.
fn best_starts(starts: Vec<Pose>, judge: &Judge) -> Vec<Pose> {
    let mut judged: Vec<(f64, Pose)> = starts
        .into_iter()
        .map(|pose| (judge.verdict(pose, REACH_M, GLANCE_STEP).score, pose))
        .collect();
    judged.sort_by(|a, b| b.0.total_cmp(&a.0));
    judged.into_iter().take(REFINED).map(|(_, pose)| pose).collect()
}

fn refined(starts: &[Pose], judge: &Judge) -> Vec<Hypothesis> {
    starts.iter().map(|start| refined_one(*start, judge)).collect()
}

/// A pose refined and judged.
pub(super) fn refined_one(start: Pose, judge: &Judge) -> Hypothesis {
    let gaussian = judge.refined(start);
    let verdict = judge.verdict(gaussian.mean, FIT_REACH_M, 1);
    let (direction, along) = gaussian.information.weakest_direction();
    Hypothesis {
        reference_from_scan: gaussian.mean,
        information: gaussian.information,
        explained_ratio: verdict.explained,
        contradicted_ratio: verdict.contradicted,
        score: verdict.score,
        unobservable: (along < ONE_WALL).then_some(direction),
    }
}

/// The best of each cluster, best first.
fn distinct(mut all: Vec<Hypothesis>) -> Vec<Hypothesis> {
    all.sort_by(|a, b| b.score.total_cmp(&a.score));
    let mut kept: Vec<Hypothesis> = Vec::new();
    for hypothesis in all {
        if kept.len() >= KEPT {
            break;
        }
        if kept
            .iter()
            .all(|k| are_apart(k.reference_from_scan, hypothesis.reference_from_scan))
        {
            kept.push(hypothesis);
        }
    }
    kept
}

fn are_apart(a: Pose, b: Pose) -> bool {
    let shift: Point = a.translation() - b.translation();
    shift.norm() >= APART_M || wrap_rad(a.theta_rad - b.theta_rad).abs() >= APART_RAD
}
