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
    pub fn solve(self) -> Option<Vec<Column>> {
        let right: Vec<Column> = self.gradient.iter().map(|g| g.map(|v| -v)).collect();
        let steps = self.factored()?.solve(right);
        steps.iter().flatten().all(|v| v.is_finite()).then_some(steps)
    }

    /// H = L D Lᵀ; `None` when it is singular.
    pub fn factored(mut self) -> Option<Factors<'a>> {
        let elimination = self.elimination;
        let mut inverses = vec![ZERO; self.diagonal.len()];
        let mut factors = vec![ZERO; self.blocks.len()];
        let mut filled = elimination.filled().iter();
        for &node in elimination.nodes() {
            let inverse = inverted(&self.diagonal[node])?;
            inverses[node] = inverse;
            let others = elimination.others(node);
            let range = elimination.blocks(node);
            let (gone, left) = self.blocks.split_at_mut(range.end);
            let row = &gone[range.clone()];
            for ((&a, block), factor) in others.iter().zip(row).zip(&mut factors[range]) {
                *factor = product(&transposed(block), &inverse);
                subtract_from(&mut self.diagonal[a], &product(factor, block));
                let later = others.iter().zip(row).filter(|b| elimination.is_before(a, *b.0));
                for ((_, with_b), &k) in later.zip(filled.by_ref()) {
                    subtract_from(&mut left[k as usize - gone.len()], &product(factor, with_b));
                }
            }
        }
        Some(Factors {
            elimination,
            inverses,
            blocks: self.blocks,
            factors,
        })
    }
}

/// A system taken apart, for any number of right sides.
pub(super) struct Factors<'a> {
    elimination: &'a Elimination,
    /// By node: D⁻¹.
    inverses: Vec<Matrix>,
    /// As the elimination numbers them: what was left of H when the node went, B; and Bᵀ D⁻¹.
    blocks: Vec<Matrix>,
    factors: Vec<Matrix>,
}

impl Factors<'_> {
    /// H⁻¹ · `right`.
    pub fn solve(&self, mut right: Vec<Column>) -> Vec<Column> {
        for &node in self.elimination.nodes() {
            let row = &self.factors[self.elimination.blocks(node)];
            for (&a, factor) in self.elimination.others(node).iter().zip(row) {
                let pull = times(factor, right[node]);
                subtract(&mut right[a], pull);
            }
        }
        let mut steps = vec![[0.0; 3]; right.len()];
        for &node in self.elimination.nodes().iter().rev() {
            let mut rest = right[node];
            let row = &self.blocks[self.elimination.blocks(node)];
            for (&other, block) in self.elimination.others(node).iter().zip(row) {
                subtract(&mut rest, times(block, steps[other]));
            }
            steps[node] = times(&self.inverses[node], rest);
        }
        steps
    }

    /// Those blocks of H⁻¹ that H has, or that elimination fills in (Erisman and Tinney 1975): no more work than taking H apart.
    pub fn inverse(&self) -> Inverse<'_> {
        let elimination = self.elimination;
        let mut inverse = Inverse {
            elimination,
            diagonal: self.inverses.clone(),
            blocks: vec![ZERO; self.blocks.len()],
        };
        for &node in elimination.nodes().iter().rev() {
            let range = elimination.blocks(node);
            let others = elimination.others(node);
            let factors = &self.factors[range.clone()];
            for (&j, at) in others.iter().zip(range) {
                let mut block = ZERO;
                for (&k, factor) in others.iter().zip(factors) {
                    subtract_from(&mut block, &transposed_product(factor, &inverse.between(k, j)));
                }
                inverse.blocks[at] = block;
            }
            let row = &inverse.blocks[elimination.blocks(node)];
            for (factor, block) in factors.iter().zip(row) {
                let own = transposed_product(factor, &transposed(block));
                subtract_from(&mut inverse.diagonal[node], &own);
            }
        }
        inverse
    }
}

/// Blocks of H⁻¹: covariances.
pub(super) struct Inverse<'a> {
    elimination: &'a Elimination,
    diagonal: Vec<Matrix>,
    blocks: Vec<Matrix>,
}

impl Inverse<'_> {
    /// Of two nodes that are tied, or of one with itself; zero where they are not tied.
    pub fn between(&self, i: usize, j: usize) -> Matrix {
        let block = |first, second| self.elimination.block(first, second).map(|k| self.blocks[k]);
        let found = match i == j {
            true => Some(self.diagonal[i]),
            false if self.elimination.is_before(i, j) => block(i, j),
            false => block(j, i).map(|b| transposed(&b)),
        };
        found.unwrap_or(ZERO)
    }
}

/// a −= b.
fn subtract(a: &mut Column, b: Column) {
    for (x, y) in a.iter_mut().zip(b) {
        *x -= y;
    }
}
