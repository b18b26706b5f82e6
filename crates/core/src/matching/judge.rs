//! How well a pose explains both sets of polylines.
//!
//! In: a pose `reference_from_scan`. Out: the share of wall that lies on wall facing the same way, less the share
//! that one view looked through where the other saw a wall. Both views are taken from the origins of their frames.
//! Refinement is a few rounds of least squares of points on lines, and tells what the walls leave open.

use super::gaussian::PoseGaussian;
use super::induced::WALL_SIGMA_M;
use super::outline::Outline;
use super::walls::{REACH_M, Sample, WallGrid, samples_of, walls_of};
use crate::align::Information;
use crate::geometry::{Point, Polyline, Pose};

/// Points on the walls of each side; at 40 m of wall in sight, one every 0.3 m.
const SAMPLES: usize = 140;
/// A metre that was looked through speaks as loudly against a pose as a fitting one speaks for it; the share of contradicted
/// wall is of both sides' wall, about twice the scan's.
const CONTRADICTION_WEIGHT: f64 = 2.0;
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

/// Lengths of wall, metres.
#[derive(Clone, Copy, Debug, Default)]
struct Lengths {
    all_m: f64,
    explained_m: f64,
    through_m: f64,
}

/// Both sides, ready to be laid on each other many times.
pub(super) struct Judge {
    scan: Vec<Sample>,
    reference: Vec<Sample>,
    pub grid: WallGrid,
    scan_outline: Outline,
    reference_outline: Outline,
    estimate: PoseGaussian,
}

impl Judge {
    pub fn new(scan: &[Polyline], reference: &[Polyline], estimate: PoseGaussian) -> Self {
        let (scan_walls, reference_walls) = (walls_of(scan), walls_of(reference));
        let (scan, reference) = (
            samples_of(&scan_walls, SAMPLES),
            samples_of(&reference_walls, SAMPLES),
        );
        Self {
            scan,
            reference,
            scan_outline: Outline::new(&scan_walls),
            reference_outline: Outline::new(&reference_walls),
            grid: WallGrid::new(reference_walls),
            estimate,
        }
    }

    /// Judges a pose by every `step`-th point; fits count within `reach_m`.
    pub fn verdict(&self, pose: Pose, reach_m: f64, step: usize) -> Verdict {
        let on_reference = self.scan_on_reference(pose, reach_m, step);
        let in_view = self.reference_in_view(pose.inverse(), step);
        let explained = on_reference.explained_m / on_reference.all_m.max(1e-9);
        let contradicted =
            (on_reference.through_m + in_view.through_m) / (on_reference.all_m + in_view.all_m).max(1e-9);
        Verdict {
            explained,
            contradicted,
            score: explained - CONTRADICTION_WEIGHT * contradicted + self.prior(pose),
        }
    }

    /// What the estimate says against a pose: a weak word, for walls that fit alike in two places.
    fn prior(&self, pose: Pose) -> f64 {
        // A deviation of three standard deviations costs as much as a tenth of the walls.
        const COST_AT_3_SIGMA: f64 = 0.1;
        let error = self.estimate.error_of(pose);
        -COST_AT_3_SIGMA / 9.0 * self.estimate.information.quadratic(error)
    }

    fn scan_on_reference(&self, pose: Pose, reach_m: f64, step: usize) -> Lengths {
        let turn = turning(pose);
        let mut lengths = Lengths::default();
        for sample in self.scan.iter().step_by(step) {
            let point = turn(sample.point) + pose.translation();
            lengths.all_m += sample.length_m;
            match self.grid.nearest(point, turn(sample.normal), reach_m) {
                Some(near) => {
                    let share = near.distance_m / reach_m;
                    lengths.explained_m += sample.length_m * (1.0 - share * share);
                }
                None if self.reference_outline.is_through(point) => {
                    lengths.through_m += sample.length_m;
                }
                None => {}
            }
        }
        lengths
    }

    fn reference_in_view(&self, scan_from_reference: Pose, step: usize) -> Lengths {
        let turn = turning(scan_from_reference);
        let mut lengths = Lengths::default();
        for sample in self.reference.iter().step_by(step) {
            let point = turn(sample.point) + scan_from_reference.translation();
            lengths.all_m += sample.length_m;
            if self.scan_outline.is_through(point) {
                lengths.through_m += sample.length_m;
            }
        }
        lengths
    }

    /// Least squares of the scan's points on the reference's lines, the nearest that faces the same way each time.
    pub fn refined(&self, start: Pose) -> PoseGaussian {
        let mut gaussian = PoseGaussian {
            mean: start,
            information: Information::default(),
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
        let turn = turning(pose);
        let mut information = Information::default();
        let mut gradient = [0.0; 3];
        for sample in &self.scan {
            let turned = turn(sample.point);
            let point = turned + pose.translation();
            let Some(near) = self.grid.nearest(point, turn(sample.normal), reach_m) else {
                continue;
            };
            let normal = self.grid.walls()[near.wall].normal;
            let share = near.distance_m / reach_m;
            let weight = (1.0 - share * share).powi(2) * sample.measurements / (WALL_SIGMA_M * WALL_SIGMA_M);
            let jacobian = [normal.x, normal.y, normal.dot(turned.left())];
            information.add_residual(jacobian, weight);
            for (g, j) in gradient.iter_mut().zip(jacobian) {
                *g -= weight * j * near.offset_m;
            }
        }
        (information, gradient)
    }
}

/// Turns vectors like the pose does; sine and cosine are taken once.
fn turning(pose: Pose) -> impl Fn(Point) -> Point {
    let (sin, cos) = pose.theta_rad.sin_cos();
    move |v| Point::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}
