//! Where a graph is loose: stretches of the way that nothing tells well.
//!
//! In: poses that have settled, and the edges. Out: the steps that all edges together leave farther open than walls do, those in
//! a row as one stretch, with the covariance of the motion along it. A map may be wrong there and fit all the same:
//! between round walls, along bare corridors, and where two places looked alike.

use super::sparse::Factors;
use super::{Edge, Elimination, linearise, standing};
use crate::align::Covariance;
use crate::geometry::Pose;
use crate::geometry::matrix::{Matrix, ZERO, add_to, product, times, transposed};

/// A step that is known worse than this begins a stretch or goes on with it, metres and radians. (The worst of raw intel is known to
/// 0.032 m and 0.013 rad.)
const OPEN_M: f64 = 0.05;
const OPEN_RAD: f64 = 0.02;
/// A stretch that is known worse than this is loose, metres and radians. (Of 60 simulated keyframe logs, seven of the eight wrong ones
/// have such stretches, and six of the others; with 0.125 m, all eight and twelve.)
const LOOSE_M: f64 = 0.25;
const LOOSE_RAD: f64 = 0.1;

/// A stretch between two nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Loose {
    pub from: usize,
    pub to: usize,
    /// Of the motion along the whole of it or along one of its steps, whatever is known least; axes of the node where that begins.
    /// (A place seen again before and after it ties its ends, and leaves open where the scanner was between them.)
    pub covariance: Covariance,
}

/// The loose stretches of the way from node to node, first to last.
pub(crate) fn loose(poses: &[Pose], edges: &[Edge]) -> Vec<Loose> {
    let ends = standing(edges, poses);
    let elimination = Elimination::new(poses.len(), edges.iter().map(|e| (e.from, e.to)));
    let Some(factors) = linearise(edges, &ends, &elimination, 1.0, 0.0).factored() else {
        return Vec::new();
    };
    let inverse = factors.inverse();
    let step = |from: usize| {
        let jacobians = jacobians(poses, from, from + 1);
        (
            from,
            of_step(&jacobians, |i, j| inverse.between(from + i, from + j)),
        )
    };
    let is_open = |step: &(usize, Covariance)| beyond(&step.1, OPEN_M, OPEN_RAD) > 1.0;
    let steps = (0..poses.len().saturating_sub(1)).map(step);
    let open: Vec<(usize, Covariance)> = steps.filter(is_open).collect();
    open.chunk_by(|a, b| a.0 + 1 == b.0)
        .filter_map(|steps| {
            let (from, to) = (steps[0].0, steps[steps.len() - 1].0 + 1);
            let whole = of_stretch(&factors, poses, from, to);
            let by_doubt = |a: &Covariance, b: &Covariance| {
                let doubt = |c: &Covariance| beyond(c, LOOSE_M, LOOSE_RAD);
                doubt(a).total_cmp(&doubt(b))
            };
            let parts = steps.iter().map(|(_, covariance)| *covariance);
            let covariance = parts.chain([whole]).max_by(by_doubt)?;
            let is_loose = beyond(&covariance, LOOSE_M, LOOSE_RAD) > 1.0;
            is_loose.then_some(Loose { from, to, covariance })
        })
        .collect()
}

/// How many times as large the standard deviations are as these, the larger of place and heading.
fn beyond(covariance: &Covariance, sigma_m: f64, sigma_rad: f64) -> f64 {
    let turn_rad = covariance.rows[2][2].max(0.0).sqrt();
    (covariance.widest_m() / sigma_m).max(turn_rad / sigma_rad)
}

/// Covariance of the motion between any two nodes, (A B) H⁻¹ (A B)ᵀ.
fn of_stretch(factors: &Factors, poses: &[Pose], from: usize, to: usize) -> Covariance {
    let (a, b) = jacobians(poses, from, to);
    let mut rows = ZERO;
    for column in 0..3 {
        let mut right = vec![[0.0; 3]; poses.len()];
        (right[from], right[to]) = (a[column], b[column]);
        let moves = factors.solve(right);
        let (by_from, by_to) = (times(&a, moves[from]), times(&b, moves[to]));
        for row in 0..3 {
            rows[row][column] = by_from[row] + by_to[row];
        }
    }
    Covariance { rows }
}

/// Derivatives of the motion between two nodes by their poses.
fn jacobians(poses: &[Pose], from: usize, to: usize) -> (Matrix, Matrix) {
    let edge = Edge {
        from,
        to,
        motion: Pose::IDENTITY,
        information: crate::align::Information::default(),
        is_loop: false,
    };
    edge.at(poses).jacobians()
}

