//! Ways along the pose graph: how well keyframes are tied to each other.

use super::graph::Edge;

/// What an edge says at the least of a shift, 1/m²: a standard deviation of 10 m.
const LEAST_TOLD: f64 = 0.01;

/// A way along the edges of the graph.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Way {
    /// Its length, metres: that of its motion for an edge from one keyframe to the next, 0.5 m for a recognised place. Drift
    /// grows with it, so keyframes within a short way agree with each other.
    pub length_m: f64,
    /// Variance of a shift that the walls along it left open, m²: along a corridor without doors there is more drift than after
    /// as long a way through rooms.
    pub open_m2: f64,
}

/// Which keyframes are well tied to keyframe `from`, and how: by the shortest ways. Ways longer than `limit_m` are left out.
pub(crate) fn ways(count: usize, edges: &[Edge], from: usize, limit_m: f64) -> Vec<Option<Way>> {
    let ties = Ties::new(count, edges);
    let mut ways: Vec<Option<Way>> = vec![None; count];
    // Dijkstra's algorithm on a sorted list; the part of the graph within the limit has some tens of nodes.
    let mut open: Vec<(Way, usize)> = vec![(Way::default(), from)];
    while let Some((way, node)) = open.pop() {
        if ways[node].is_some() {
            continue;
        }
        ways[node] = Some(way);
        for &(next, tie) in ties.of(node) {
            let total = Way {
                length_m: way.length_m + tie.length_m,
                open_m2: way.open_m2 + tie.open_m2,
            };
            if ways[next].is_none() && total.length_m <= limit_m {
                let at = open.partition_point(|o| o.0.length_m > total.length_m);
                open.insert(at, (total, next));
            }
        }
    }
    ways
}

/// The lengths of [`ways`] alone, metres.
pub(crate) fn ways_m(count: usize, edges: &[Edge], from: usize, limit_m: f64) -> Vec<Option<f64>> {
    let ways = ways(count, edges, from, limit_m);
    ways.into_iter().map(|way| Some(way?.length_m)).collect()
}

/// The nodes that each node is tied to, and how; those of a node side by side.
struct Ties {
    begin: Vec<usize>,
    ties: Vec<(usize, Way)>,
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
        let mut ties = vec![(0, Way::default()); total];
        for edge in edges.iter().rev() {
            let length_m = if edge.is_loop {
                0.5
            } else {
                edge.motion.translation().norm() + 0.05
            };
            let tie = Way {
                length_m,
                open_m2: 1.0 / edge.information.least_told().max(LEAST_TOLD),
            };
            for (node, other) in [(edge.to, edge.from), (edge.from, edge.to)] {
                begin[node] -= 1;
                ties[begin[node]] = (other, tie);
            }
        }
        Self { begin, ties }
    }

    fn of(&self, node: usize) -> &[(usize, Way)] {
        &self.ties[self.begin[node]..self.begin[node + 1]]
    }
}
