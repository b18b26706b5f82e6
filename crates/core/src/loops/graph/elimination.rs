//! In which order the nodes of a graph are eliminated, and what that fills in.
//!
//! In: which nodes are tied to each other. Out: the order, of least degree, and the blocks that elimination needs, each with
//! a place of its own. It depends on no number, so that the many systems of one optimisation share it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Degree of a node that was eliminated.
const GONE: usize = usize::MAX;

/// See the module.
pub(super) struct Elimination {
    /// All nodes, in order.
    nodes: Vec<usize>,
    /// By node: its place in the order.
    place: Vec<usize>,
    /// By place: where the node's blocks begin; one more at the end.
    begin: Vec<usize>,
    /// By block: the other node, which is eliminated later. Ascending within a node.
    others: Vec<usize>,
    /// By place, and by pair of the node's blocks whose first one's other node is eliminated before the second one's: the
    /// block of these two.
    filled: Vec<u32>,
}

impl Elimination {
    /// For `count` nodes, tied as `pairs` say.
    pub fn new(count: usize, pairs: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let mut tied = vec![Vec::new(); count];
        for (i, j) in pairs {
            insert(&mut tied[i], j, i);
            insert(&mut tied[j], i, j);
        }
        // A node is queued anew when it is tied to more or fewer; what was queued before is passed over.
        let mut degree: Vec<usize> = tied.iter().map(Vec::len).collect();
        let mut queue: BinaryHeap<_> = degree.iter().copied().zip(0..count).map(Reverse).collect();
        let mut elimination = Self {
            nodes: Vec::with_capacity(count),
            place: vec![0; count],
            begin: vec![0],
            others: Vec::new(),
            filled: Vec::new(),
        };
        while let Some(Reverse((queued, node))) = queue.pop() {
            if queued != degree[node] {
                continue;
            }
            degree[node] = GONE;
            let others = std::mem::take(&mut tied[node]);
            for &a in &others {
                tied[a].retain(|&k| k != node);
                for &b in &others {
                    insert(&mut tied[a], b, a);
                }
                if degree[a] != tied[a].len() {
                    degree[a] = tied[a].len();
                    queue.push(Reverse((degree[a], a)));
                }
            }
            elimination.place[node] = elimination.nodes.len();
            elimination.nodes.push(node);
            elimination.others.extend(others);
            elimination.begin.push(elimination.others.len());
        }
        elimination.filled = elimination.fill();
        elimination
    }

    fn fill(&self) -> Vec<u32> {
        let mut filled = Vec::new();
        for &node in &self.nodes {
            let others = self.others(node);
            for &a in others {
                let of_a = self.blocks(a).start;
                let mut numbered = (0..).zip(self.others(a));
                for &b in others.iter().filter(|&&b| self.is_before(a, b)) {
                    let found = numbered.find(|n| *n.1 == b);
                    filled.extend(found.map(|(k, _): (usize, _)| (of_a + k) as u32));
                }
            }
        }
        filled
    }

    /// The nodes in order.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// How many blocks there are beside those of a node with itself.
    pub fn block_count(&self) -> usize {
        self.others.len()
    }

    /// The nodes that a node is tied to when its turn comes, ascending.
    pub fn others(&self, node: usize) -> &[usize] {
        &self.others[self.blocks(node)]
    }

    /// Its blocks with these.
    pub fn blocks(&self, node: usize) -> std::ops::Range<usize> {
        let place = self.place[node];
        self.begin[place]..self.begin[place + 1]
    }

    /// Whether node `a` is eliminated before node `b`.
    pub fn is_before(&self, a: usize, b: usize) -> bool {
        self.place[a] < self.place[b]
    }

    /// The block of two tied nodes, the one that is eliminated before the other first.
    pub fn block(&self, first: usize, second: usize) -> Option<usize> {
        let k = self.others(first).binary_search(&second).ok()?;
        Some(self.blocks(first).start + k)
    }

    /// The blocks that change when a node is eliminated: node by node in order, and for each pair of [`Self::others`] in
    /// theirs.
    pub fn filled(&self) -> &[u32] {
        &self.filled
    }
}

/// Takes `new` into an ascending list, once, unless it is `own`.
fn insert(list: &mut Vec<usize>, new: usize, own: usize) {
    if let Err(at) = list.binary_search(&new)
        && new != own
    {
        list.insert(at, new);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_goes_from_its_ends_and_fills_nothing_in() {
        let elimination = Elimination::new(5, (0..4).map(|k| (k, k + 1)));
        assert_eq!(elimination.nodes(), [0, 1, 2, 3, 4]);
        assert_eq!(elimination.block_count(), 4);
        assert_eq!(elimination.filled(), [] as [u32; 0]);
        assert_eq!(elimination.block(2, 3), Some(2));
        assert_eq!(elimination.block(2, 4), None);
    }

    #[test]
    fn the_neighbours_of_what_is_gone_are_tied() {
        // A ring of four: when node 0 goes, 1 and 3 are tied.
        let elimination = Elimination::new(4, [(0, 1), (1, 2), (2, 3), (3, 0)]);
        assert_eq!(elimination.nodes(), [0, 1, 2, 3]);
        assert_eq!(elimination.others(1), [2, 3]);
        let tied = elimination.block(1, 3).unwrap();
        assert_eq!(elimination.filled()[0] as usize, tied);
    }
}
