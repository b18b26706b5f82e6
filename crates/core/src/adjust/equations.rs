//! The normal equations of poses and lines at one place.
//!
//! The residual of a return p of keyframe k on line l is e = n·(R p + t − c): n the line's normal, c its middle. Its
//! derivatives are j = (n, n·(R p)⊥) by the pose (x, y, θ) and q = (−1, −d·(R p + t − c)) by the line's shift along n and
//! its turn about c (d its direction).

use super::AdjustSettings;
use super::walls::{View, Walls};
use crate::geometry::matrix::{
    Column, Matrix, ZERO, add_to, product, times, transposed_product, transposed_times,
};
use crate::geometry::{Point, Pose};
use crate::keyframe::Keyframe;
use crate::loops::graph::Edge;

/// A line without ends, free space on its left.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub middle: Point,
    pub direction: Point,
}

/// A symmetric 2 × 2 matrix: shift, both, turn.
type Pair = [f64; 3];

/// What a line is held by besides returns, so that none is undetermined: standard deviations of 0.1 m and 0.1 rad.
const HELD: Pair = [100.0, 0.0, 100.0];

/// How a keyframe's pose and a line depend on each other: Σ w j qᵀ.
pub(super) struct Sight {
    pub keyframe: usize,
    pub line: usize,
    pub coupling: [[f64; 2]; 3],
}

/// An edge of the pose graph.
pub(super) struct Tie {
    pub from: usize,
    pub to: usize,
    pub from_from: Matrix,
    pub from_to: Matrix,
    pub to_to: Matrix,
}

/// H · (poses, lines) = −g.
pub(super) struct Equations {
    /// Blocks of the poses and their gradients: of the returns and the edges.
    pub poses: Vec<Matrix>,
    pub pose_gradients: Vec<Column>,
    /// Blocks of the lines, inverted, and their gradients.
    pub lines_inverted: Vec<Pair>,
    pub line_gradients: Vec<[f64; 2]>,
    pub sights: Vec<Sight>,
    pub ties: Vec<Tie>,
    /// What is minimised.
    pub cost: f64,
}

impl Equations {
    pub fn new(
        walls: &Walls,
        keyframes: &[Keyframe],
        poses: &[Pose],
        edges: &[Edge],
        settings: &AdjustSettings,
    ) -> Self {
        let mut equations = Self {
            poses: vec![ZERO; poses.len()],
            pose_gradients: vec![[0.0; 3]; poses.len()],
            lines_inverted: vec![HELD; walls.lines.len()],
            line_gradients: vec![[0.0; 2]; walls.lines.len()],
            sights: Vec::with_capacity(walls.views.len()),
            ties: Vec::with_capacity(edges.len()),
            cost: 0.0,
        };
        for view in &walls.views {
            let line = &walls.lines[view.line];
            equations.add_view(
                view,
                line,
                &keyframes[view.keyframe],
                poses[view.keyframe],
                settings,
            );
        }
        for edge in edges {
            equations.add_edge(edge, poses);
        }
        for line in &mut equations.lines_inverted {
            *line = inverse_of(*line);
        }
        equations
    }

    fn add_view(
        &mut self,
        view: &View,
        line: &Line,
        keyframe: &Keyframe,
        pose: Pose,
        settings: &AdjustSettings,
    ) {
        let normal = line.direction.left();
        let (block, gradient) = (
            &mut self.poses[view.keyframe],
            &mut self.pose_gradients[view.keyframe],
        );
        let (line_block, line_gradient) = (
            &mut self.lines_inverted[view.line],
            &mut self.line_gradients[view.line],
        );
        let mut coupling = [[0.0; 2]; 3];
        let pose = pose.isometry();
        for point in view.points.iter().map(|&k| &keyframe.points[k as usize]) {
            let arm = pose.rotate(point.point);
            let from_middle = arm + pose.translation() - line.middle;
            let error_m = normal.dot(from_middle);
            let square = (error_m / (settings.robust_sigmas * point.sigma_m)).powi(2);
            let weight = point.worth / (point.sigma_m * point.sigma_m * (1.0 + square));
            self.cost += point.worth * settings.robust_sigmas.powi(2) * square.ln_1p();
            let j = [normal.x, normal.y, normal.dot(arm.left())];
            let q = [-1.0, -line.direction.dot(from_middle)];
            for r in 0..3 {
                for c in 0..3 {
                    block[r][c] += weight * j[r] * j[c];
                }
                coupling[r][0] += weight * j[r] * q[0];
                coupling[r][1] += weight * j[r] * q[1];
                gradient[r] += weight * j[r] * error_m;
            }
            line_block[0] += weight * q[0] * q[0];
            line_block[1] += weight * q[0] * q[1];
            line_block[2] += weight * q[1] * q[1];
            line_gradient[0] += weight * q[0] * error_m;
            line_gradient[1] += weight * q[1] * error_m;
        }
        self.sights.push(Sight {
            keyframe: view.keyframe,
            line: view.line,
            coupling,
        });
    }

    fn add_edge(&mut self, edge: &Edge, poses: &[Pose]) {
        let at = edge.at(poses);
        let (cost, weight) = at.cost(1.0);
        self.cost += cost;
        let omega = edge.information.scaled(weight).rows;
        let (from, to) = at.jacobians();
        let (pull_from, pull_to) = (product(&omega, &from), product(&omega, &to));
        let tie = Tie {
            from: edge.from,
            to: edge.to,
            from_from: transposed_product(&from, &pull_from),
            from_to: transposed_product(&from, &pull_to),
            to_to: transposed_product(&to, &pull_to),
        };
        add_to(&mut self.poses[tie.from], &tie.from_from);
        add_to(&mut self.poses[tie.to], &tie.to_to);
        let pull = times(&omega, at.residual);
        for (end, jacobian) in [(edge.from, from), (edge.to, to)] {
            for (g, p) in self.pose_gradients[end]
                .iter_mut()
                .zip(transposed_times(&jacobian, pull))
            {
                *g += p;
            }
        }
        self.ties.push(tie);
    }

    /// How the lines move when the poses make `moves`: shift, metres, and turn, radians.
    pub fn line_moves(&self, moves: &[Column]) -> Vec<[f64; 2]> {
        let mut pulls = self.line_gradients.clone();
        self.add_pulls(moves, &mut pulls);
        pulls
            .iter()
            .zip(&self.lines_inverted)
            .map(|(pull, inverse)| pair_times(inverse, *pull).map(|v| -v))
            .collect()
    }

    /// Adds what moves of the poses pull at the lines.
    pub fn add_pulls(&self, moves: &[Column], pulls: &mut [[f64; 2]]) {
        for sight in &self.sights {
            let pull = &mut pulls[sight.line];
            for (row, m) in sight.coupling.iter().zip(moves[sight.keyframe]) {
                pull[0] += row[0] * m;
                pull[1] += row[1] * m;
            }
        }
    }
}

fn inverse_of(p: Pair) -> Pair {
    let determinant = p[0] * p[2] - p[1] * p[1];
    [p[2] / determinant, -p[1] / determinant, p[0] / determinant]
}

/// p · v.
pub(super) fn pair_times(p: &Pair, v: [f64; 2]) -> [f64; 2] {
    [p[0] * v[0] + p[1] * v[1], p[1] * v[0] + p[2] * v[1]]
}
