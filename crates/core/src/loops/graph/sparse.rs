//! Sparse symmetric systems of 3 × 3 blocks, solved by elimination in order of least degree.
//!
//! A pose graph of a building is a long chain with some hundreds of cross links: eliminated from its loose ends
//! inwards it hardly fills in. Block LDLᵀ, right-looking. Of two blocks that are each other's transposed, the one in the row of the
//! node that goes first is kept.

use super::elimination::Elimination;
use crate::align::Information;
use crate::geometry::matrix::{
    Column, Matrix, ZERO, add_to, inverted, product, subtract_from, times, transposed, transposed_product,
    transposed_times,
};

/// H · x = −g.
pub(super) struct System<'a> {
    elimination: &'a Elimination,
    /// By node: its block with itself.
    diagonal: Vec<Matrix>,
    /// The others, as the elimination numbers them.
    blocks: Vec<Matrix>,
    gradient: Vec<Column>,
}

impl<'a> System<'a> {
    /// Without any edge.
    pub fn new(elimination: &'a Elimination) -> Self {
        let nodes = elimination.nodes().len();
        Self {
            elimination,
            diagonal: vec![ZERO; nodes],
            blocks: vec![ZERO; elimination.block_count()],
            gradient: vec![[0.0; 3]; nodes],
        }
    }

    /// Adds an edge that the elimination knows: Jacobians by its two ends, information times weight, residual.
    pub fn add(
        &mut self,
        i: usize,
        j: usize,
        jacobians: (&Matrix, &Matrix),
        information: &Information,
        weight: f64,
        residual: Column,
    ) {
        let (a, b) = jacobians;
        let omega = information.scaled(weight).rows;
        let (wa, wb) = (product(&omega, a), product(&omega, b));
        add_to(&mut self.diagonal[i], &transposed_product(a, &wa));
        add_to(&mut self.diagonal[j], &transposed_product(b, &wb));
        let (first, second, block) = if self.elimination.is_before(i, j) {
            (i, j, transposed_product(a, &wb))
        } else {
            (j, i, transposed_product(b, &wa))
        };
        if let Some(k) = self.elimination.block(first, second) {
            add_to(&mut self.blocks[k], &block);
        }
        let pull = times(&omega, residual);
        for (node, jacobian) in [(i, a), (j, b)] {
            for (g, p) in self.gradient[node]
                .iter_mut()
                .zip(transposed_times(jacobian, pull))
            {
                *g += p;
            }
        }
    }

    /// Makes every diagonal entry larger by the share `damping`, and a whiff, so that a loose node stays put.
    pub fn damp(&mut self, damping: f64) {
        for block in &mut self.diagonal {
            for (axis, line) in block.iter_mut().enumerate() {
                line[axis] += line[axis] * damping + 1e-9;
            }
        }
    }

    /// Keeps a node where it is.
    pub fn hold(&mut self, node: usize) {
        if let Some(block) = self.diagonal.get_mut(node) {
            for (axis, line) in block.iter_mut().enumerate() {
                line[axis] += 1e12;
            }
        }
    }

    /// The steps of all nodes; `None` when the system is singular.
    pub fn solve(mut self) -> Option<Vec<Column>> {
        let elimination = self.elimination;
        let mut right: Vec<Column> = self.gradient.iter().map(|g| g.map(|v| -v)).collect();
        let mut inverses = vec![ZERO; right.len()];
        let mut filled = elimination.filled().iter();
        for &node in elimination.nodes() {
            let inverse = inverted(&self.diagonal[node])?;
            inverses[node] = inverse;
            let others = elimination.others(node);
            let (gone, left) = self.blocks.split_at_mut(elimination.blocks(node).end);
            let row = &gone[elimination.blocks(node)];
            for (&a, block) in others.iter().zip(row) {
                let factor = product(&transposed(block), &inverse);
                let pull = times(&factor, right[node]);
                subtract(&mut right[a], pull);
                subtract_from(&mut self.diagonal[a], &product(&factor, block));
                let later = others.iter().zip(row).filter(|b| elimination.is_before(a, *b.0));
                for ((_, with_b), &k) in later.zip(filled.by_ref()) {
                    subtract_from(&mut left[k as usize - gone.len()], &product(&factor, with_b));
                }
            }
        }
        let mut steps = vec![[0.0; 3]; right.len()];
        for &node in elimination.nodes().iter().rev() {
            let mut rest = right[node];
            let row = &self.blocks[elimination.blocks(node)];
            for (&other, block) in elimination.others(node).iter().zip(row) {
                subtract(&mut rest, times(block, steps[other]));
            }
            steps[node] = times(&inverses[node], rest);
        }
        steps.iter().flatten().all(|v| v.is_finite()).then_some(steps)
    }
}

/// a −= b.
fn subtract(a: &mut Column, b: Column) {
    for (x, y) in a.iter_mut().zip(b) {
        *x -= y;
    }
}
