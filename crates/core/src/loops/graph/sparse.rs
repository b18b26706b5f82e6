//! Sparse symmetric systems of 3 × 3 blocks, solved by elimination in order of least degree.
//!
//! A pose graph of a building is a long chain with some hundreds of cross links: eliminated from its loose ends
//! inwards it hardly fills in. Block LDLᵀ, right-looking.

use std::collections::{BTreeMap, BTreeSet};

use super::block::{
    Block, Column, ZERO, add_to, inverted, product, subtract_from, times, transposed, transposed_product,
    transposed_times,
};
use crate::align::Information;

/// H · x = −g.
pub(super) struct System {
    /// By node: its neighbours' blocks, itself among them; symmetric, both halves stored.
    rows: Vec<BTreeMap<usize, Block>>,
    gradient: Vec<Column>,
}

impl System {
    pub fn new(nodes: usize) -> Self {
        let rows = (0..nodes).map(|k| BTreeMap::from([(k, ZERO)])).collect();
        Self {
            rows,
            gradient: vec![[0.0; 3]; nodes],
        }
    }

    /// Adds an edge: Jacobians by its two ends, information times weight, residual.
    pub fn add(
        &mut self,
        i: usize,
        j: usize,
        jacobians: (&Block, &Block),
        information: &Information,
        weight: f64,
        residual: Column,
    ) {
        let (a, b) = jacobians;
        let omega = information.scaled(weight).rows;
        let (wa, wb) = (product(&omega, a), product(&omega, b));
        add_to(self.block(i, i), &transposed_product(a, &wa));
        add_to(self.block(i, j), &transposed_product(a, &wb));
        add_to(self.block(j, i), &transposed_product(b, &wa));
        add_to(self.block(j, j), &transposed_product(b, &wb));
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
        for (k, row) in self.rows.iter_mut().enumerate() {
            if let Some(block) = row.get_mut(&k) {
                for (axis, line) in block.iter_mut().enumerate() {
                    line[axis] += line[axis] * damping + 1e-9;
                }
            }
        }
    }

    /// Keeps a node where it is.
    pub fn hold(&mut self, node: usize) {
        if let Some(block) = self.rows.get_mut(node).and_then(|row| row.get_mut(&node)) {
            for (axis, line) in block.iter_mut().enumerate() {
                line[axis] += 1e12;
            }
        }
    }

    fn block(&mut self, i: usize, j: usize) -> &mut Block {
        self.rows[i].entry(j).or_insert(ZERO)
    }

    /// The steps of all nodes; `None` when the system is singular.
    pub fn solve(mut self) -> Option<Vec<Column>> {
        let n = self.rows.len();
        let mut queue: BTreeSet<(usize, usize)> =
            self.rows.iter().enumerate().map(|(k, r)| (r.len(), k)).collect();
        let mut order = Vec::with_capacity(n);
        let mut right: Vec<Column> = self.gradient.iter().map(|g| g.map(|v| -v)).collect();
        let mut inverses = vec![ZERO; n];
        while let Some((_, node)) = queue.pop_first() {
            let row = std::mem::take(&mut self.rows[node]);
            let inverse = inverted(row.get(&node)?)?;
            inverses[node] = inverse;
            let others: Vec<usize> = row.keys().copied().filter(|&k| k != node).collect();
            for &a in &others {
                let degree = self.rows[a].len();
                let factor = product(&transposed(&row[&a]), &inverse);
                let pull = times(&factor, right[node]);
                for (r, p) in right[a].iter_mut().zip(pull) {
                    *r -= p;
                }
                self.rows[a].remove(&node);
                for &b in &others {
                    let change = product(&factor, &row[&b]);
                    subtract_from(self.rows[a].entry(b).or_insert(ZERO), &change);
                }
                queue.remove(&(degree, a));
                queue.insert((self.rows[a].len(), a));
            }
            order.push((node, row));
        }
        let mut steps = vec![[0.0; 3]; n];
        for (node, row) in order.iter().rev() {
            let mut rest = right[*node];
            for (other, block) in row.iter().filter(|(k, _)| *k != node) {
                for (r, p) in rest.iter_mut().zip(times(block, steps[*other])) {
                    *r -= p;
                }
            }
            steps[*node] = times(&inverses[*node], rest);
        }
        steps.iter().flatten().all(|v| v.is_finite()).then_some(steps)
    }
}
