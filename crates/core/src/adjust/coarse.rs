//! The few large moves that conjugate gradients are slowest to find.
//!
//! In: the equations of all poses. Out: for what is left of their right-hand side, the moves of whole stretches of the way that
//! answer it best. One wall holds its neighbours to a millimetre, so that a bend all along a building is answered by hardly any
//! force; from keyframe to keyframe it takes hundreds of rounds to spread. Here stretches move stiffly, from one to the next
//! evenly (a coarse space as in multigrid; Nicolaides 1987), and their few hundred equations are solved at once.

use super::equations::{Equations, pair_times};
use crate::geometry::matrix::{Column, Matrix, product, transposed, transposed_product, transposed_times};
use crate::geometry::{Point, Pose};

/// Keyframes of a stretch at the least.
const LEAST_STRETCH: usize = 8;
/// Stretches at the most: their equations are solved by elimination, which takes the cube of their number.
const MOST_STRETCHES: usize = 64;

/// See the module.
pub(super) struct Coarse {
    /// By keyframe but the first, which stays: the two joints between stretches that move it, and how.
    parts: Vec<[Part; 2]>,
    joints: usize,
    /// Lower triangle of the Cholesky factor of the joints' equations, row by row.
    factor: Vec<Vec<f64>>,
}

/// How a pose moves with a joint: its share of x, y and turn about the joint's place.
#[derive(Clone, Copy)]
struct Part {
    joint: usize,
    moves: Matrix,
}

impl Coarse {
    /// `None` when the equations leave something open.
    pub fn new(equations: &Equations, poses: &[Pose]) -> Option<Self> {
        let stretch = LEAST_STRETCH.max(poses.len().div_ceil(MOST_STRETCHES));
        let parts: Vec<[Part; 2]> = (0..poses.len()).map(|k| parts_of(k, stretch, poses)).collect();
        let joints = (poses.len().saturating_sub(1)) / stretch + 2;
        let mut matrix = vec![vec![0.0; 3 * joints]; 3 * joints];
        add_poses(&mut matrix, equations, &parts);
        add_ties(&mut matrix, equations, &parts);
        take_lines(&mut matrix, equations, &parts, joints);
        let factor = factored(matrix)?;
        Some(Self {
            parts,
            joints,
            factor,
        })
    }

    /// Adds to `moves` those of the stretches that answer `forces`.
    pub fn add_answer(&self, forces: &[Column], moves: &mut [Column]) {
        let mut joints = vec![0.0; 3 * self.joints];
        for (parts, force) in self.parts.iter().zip(forces).skip(1) {
            for part in parts {
                let pull = transposed_times(&part.moves, *force);
                for (at, p) in joints[3 * part.joint..].iter_mut().zip(pull) {
                    *at += p;
                }
            }
        }
        self.solve(&mut joints);
        for (parts, moved) in self.parts.iter().zip(moves).skip(1) {
            for part in parts {
                let joint = &joints[3 * part.joint..3 * part.joint + 3];
                for (m, row) in moved.iter_mut().zip(&part.moves) {
                    *m += row[0] * joint[0] + row[1] * joint[1] + row[2] * joint[2];
                }
            }
        }
    }

    /// Puts the solution in the place of the right-hand side.
    fn solve(&self, x: &mut [f64]) {
        for (k, row) in self.factor.iter().enumerate() {
            let known: f64 = row[..k].iter().zip(&*x).map(|(l, x)| l * x).sum();
            x[k] = (x[k] - known) / row[k];
        }
        for (k, row) in self.factor.iter().enumerate().rev() {
            x[k] /= row[k];
            let value = x[k];
            for (x, l) in x.iter_mut().zip(&row[..k]) {
                *x -= l * value;
            }
        }
    }
}

