//! Where a graph is loose: stretches of the way that nothing tells well.
//!
//! In: poses that have settled, and the edges. Out: the steps that all edges together leave farther open than walls do, those in
//! a row as one stretch, with the covariance of the motion along it. A map may be wrong there and fit all the same:
//! between round walls, along bare corridors, and where two places looked alike.

use super::{Edge, Elimination, linearise, standing};
use crate::align::Covariance;
use crate::geometry::Pose;
use crate::geometry::matrix::{Column, Matrix, add_to, product, times, transposed};

/// A step that is known worse than this begins a stretch or goes on with it, metres and radians: five times as badly as in rooms.
const OPEN_M: f64 = 0.05;
const OPEN_RAD: f64 = 0.02;
/// A stretch that is known worse than this is loose.
const LOOSE_M: f64 = 0.25;
const LOOSE_RAD: f64 = 0.1;

/// A stretch between two nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Loose {
    pub from: usize,
    pub to: usize,
    /// Of the motion along it, axes of node `from`.
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
        covariance(&jacobians, |i, j| inverse.between(from + i, from + j))
    };
    let is_open = |from: &usize| is_beyond(&step(*from), OPEN_M, OPEN_RAD);
    let open: Vec<usize> = (0..poses.len().saturating_sub(1)).filter(is_open).collect();
    open.chunk_by(|a, b| a + 1 == *b)
        .map(|steps| {
            let (from, to) = (steps[0], steps[steps.len() - 1] + 1);
            let jacobians = jacobians(poses, from, to);
            // Columns of H⁻¹ (A B)ᵀ.
            let columns: Vec<[Column; 2]> = (0..3)
                .map(|row| {
                    let mut right = vec![[0.0; 3]; poses.len()];
                    (right[from], right[to]) = (jacobians.0[row], jacobians.1[row]);
                    let moves = factors.solve(right);
                    [moves[from], moves[to]]
                })
                .collect();
            let rows = [0, 1, 2].map(|r| {
                let (a, b) = (
                    times(&jacobians.0, columns[r][0]),
                    times(&jacobians.1, columns[r][1]),
                );
                [0, 1, 2].map(|c| a[c] + b[c])
            });
            Loose {
                from,
                to,
                covariance: Covariance { rows },
            }
        })
        .filter(|stretch| is_beyond(&stretch.covariance, LOOSE_M, LOOSE_RAD))
        .collect()
}

fn is_beyond(covariance: &Covariance, sigma_m: f64, sigma_rad: f64) -> bool {
    covariance.widest_m() > sigma_m || covariance.rows[2][2] > sigma_rad * sigma_rad
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

/// (A B) C (A B)ᵀ, C by blocks.
fn covariance((a, b): &(Matrix, Matrix), block: impl Fn(usize, usize) -> Matrix) -> Covariance {
    let mut rows = [[0.0; 3]; 3];
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
