//! What two keyframes say of the share.
//!
//! A return p of one, measured τ turns after the middle beam, was seen from τ·s·m further on, where m is the motion from scan to
//! scan and s the share. With both scans straightened so, p lies on the sides of the other scan: e(x, y, θ, s) = n·(R p(s) + t
//! − q(s)). These are solved for all four by Gauss–Newton steps; what is left of s when the pose is eliminated is the
//! evidence.

use crate::align::{AlignSettings, Information};
use crate::geometry::{Near, Point, Pose, SideGrid};
use crate::keyframe::Keyframe;

/// Slower scanners say nothing, metres and radians from scan to scan.
const LEAST_M: f64 = 0.01;
const LEAST_RAD: f64 = 0.005;
/// Distance within which a return belongs to a side, metres.
const GATE_M: f64 = 0.15;
/// Steps of Gauss–Newton.
const STEPS: usize = 3;
/// Share of the returns that must find a side: otherwise the scans show different things.
const LEAST_MATCHED: f64 = 0.4;
/// How far off the pose may be, standard deviations, metres and radians: wide, so that it takes nothing from the share.
const OFF: f64 = 0.3;

pub(super) struct Evidence {
    pub share: f64,
    pub information: f64,
}

/// The share by which `newer` fits `older` best, near `share`.
pub(super) fn evidence(
    older: &Keyframe,
    newer: &Keyframe,
    share: f64,
    align: &AlignSettings,
) -> Option<Evidence> {
    if is_slow(older.step) && is_slow(newer.step) {
        return None;
    }
    let sides = sides_of(older);
    let start = older.map_from_scan.inverse() * newer.map_from_scan;
    let (mut pose, mut share) = (start, share);
    let mut information = 0.0;
    for _ in 0..STEPS {
        let equations = Equations::new((older, newer), &sides, pose, share, align)?;
        let (moves, change, known) = equations.solve()?;
        pose = Pose::new(pose.x + moves[0], pose.y + moves[1], pose.theta_rad + moves[2]);
        share = (share + change).clamp(-2.0, 2.0);
        information = known;
    }
    let is_near = pose.distance(start) < OFF;
    is_near.then_some(Evidence { share, information })
}

fn is_slow(step: Pose) -> bool {
    step.translation().norm() < LEAST_M && step.theta_rad.abs() < LEAST_RAD
}

fn sides_of(keyframe: &Keyframe) -> SideGrid {
    let mut sides = SideGrid::default();
    for (owner, polyline) in (0..).zip(keyframe.standing_polylines()) {
        sides.insert(owner, polyline.polyline.vertices().iter().copied());
    }
    sides
}

/// How a point of a scan moves with the share, metres for a share of 1; `place` and result in the scan's frame.
fn drift(keyframe: &Keyframe, place: Point) -> Point {
    let turns = keyframe.scan.geometry().turns_from_middle(place.bearing_rad());
    moved_by(keyframe.step, place) * turns
}

/// How it has to move still from where it was straightened to.
fn correction(keyframe: &Keyframe, place: Point, share: f64) -> Point {
    let done = keyframe.scan.turn_motion();
    let turns = keyframe.scan.geometry().turns_from_middle(place.bearing_rad());
    (moved_by(keyframe.step, place) * share - moved_by(done, place)) * turns
}

fn moved_by(motion: Pose, place: Point) -> Point {
    motion.translation() + place.left() * motion.theta_rad
}

/// The normal equations of pose and share.
#[derive(Default)]
struct Equations {
    pose: Information,
    gradient: [f64; 3],
    coupling: [f64; 3],
    share: f64,
    share_gradient: f64,
}

impl Equations {
    fn new(
        (older, newer): (&Keyframe, &Keyframe),
        sides: &SideGrid,
        pose: Pose,
        share: f64,
        align: &AlignSettings,
    ) -> Option<Self> {
        let mut equations = Self::default();
        let (mut asked, mut matched) = (0_usize, 0_usize);
        let mut reader = sides.reader();
        for p in newer.standing_points() {
            asked += 1;
            let arm = pose.rotate(p.point + correction(newer, p.point, share));
            let place = arm + pose.translation();
            let near = Near {
                direction: pose.rotate(p.direction),
                min_cos: 0.85,
                max_distance_m: GATE_M,
                beyond_ends: false,
            };
            let Some(foot) = reader.nearest(place, &near, |_| true) else {
                continue;
            };
            matched += 1;
            let normal = sides.side(foot.side).normal();
            let wall = foot.point + correction(older, foot.point, share);
            let by_share = pose.rotate(drift(newer, p.point)) - drift(older, foot.point);
            let error_m = normal.dot(place - wall);
            let square = (error_m / (align.robust_sigmas * p.sigma_m)).powi(2);
            let weight = p.worth / (p.sigma_m * p.sigma_m * (1.0 + square));
            let j = [normal.x, normal.y, normal.dot(arm.left())];
            equations.add(weight, j, error_m, normal.dot(by_share));
        }
        (matched as f64 > LEAST_MATCHED * asked as f64).then_some(equations)
    }

    /// A residual, its derivatives by the pose and by the share.
    fn add(&mut self, weight: f64, j: [f64; 3], error_m: f64, by_share_m: f64) {
        self.pose.add_residual(j, weight);
        for k in 0..3 {
            self.gradient[k] += weight * j[k] * error_m;
            self.coupling[k] += weight * j[k] * by_share_m;
        }
        self.share += weight * by_share_m * by_share_m;
        self.share_gradient += weight * by_share_m * error_m;
    }

    /// Moves of the pose, change of the share, and the information on the share when the pose is not known.
    fn solve(&self) -> Option<([f64; 3], f64, f64)> {
        let pose = self.pose.plus(&Information::from_sigmas(OFF, OFF, OFF));
        let (by_share, by_error) = (pose.solve(self.coupling)?, pose.solve(self.gradient)?);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let information = self.share - dot(self.coupling, by_share);
        // Where nothing is told (information near 0) the share stays: this 1 is a standard deviation of 1.
        let change = -(self.share_gradient - dot(self.coupling, by_error)) / (information + 1.0);
        let moves = [0, 1, 2].map(|k| -by_error[k] - by_share[k] * change);
        Some((moves, change, information.max(0.0)))
    }
}
