//! What the adjustment promises, in a drawn hall.

use super::equations::Equations;
use super::walls::Walls;
use super::{AdjustSettings, adjusted, solve};
use crate::align::Information;
use crate::geometry::{Pose, SideGrid};
use crate::keyframe::Keyframe;
use crate::keyframe::drawn::{Wall, keyframe};
use crate::loops::graph::Edge;
use crate::merge::growing_map::GrowingMap;
use crate::merge::{MergeSettings, merge_all};

/// A hall of 24 m × 4 m with a pillar at one wall, seen from inside.
const HALL: &[Wall] = &[
    &[
        (-12.0, -2.0),
        (12.0, -2.0),
        (12.0, 2.0),
        (-12.0, 2.0),
        (-12.0, -2.0),
    ],
    &[(1.0, -2.0), (1.0, -1.5), (0.5, -1.5), (0.5, -2.0)],
];

/// Somebody walks through the hall, 1 m a step; his heading drifts, and the edges say what he believes.
fn walk() -> (Vec<Pose>, Vec<Keyframe>, Vec<Edge>) {
    let step = Pose::new(1.0, 0.0, 0.0);
    let believed = Pose::new(1.0, 0.0, 0.0007);
    let (mut truth, mut drifted) = (vec![Pose::IDENTITY], vec![Pose::IDENTITY]);
    for k in 0..16 {
        truth.push(truth[k] * step);
        drifted.push(drifted[k] * believed);
    }
    // The map's frame is the first keyframe, 9 m from the wall behind.
    let world_from_map = Pose::new(-8.0, 0.3, 0.0);
    let keyframes = truth.iter().zip(&drifted).map(|(t, d)| Keyframe {
        map_from_scan: *d,
        ..keyframe(HALL, world_from_map * *t)
    });
    let edges = (0..16).map(|k| Edge {
        from: k,
        to: k + 1,
        motion: believed,
        information: Information::from_sigmas(0.02, 0.02, 0.02),
        is_loop: false,
    });
    (truth.clone(), keyframes.collect(), edges.collect())
}

fn walls_of(keyframes: &[Keyframe]) -> SideGrid {
    let mut map = GrowingMap::default();
    merge_all(&mut map, (0..).zip(keyframes), &[], &MergeSettings::default());
    map.skeleton
}

fn farthest_m(poses: &[Pose], truth: &[Pose]) -> f64 {
    let off = poses.iter().zip(truth).map(|(p, t)| p.distance(*t));
    off.fold(0.0, f64::max)
}

#[test]
fn a_long_wall_straightens_the_way_along_it() {
    let (truth, keyframes, edges) = walk();
    let before: Vec<Pose> = keyframes.iter().map(|k| k.map_from_scan).collect();
    let after = adjusted(
        &keyframes,
        &edges,
        &walls_of(&keyframes),
        &AdjustSettings::default(),
    );
    assert!(
        farthest_m(&before, &truth) > 0.08,
        "{}",
        farthest_m(&before, &truth)
    );
    assert!(
        farthest_m(&after, &truth) < 0.01,
        "{}",
        farthest_m(&after, &truth)
    );
    assert_eq!(after[0], Pose::IDENTITY);
}

#[test]
fn conjugate_gradients_find_what_elimination_of_all_unknowns_finds() {
    let (_, keyframes, edges) = walk();
    let settings = AdjustSettings::default();
    let poses: Vec<Pose> = keyframes.iter().map(|k| k.map_from_scan).collect();
    let walls = Walls::seen_by(&keyframes, &walls_of(&keyframes), settings.gate_m);
    let equations = Equations::new(&walls, &keyframes, &poses, &edges, &settings);
    let moves = solve::moves(&equations, &poses).unwrap();
    let lines = equations.line_moves(&moves);
    let expected = dense_solution(&equations);
    let n = poses.len();
    for (k, value) in moves.iter().flatten().chain(lines.iter().flatten()).enumerate() {
        let off = (value - expected[k]).abs();
        assert!(off < 1e-6, "unknown {k} of {n} poses: {value} {}", expected[k]);
    }
}

