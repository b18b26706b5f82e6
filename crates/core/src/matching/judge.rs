//! How well a pose explains both sets of polylines.
//!
//! In: a pose `reference_from_scan`. Out: the share of wall that lies on wall facing the same way, less the share
//! that one view looked through where the other saw a wall. Both views are taken from the origins of their frames.
//! Refinement is a few rounds of least squares of points on lines, and tells what the walls leave open.

use super::induced::{INDEPENDENT_WALL_M, WALL_SIGMA_M};
use super::information::{Information, PoseGaussian};
use super::outline::{Outline, Seen};
use super::walls::{REACH_M, Sample, WallGrid, samples_of, walls_of};
use crate::geometry::{Point, Polyline, Pose};

/// Points on the walls of each side; at 40 m of wall in sight, one every 0.3 m.
const SAMPLES: usize = 140;
/// A piece that was looked through speaks as loudly against a pose as a fitting one speaks for it.
const CONTRADICTION_WEIGHT: f64 = 1.0;
/// Reach of a fit once a pose is refined, metres; the gap at which the paper calls two things two.
pub(super) const FIT_REACH_M: f64 = 0.2;
/// Reach of each round of refinement, metres.
const ROUNDS_M: [f64; 5] = [REACH_M, REACH_M, 0.3, FIT_REACH_M, FIT_REACH_M];

/// What speaks for and against a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Verdict {
    /// Share of the scan's wall that lies on the reference.
    pub explained: f64,
    /// Share of both sides' wall that the other side looked through.
    pub contradicted: f64,
    /// What poses are ranked by.
    pub score: f64,
}

/// Both sides, ready to be laid on each other many times.
pub(super) struct Judge {
    scan: Vec<Sample>,
    reference: Vec<Sample>,
    pub grid: WallGrid,
    scan_outline: Outline,
    reference_outline: Outline,
    scan_m: f64,
    reference_m: f64,
    estimate: PoseGaussian,
}

impl Judge {
    pub fn new(scan: &[Polyline], reference: &[Polyline], estimate: PoseGaussian) -> Self {
        let (scan_walls, reference_walls) = (walls_of(scan), walls_of(reference));
        let total = |samples: &[Sample]| samples.iter().map(weight_of).sum::<f64>().max(1e-9);
        let (scan, reference) = (samples_of(&scan_walls, SAMPLES), samples_of(&reference_walls, SAMPLES));
        Self {
            scan_m: total(&scan),
            reference_m: total(&reference),
            scan,
            reference,
            scan_outline: Outline::new(&scan_walls),
            reference_outline: Outline::new(&reference_walls),
            grid: WallGrid::new(reference_walls),
            estimate,
        }
    }

    /// The score of a pose from every third point alone, to choose the poses worth refining.
    pub fn glance(&self, pose: Pose, reach_m: f64) -> f64 {
        let every = |samples: &[Sample]| samples.iter().step_by(3).map(|s| s.length_m).sum::<f64>().max(1e-9);
        let (scan_m, reference_m) = (every(&self.scan), every(&self.reference));
        let (explained_m, scan_through_m) = self.scan_on_reference(pose, reach_m, 3);
        let through_m = scan_through_m + self.reference_seen_through(pose.inverse(), 3);
        explained_m / scan_m - CONTRADICTION_WEIGHT * 2.0 * through_m / (scan_m + reference_m) + self.prior(pose)
    }

    /// Judges a pose; fits count within `reach_m`.
    pub fn verdict(&self, pose: Pose, reach_m: f64) -> Verdict {
        let (explained_m, scan_through_m) = self.scan_on_reference(pose, reach_m, 1);
        let reference_through_m = self.reference_seen_through(pose.inverse(), 1);
        let explained = explained_m / self.scan_m;
        let contradicted = (scan_through_m + reference_through_m) / (self.scan_m + self.reference_m);
        Verdict {
            explained,
            contradicted,
            score: explained - CONTRADICTION_WEIGHT * 2.0 * contradicted + self.prior(pose),
        }
    }