fn parts_of(number: usize, stretch: usize, poses: &[Pose]) -> [Part; 2] {
    let (joint, within) = (number / stretch, number % stretch);
    let share = within as f64 / stretch as f64;
    let part = |joint: usize, share: f64| {
        let place: Point = poses[(joint * stretch).min(poses.len() - 1)].translation();
        let arm = poses[number].translation() - place;
        Part {
            joint,
            moves: [
                [share, 0.0, -share * arm.y],
                [0.0, share, share * arm.x],
                [0.0, 0.0, share],
            ],
        }
    };
    [part(joint, 1.0 - share), part(joint + 1, share)]
}

/// Adds a block of two poses as the joints feel it.
fn add_block(matrix: &mut [Vec<f64>], from: &[Part; 2], block: &Matrix, to: &[Part; 2]) {
    for b in to {
        let pulled = product(block, &b.moves);
        for a in from {
            let felt = transposed_product(&a.moves, &pulled);
            for (row, line) in matrix[3 * a.joint..].iter_mut().zip(felt) {
                for (cell, value) in row[3 * b.joint..].iter_mut().zip(line) {
                    *cell += value;
                }
            }
        }
    }
}

fn add_poses(matrix: &mut [Vec<f64>], equations: &Equations, parts: &[[Part; 2]]) {
    for (block, parts) in equations.poses.iter().zip(parts).skip(1) {
        add_block(matrix, parts, block, parts);
    }
}

fn add_ties(matrix: &mut [Vec<f64>], equations: &Equations, parts: &[[Part; 2]]) {
    for tie in equations.ties.iter().filter(|t| t.from > 0 && t.to > 0) {
        let (from, to) = (&parts[tie.from], &parts[tie.to]);
        add_block(matrix, from, &tie.from_to, to);
        add_block(matrix, to, &transposed(&tie.from_to), from);
    }
}

/// Takes off what the lines give way.
fn take_lines(matrix: &mut [Vec<f64>], equations: &Equations, parts: &[[Part; 2]], joints: usize) {
    let mut of_line: Vec<Vec<usize>> = vec![Vec::new(); equations.lines_inverted.len()];
    for (number, sight) in equations.sights.iter().enumerate() {
        if sight.keyframe > 0 {
            of_line[sight.line].push(number);
        }
    }
    let mut pulls = vec![[0.0; 2]; 3 * joints];
    let mut touched: Vec<usize> = Vec::new();
    for (sights, inverse) in of_line.iter().zip(&equations.lines_inverted) {
        touched.clear();
        for &number in sights {
            let sight = &equations.sights[number];
            for part in &parts[sight.keyframe] {
                if touched.last() != Some(&part.joint) {
                    touched.push(part.joint);
                }
                for axis in 0..3 {
                    let pull = &mut pulls[3 * part.joint + axis];
                    for (moves, coupling) in part.moves.iter().zip(&sight.coupling) {
                        pull[0] += moves[axis] * coupling[0];
                        pull[1] += moves[axis] * coupling[1];
                    }
                }
            }
        }
        touched.sort_unstable();
        touched.dedup();
        let rows = || touched.iter().flat_map(|joint| 3 * joint..3 * joint + 3);
        for a in rows() {
            let given = pair_times(inverse, pulls[a]);
            for b in rows().take_while(|&b| b <= a) {
                matrix[a][b] -= given[0] * pulls[b][0] + given[1] * pulls[b][1];
            }
        }
        for a in rows() {
            pulls[a] = [0.0; 2];
        }
    }
}

/// The lower triangle of its Cholesky factor; with a whiff added, so that stretches that nothing holds stay where they are.
fn factored(mut matrix: Vec<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
    for k in 0..matrix.len() {
        let (above, below) = matrix.split_at_mut(k);
        let row = &mut below[0];
        for (j, other) in above.iter().enumerate() {
            let known: f64 = row[..j].iter().zip(&other[..j]).map(|(a, b)| a * b).sum();
            row[j] = (row[j] - known) / other[j];
        }
        let known: f64 = row[..k].iter().map(|a| a * a).sum();
        let whiff = 1e-6 + 1e-9 * row[k];
        let left = row[k] + whiff - known;
        row[k] = (left > 0.0).then(|| left.sqrt())?;
    }
    Some(matrix)
}