/// All poses and lines at once, by Gaussian elimination.
fn dense_solution(equations: &Equations) -> Vec<f64> {
    let n = 3 * equations.poses.len();
    let size = n + 2 * equations.lines_inverted.len();
    let mut rows = vec![vec![0.0; size + 1]; size];
    for (k, block) in equations.poses.iter().enumerate() {
        for r in 0..3 {
            for c in 0..3 {
                rows[3 * k + r][3 * k + c] += block[r][c];
            }
            rows[3 * k + r][size] = -equations.pose_gradients[k][r];
        }
    }
    for tie in &equations.ties {
        for r in 0..3 {
            for c in 0..3 {
                rows[3 * tie.from + r][3 * tie.to + c] += tie.from_to[r][c];
                rows[3 * tie.to + c][3 * tie.from + r] += tie.from_to[r][c];
            }
        }
    }
    for (l, inverse) in equations.lines_inverted.iter().enumerate() {
        let determinant = inverse[0] * inverse[2] - inverse[1] * inverse[1];
        let at = n + 2 * l;
        rows[at][at] = inverse[2] / determinant;
        rows[at + 1][at + 1] = inverse[0] / determinant;
        rows[at][at + 1] = -inverse[1] / determinant;
        rows[at + 1][at] = rows[at][at + 1];
        for r in 0..2 {
            rows[at + r][size] = -equations.line_gradients[l][r];
        }
    }
    for sight in &equations.sights {
        for r in 0..3 {
            for c in 0..2 {
                let (pose, line) = (3 * sight.keyframe + r, n + 2 * sight.line + c);
                rows[pose][line] += sight.coupling[r][c];
                rows[line][pose] += sight.coupling[r][c];
            }
        }
    }
    for axis in 0..3 {
        rows[axis][axis] += 1e12;
    }
    for k in 0..size {
        let pivot = (k..size)
            .max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))
            .unwrap();
        rows.swap(k, pivot);
        let row = rows[k].clone();
        for other in &mut rows[k + 1..] {
            let share = other[k] / row[k];
            other.iter_mut().zip(&row).for_each(|(o, r)| *o -= share * r);
        }
    }
    let mut out = vec![0.0; size];
    for k in (0..size).rev() {
        let known: f64 = (k + 1..size).map(|c| rows[k][c] * out[c]).sum();
        out[k] = (rows[k][size] - known) / rows[k][k];
    }
    out
}

#[test]
fn gradients_are_half_the_slopes_of_the_cost() {
    let (_, keyframes, edges) = walk();
    let settings = AdjustSettings::default();
    let poses: Vec<Pose> = keyframes.iter().map(|k| k.map_from_scan).collect();
    let sides = walls_of(&keyframes);
    let walls = Walls::seen_by(&keyframes, &sides, settings.gate_m);
    let equations = Equations::new(&walls, &keyframes, &poses, &edges, &settings);
    let nudge = 1e-6;
    for (axis, shift) in [(0, Pose::new(nudge, 0.0, 0.0)), (2, Pose::new(0.0, 0.0, nudge))] {
        let cost = |sign: f64| {
            let mut moved = poses.clone();
            let p = moved[7];
            moved[7] = Pose::new(
                p.x + sign * shift.x,
                p.y + sign * shift.y,
                p.theta_rad + sign * shift.theta_rad,
            );
            Equations::new(&walls, &keyframes, &moved, &edges, &settings).cost
        };
        let slope = (cost(1.0) - cost(-1.0)) / (2.0 * nudge);
        let gradient = 2.0 * equations.pose_gradients[7][axis];
        assert!(
            (slope - gradient).abs() < 1e-3 * gradient.abs() + 1e-3,
            "{slope} {gradient}"
        );
    }
}