    /// The best a pose of this verdict can be read as, for settings that look only at fit.
    fn prior(&self, pose: Pose) -> f64 {
        // A deviation of three standard deviations costs as much as a tenth of the walls.
        const COST_AT_3_SIGMA: f64 = 0.1;
        let error = self.estimate.error_of(pose);
        -COST_AT_3_SIGMA / 9.0 * self.estimate.information.quadratic(error)
    }

    fn scan_on_reference(&self, pose: Pose, reach_m: f64, step: usize) -> (f64, f64) {
        let (sin, cos) = pose.theta_rad.sin_cos();
        let turn = |v: Point| Point::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y);
        let (mut explained_m, mut through_m) = (0.0, 0.0);
        for sample in self.scan.iter().step_by(step) {
            let point = turn(sample.point) + pose.translation();
            match self.grid.nearest(point, turn(sample.normal), reach_m) {
                Some(near) => {
                    let share = near.distance_m / reach_m;
                    explained_m += weight_of(sample) * (1.0 - share * share);
                }
                None if self.reference_outline.seen(point) == Seen::Through => through_m += weight_of(sample),
                None => {}
            }
        }
        (explained_m, through_m)
    }

    fn reference_seen_through(&self, scan_from_reference: Pose, step: usize) -> f64 {
        let (sin, cos) = scan_from_reference.theta_rad.sin_cos();
        let shift = scan_from_reference.translation();
        let through = |sample: &&Sample| {
            let p = sample.point;
            let point = Point::new(cos * p.x - sin * p.y, sin * p.x + cos * p.y) + shift;
            self.scan_outline.seen(point) == Seen::Through
        };
        self.reference.iter().step_by(step).filter(through).map(weight_of).sum()
    }

    /// Least squares of the scan's points on the reference's lines, the nearest that faces the same way each time.
    pub fn refined(&self, start: Pose) -> PoseGaussian {
        let mut gaussian = PoseGaussian {
            mean: start,
            information: Information::NONE,
        };
        for reach_m in ROUNDS_M {
            let (information, gradient) = self.normal_equations(gaussian.mean, reach_m);
            gaussian.information = information;
            // Along what no wall fixes the pose stays: 1 m and 0.2 rad are weak beside any wall.
            let held = information.plus(&Information::from_sigmas(1.0, 1.0, 0.2));
            let Some([dx, dy, dtheta]) = held.solve(gradient) else {
                return gaussian;
            };
            let mean = gaussian.mean;
            gaussian.mean = Pose::new(mean.x + dx, mean.y + dy, mean.theta_rad + dtheta);
        }
        gaussian
    }

    fn normal_equations(&self, pose: Pose, reach_m: f64) -> (Information, [f64; 3]) {
        let (sin, cos) = pose.theta_rad.sin_cos();
        let turn = |v: Point| Point::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y);
        let mut information = Information::NONE;
        let mut gradient = [0.0; 3];
        for sample in &self.scan {
            let turned = turn(sample.point);
            let point = turned + pose.translation();
            let Some(near) = self.grid.nearest(point, turn(sample.normal), reach_m) else {
                continue;
            };
            let normal = self.grid.walls()[near.wall].normal;
            let share = near.distance_m / reach_m;
            let measurements = sample.length_m / INDEPENDENT_WALL_M;
            let weight = (1.0 - share * share).powi(2) * measurements / (WALL_SIGMA_M * WALL_SIGMA_M);
            let jacobian = [normal.x, normal.y, normal.dot(turned.left())];
            information.add(jacobian, weight);
            for (g, j) in gradient.iter_mut().zip(jacobian) {
                *g -= weight * j * near.offset_m;
            }
        }
        (information, gradient)
    }
}

/// What a sample counts.
fn weight_of(sample: &Sample) -> f64 {
    sample.length_m
}