/// The same for nodes that are tied, H⁻¹ by its blocks.
fn of_step((a, b): &(Matrix, Matrix), block: impl Fn(usize, usize) -> Matrix) -> Covariance {
    let mut rows = ZERO;
    for (i, left) in [a, b].into_iter().enumerate() {
        for (j, right) in [a, b].into_iter().enumerate() {
            add_to(
                &mut rows,
                &product(&product(left, &block(i, j)), &transposed(right)),
            );
        }
    }
    Covariance { rows }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::align::Information;

    /// Keyframes 1 m apart along x; the steps in `open` are known to 0.3 m along it, the others to 1 cm.
    fn row(count: usize, open: &[usize]) -> (Vec<Pose>, Vec<Edge>) {
        let poses = (0..count).map(|k| Pose::new(k as f64, 0.0, 0.0)).collect();
        let step = |from: usize| {
            let along_m = if open.contains(&from) { 0.3 } else { 0.01 };
            tie(from, from + 1, along_m)
        };
        (poses, (0..count - 1).map(step).collect())
    }

    fn tie(from: usize, to: usize, along_m: f64) -> Edge {
        Edge {
            from,
            to,
            motion: Pose::new(to as f64 - from as f64, 0.0, 0.0),
            information: Information::from_sigmas(along_m, 0.01, 0.001),
            is_loop: to != from + 1,
        }
    }

    fn stretches(poses: &[Pose], edges: &[Edge]) -> Vec<(usize, usize)> {
        loose(poses, edges).iter().map(|l| (l.from, l.to)).collect()
    }

    #[test]
    fn open_steps_in_a_row_are_one_stretch_with_what_they_leave_open_together() {
        let (poses, edges) = row(20, &[5, 6, 7, 8, 15]);
        let found = loose(&poses, &edges);
        assert_eq!(stretches(&poses, &edges), [(5, 9), (15, 16)]);
        let sigma_m = found[0].covariance.widest_m();
        assert!((sigma_m - 0.6).abs() < 1e-6, "four steps of 0.3 m: {sigma_m}");
    }

    #[test]
    fn what_a_place_seen_again_tells_is_loose_no_more() {
        let (poses, mut edges) = row(20, &[5, 15]);
        edges.push(tie(2, 9, 0.02));
        assert_eq!(stretches(&poses, &edges), [(15, 16)]);
    }

    #[test]
    fn a_scan_that_hangs_between_two_that_are_known_is_loose() {
        let (poses, mut edges) = row(20, &[5, 6]);
        edges.push(tie(4, 8, 0.02));
        let found = loose(&poses, &edges);
        assert_eq!(stretches(&poses, &edges), [], "{found:?}");
        let (poses, mut edges) = row(20, &[]);
        for edge in &mut edges[5..7] {
            edge.information = Information::from_sigmas(0.5, 0.01, 0.001);
        }
        edges.push(tie(4, 8, 0.02));
        let found = loose(&poses, &edges);
        assert_eq!(stretches(&poses, &edges), [(5, 7)]);
        let sigma_m = found[0].covariance.widest_m();
        assert!(
            (sigma_m - 0.354).abs() < 0.01,
            "half way to either side: {sigma_m}"
        );
    }

    #[test]
    fn covariances_are_those_of_the_whole_inverted() {
        // A ring, so that elimination fills something in: against the system solved column by column.
        let (poses, mut edges) = row(7, &[2]);
        edges.extend([tie(0, 6, 0.05), tie(1, 4, 0.2)]);
        let ends = standing(&edges, &poses);
        let elimination = Elimination::new(poses.len(), edges.iter().map(|e| (e.from, e.to)));
        let factors = linearise(&edges, &ends, &elimination, 1.0, 0.0)
            .factored()
            .unwrap();
        let inverse = factors.inverse();
        for edge in &edges {
            for axis in 0..3 {
                let mut unit = vec![[0.0; 3]; poses.len()];
                unit[edge.to][axis] = 1.0;
                let column = factors.solve(unit)[edge.from];
                let block = inverse.between(edge.from, edge.to);
                for (row, value) in column.into_iter().enumerate() {
                    assert!((block[row][axis] - value).abs() < 1e-9, "{edge:?}");
                }
            }
        }
    }

    #[test]
    fn a_map_without_a_way_is_not_loose() {
        assert!(loose(&[], &[]).is_empty());
        assert!(loose(&[Pose::IDENTITY], &[]).is_empty());
    }
}
