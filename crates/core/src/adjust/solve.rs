//! The moves of all poses that solve the equations; lines eliminated, the rest by conjugate gradients.
//!
//! A long wall ties hundreds of poses to each other, and the matrix without the lines would be nearly full; multiplying
//! by it costs no more than there are views. Before it stand the inverse of its diagonal blocks and, for moves of whole
//! stretches of the way, a coarse solution (`coarse`): a building then takes 20 rounds, without it 200.

use super::coarse::Coarse;
use super::equations::{Equations, pair_times};
use crate::geometry::Pose;
use crate::geometry::matrix::{Column, Matrix, inverted, times};

/// Rounds at the most.
const MOST_ROUNDS: usize = 1000;
/// The squared residual shrinks by so much.
const PRECISION: f64 = 1e-10;

/// The moves of `poses`; the first one stays. `None` when nothing determines them.
pub(super) fn moves(equations: &Equations, poses: &[Pose]) -> Option<Vec<Column>> {
    let before = preconditioner(equations)?;
    let coarse = Coarse::new(equations, poses);
    let apply = |v: &[Column]| -> Vec<Column> {
        let mut out: Vec<Column> = before.iter().zip(v).map(|(b, v)| times(b, *v)).collect();
        if let Some(coarse) = &coarse {
            coarse.add_answer(v, &mut out);
        }
        out
    };
    let mut left = right_hand_side(equations);
    let mut out = vec![[0.0; 3]; left.len()];
    let mut scaled = apply(&left);
    let mut direction = scaled.clone();
    let mut size = dot(&left, &scaled);
    let wanted = PRECISION * size;
    for _ in 0..MOST_ROUNDS {
        if size <= wanted {
            break;
        }
        let changed = reduced_times(equations, &direction);
        let step = size / dot(&direction, &changed);
        add(&mut out, step, &direction);
        add(&mut left, -step, &changed);
        scaled = apply(&left);
        let new = dot(&left, &scaled);
        let kept = new / size;
        size = new;
        for (d, s) in direction.iter_mut().flatten().zip(scaled.iter().flatten()) {
            *d = s + kept * *d;
        }
    }
    out.iter().flatten().all(|v| v.is_finite()).then_some(out)
}

/// −g of the poses after the lines are eliminated.
fn right_hand_side(equations: &Equations) -> Vec<Column> {
    let mut out: Vec<Column> = equations.pose_gradients.iter().map(|g| g.map(|v| -v)).collect();
    let lines: Vec<[f64; 2]> = equations
        .line_gradients
        .iter()
        .zip(&equations.lines_inverted)
        .map(|(g, inverse)| pair_times(inverse, *g))
        .collect();
    for sight in &equations.sights {
        let line = lines[sight.line];
        for (o, row) in out[sight.keyframe].iter_mut().zip(&sight.coupling) {
            *o += row[0] * line[0] + row[1] * line[1];
        }
    }
    hold_first(&mut out);
    out
}

/// The matrix without the lines, times a vector.
fn reduced_times(equations: &Equations, v: &[Column]) -> Vec<Column> {
    let mut out: Vec<Column> = equations.poses.iter().zip(v).map(|(b, v)| times(b, *v)).collect();
    let mut pulls = vec![[0.0; 2]; equations.lines_inverted.len()];
    equations.add_pulls(v, &mut pulls);
    for (pull, inverse) in pulls.iter_mut().zip(&equations.lines_inverted) {
        *pull = pair_times(inverse, *pull);
    }
    for sight in &equations.sights {
        let pull = pulls[sight.line];
        for (o, row) in out[sight.keyframe].iter_mut().zip(&sight.coupling) {
            *o -= row[0] * pull[0] + row[1] * pull[1];
        }
    }
    for tie in &equations.ties {
        let (from, to) = (v[tie.from], v[tie.to]);
        for r in 0..3 {
            for c in 0..3 {
                out[tie.from][r] += tie.from_to[r][c] * to[c];
                out[tie.to][r] += tie.from_to[c][r] * from[c];
            }
        }
    }
    hold_first(&mut out);
    out
}

/// Inverses of the diagonal blocks.
fn preconditioner(equations: &Equations) -> Option<Vec<Matrix>> {
    let mut blocks = equations.poses.clone();
    for sight in &equations.sights {
        let block = &mut blocks[sight.keyframe];
        for (row, a) in block.iter_mut().zip(&sight.coupling) {
            let pull = pair_times(&equations.lines_inverted[sight.line], *a);
            for (cell, b) in row.iter_mut().zip(&sight.coupling) {
                *cell -= pull[0] * b[0] + pull[1] * b[1];
            }
        }
    }
    for block in &mut blocks {
        for (axis, row) in block.iter_mut().enumerate() {
            // A whiff, so that a pose that nothing holds stays where it is.
            row[axis] += 1e-6 + 1e-9 * row[axis].abs();
        }
    }
    blocks.iter().map(inverted).collect()
}

/// The first keyframe is the map's frame.
fn hold_first(v: &mut [Column]) {
    if let Some(first) = v.first_mut() {
        *first = [0.0; 3];
    }
}

fn dot(a: &[Column], b: &[Column]) -> f64 {
    a.iter()
        .flatten()
        .zip(b.iter().flatten())
        .map(|(a, b)| a * b)
        .sum()
}

/// a += share · b.
fn add(a: &mut [Column], share: f64, b: &[Column]) {
    for (a, b) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        *a += share * b;
    }
}
