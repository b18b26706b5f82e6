//! Odometry with its large errors of rotation taken out (Fig. 1 (b) of the paper).
//!
//! In: a pose and the sides of every scan. Out: the poses, turned. The paper has "a simple algorithm that corrects
//! significant rotation errors of the odometry by finding rotation angles that maximize the proximity of long lines"
//! and says no more. Here: each scan is turned, in order, to where its long sides agree best with the
//! directions of the long sides of the scans before,
//!
//! δ = argmax_|δ| ≤ 10° w(δ) Σ_i l_i H(φ_i + δ),   H(φ) = Σ_j l_j g(φ − φ_j),
//!
//! over the sides longer than 0.8 m, with length l and direction φ modulo 180° (both faces of a wall count as one
//! direction), a bell g of 1° and a bell w of 6°: a small turn that fits is more likely than a large one that fits a little
//! better. Lengths of steps, and their directions as the robot saw them, stay those of the odometry.

use std::f64::consts::PI;

use polymapper_core::geometry::{Pose, Segment};

/// Shorter sides say too little about a direction.
const LONG_M: f64 = 0.8;
/// Bins of the histogram over half a turn: 0.25° each.
const BINS: usize = 720;
/// Bins that a scan is turned by at most, to either side: 10°.
const REACH: usize = 40;
/// Bins of the standard deviation of the bell of directions: 1°.
const BELL: f64 = 4.0;
/// Bins of that of the bell of turns: 6°. Judged by eye: with 3° the walls of two logs of raw odometry (Intel, ACES) lose their
/// directions, without the bell a log whose poses are good (Orebro) is bent.
const TURN_BELL: f64 = 24.0;

/// Turns each pose so that its long sides, given in the frame of the scan, agree with those of the scans before.
pub fn rotation_corrected(poses: &[Pose], sides: &[Vec<Segment>]) -> Vec<Pose> {
    let mut directions = Directions::default();
    let mut corrected: Vec<Pose> = Vec::with_capacity(poses.len());
    for (k, (&pose, sides)) in poses.iter().zip(sides).enumerate() {
        let start = match corrected.last() {
            Some(&last) => last * poses[k - 1].inverse() * pose,
            None => pose,
        };
        let long = long_sides(sides);
        let turn_rad = directions.best_turn_rad(&long, start.theta_rad);
        let turned = Pose::new(start.x, start.y, start.theta_rad + turn_rad);
        directions.add(&long, turned.theta_rad);
        corrected.push(turned);
    }
    corrected
}

/// Direction and length of the long ones, scan frame.
fn long_sides(sides: &[Segment]) -> Vec<(f64, f64)> {
    sides
        .iter()
        .map(|side| ((side.b - side.a).bearing_rad(), side.length_m()))
        .filter(|&(_, length_m)| length_m >= LONG_M)
        .collect()
}

/// Length of long sides by direction, modulo half a turn, spread by the bell.
struct Directions(Vec<f64>);

impl Default for Directions {
    fn default() -> Self {
        Self(vec![0.0; BINS])
    }
}

impl Directions {
    fn best_turn_rad(&self, sides: &[(f64, f64)], heading_rad: f64) -> f64 {
        let agreement = |turn: usize| -> f64 {
            let at = |direction_rad: f64| (bin(direction_rad + heading_rad) + BINS + turn - REACH) % BINS;
            let fit: f64 = sides
                .iter()
                .map(|&(direction_rad, length_m)| length_m * self.0[at(direction_rad)])
                .sum();
            let away = turn.abs_diff(REACH) as f64 / TURN_BELL;
            fit * (-0.5 * away * away).exp()
        };
        let mut best = (agreement(REACH), REACH);
        // From the middle outwards: of turns that agree alike the smallest is taken.
        for away in 1..=REACH {
            for turn in [REACH - away, REACH + away] {
                let score = agreement(turn);
                if score > best.0 * (1.0 + 1e-9) {
                    best = (score, turn);
                }
            }
        }
        (best.1 as f64 - REACH as f64) * PI / BINS as f64
    }

    fn add(&mut self, sides: &[(f64, f64)], heading_rad: f64) {
        let wide = (3.0 * BELL) as usize;
        for &(direction_rad, length_m) in sides {
            let middle = bin(direction_rad + heading_rad);
            for k in 0..=2 * wide {
                let away = (k as f64 - wide as f64) / BELL;
                self.0[(middle + BINS + k - wide) % BINS] += length_m * (-0.5 * away * away).exp();
            }
        }
    }
}

fn bin(direction_rad: f64) -> usize {
    let share = direction_rad.rem_euclid(PI) / PI;
    (share * BINS as f64) as usize % BINS
}

#[cfg(test)]
mod tests {
    use polymapper_core::geometry::{Point, wrap_rad};

    use super::*;

    /// The walls of a hall as seen from a true heading.
    fn hall(theta_rad: f64) -> Vec<Segment> {
        let corners = [(-4.0, -3.0), (4.0, -3.0), (4.0, 3.0), (-4.0, 3.0)].map(|(x, y)| Point::new(x, y));
        let turn = Pose::new(0.0, 0.0, -theta_rad);
        (0..4)
            .map(|k| Segment::new(turn * corners[k], turn * corners[(k + 1) % 4]))
            .collect()
    }

    #[test]
    fn a_heading_that_drifts_is_held_by_the_walls_and_the_way_becomes_straight() {
        let drift_rad = 0.4_f64.to_radians();
        let mut poses = vec![Pose::IDENTITY];
        for _ in 0..100 {
            poses.push(poses[poses.len() - 1] * Pose::new(0.1, 0.0, drift_rad));
        }
        let sides: Vec<_> = poses.iter().map(|_| hall(0.0)).collect();
        let last = *rotation_corrected(&poses, &sides).last().unwrap();
        assert!(wrap_rad(last.theta_rad).abs() < 0.01, "{last:?}");
        assert!((last.x - 10.0).abs() < 0.05 && last.y.abs() < 0.1, "{last:?}");
    }

    #[test]
    fn a_true_turn_is_not_taken_for_an_error() {
        let poses: Vec<Pose> = (0..30).map(|k| Pose::new(0.0, 0.0, f64::from(k) * 0.2)).collect();
        let sides: Vec<_> = poses.iter().map(|p| hall(p.theta_rad)).collect();
        for (pose, corrected) in poses.iter().zip(rotation_corrected(&poses, &sides)) {
            assert!(wrap_rad(pose.theta_rad - corrected.theta_rad).abs() < 0.01);
        }
    }

    #[test]
    fn scans_without_long_walls_keep_their_poses() {
        let poses = [Pose::IDENTITY, Pose::new(1.0, 2.0, 0.5)];
        assert_eq!(rotation_corrected(&poses, &[hall(0.0), Vec::new()]), poses);
    }
}
