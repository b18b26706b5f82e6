//! Ways along the pose graph: how well keyframes are tied to each other.

use super::graph::Edge;

/// Which keyframes are well tied to keyframe `from`, and how long the way along the edges is, metres: the length of
/// its motion for an edge from one keyframe to the next, 0.5 m for a recognised place. Drift grows with that way, so
/// keyframes within a short one agree with each other. Ways longer than `limit_m` are left out.
pub(crate) fn ways_m(count: usize, edges: &[Edge], from: usize, limit_m: f64) -> Vec<Option<f64>> {
    let ties = Ties::new(count, edges);
    let mut ways: Vec<Option<f64>> = vec![None; count];
    // Dijkstra's algorithm on a sorted list; the part of the graph within the limit has some tens of nodes.
    let mut open: Vec<(f64, usize)> = vec![(0.0, from)];
    while let Some((way_m, node)) = open.pop() {
        if ways[node].is_some() {
            continue;
        }
        ways[node] = Some(way_m);
        for &(next, length_m) in ties.of(node) {
            let total_m = way_m + length_m;
            if ways[next].is_none() && total_m <= limit_m {
                let at = open.partition_point(|o| o.0 > total_m);
                open.insert(at, (total_m, next));
            }
        }
    }
    ways
}

/// The nodes that each node is tied to, and how far they are, metres; those of a node side by side.
struct Ties {
    begin: Vec<usize>,
    ties: Vec<(usize, f64)>,
}

impl Ties {
    fn new(count: usize, edges: &[Edge]) -> Self {
        let mut begin = vec![0; count + 1];
        for edge in edges {
            begin[edge.from] += 1;
            begin[edge.to] += 1;
        }
        let mut total = 0;
        for at in &mut begin {
            total += *at;
            *at = total;
        }
        // Filled from the back, until every node's begin is where it belongs.
        let mut ties = vec![(0, 0.0); total];
        for edge in edges.iter().rev() {
            let length_m = if edge.is_loop {
                0.5
            } else {
                edge.motion.translation().norm() + 0.05
            };
            for (node, other) in [(edge.to, edge.from), (edge.from, edge.to)] {
                begin[node] -= 1;
                ties[begin[node]] = (other, length_m);
            }
        }
        Self { begin, ties }
    }

    fn of(&self, node: usize) -> &[(usize, f64)] {
        &self.ties[self.begin[node]..self.begin[node + 1]]
    }
}
