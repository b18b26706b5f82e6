//! Ways along the pose graph: how well keyframes are tied to each other.

use super::graph::Edge;
use crate::geometry::Point;

/// What an edge says at the least of a shift, 1/m²: a standard deviation of 10 m.
const LEAST_TOLD: f64 = 0.01;
/// What an edge leaves open of a turn at the most, rad²: a standard deviation of 1 rad.
const MOST_OPEN_RAD2: f64 = 1.0;
/// A step that is surer of the heading than this, radians, adds nothing to the drift that is usual.
const USUAL_RAD: f64 = 0.01;

/// A way along the edges of the graph.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Way {
    /// Its length, metres: that of its motion for an edge from one keyframe to the next, 0.5 m for a recognised place. Drift
    /// grows with it, so keyframes within a short way agree with each other.
    pub length_m: f64,
    /// Variance of a shift that the walls along it left open, m²: along a corridor without doors there is more drift than after
    /// as long a way through rooms, and a turn that a step left open shifts all that is far from it.
    pub open_m2: f64,
    /// Variance of a turn that steps along it left open, because other places came near or walls were round, rad².
    pub open_rad2: f64,
}

/// Which keyframes are well tied to keyframe `from`, and how: by the shortest ways. Ways longer than `limit_m` are left out. `places` are
/// those of all keyframes.
pub(crate) fn ways(places: &[Point], edges: &[Edge], from: usize, limit_m: f64) -> Vec<Option<Way>> {
    let ties = Ties::new(places.len(), edges);
    let mut ways: Vec<Option<Way>> = vec![None; places.len()];
    // Dijkstra's algorithm on a sorted list; the part of the graph within the limit has some tens of nodes.
    let mut open: Vec<(Way, usize)> = vec![(Way::default(), from)];
    while let Some((way, node)) = open.pop() {
        if ways[node].is_some() {
            continue;
        }
        ways[node] = Some(way);
        let arm_m = places[from].distance(places[node]);
        for &(next, tie) in ties.of(node) {
            let total = Way {
                length_m: way.length_m + tie.length_m,
                open_m2: way.open_m2 + tie.open_m2 + tie.open_rad2 * arm_m * arm_m,
                open_rad2: way.open_rad2 + tie.open_rad2,
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
pub(crate) fn ways_m(places: &[Point], edges: &[Edge], from: usize, limit_m: f64) -> Vec<Option<f64>> {
    let ways = ways(places, edges, from, limit_m);
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
            let turn_rad2 = edge.information.heading_variance_rad2();
            let turn_rad2 = turn_rad2.map_or(MOST_OPEN_RAD2, |v| v.min(MOST_OPEN_RAD2));
            let tie = Way {
                length_m,
                open_m2: 1.0 / edge.information.least_told().max(LEAST_TOLD),
                open_rad2: (turn_rad2 - USUAL_RAD * USUAL_RAD).max(0.0),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::align::Information;
    use crate::geometry::Pose;

    /// Keyframes 1 m apart along x, one of the steps unsure of its turn by `sigma_rad`.
    fn row(count: usize, unsure: usize, sigma_rad: f64) -> (Vec<Point>, Vec<Edge>) {
        let places = (0..count).map(|k| Point::new(k as f64, 0.0)).collect();
        let step = |from: usize| Edge {
            from,
            to: from + 1,
            motion: Pose::new(1.0, 0.0, 0.0),
            information: Information::from_sigmas(0.01, 0.01, if from == unsure { sigma_rad } else { 0.002 }),
            is_loop: false,
        };
        (places, (0..count - 1).map(step).collect())
    }

    #[test]
    fn a_turn_that_was_left_open_shifts_what_is_far_from_it_and_not_what_is_near() {
        let (places, edges) = row(21, 10, 0.1);
        let sigma_m = |from: usize, to: usize| {
            ways(&places, &edges, from, f64::INFINITY)[to]
                .unwrap()
                .open_m2
                .sqrt()
        };
        assert!(sigma_m(10, 0) < 0.2, "{}", sigma_m(10, 0));
        let far_m = sigma_m(20, 0);
        assert!((far_m - 0.95).abs() < 0.1, "10 m at 0.1 rad: {far_m}");
    }

    #[test]
    fn turns_that_are_as_sure_as_usual_add_nothing() {
        let (places, edges) = row(21, 10, 0.002);
        let way = ways(&places, &edges, 20, f64::INFINITY)[0].unwrap();
        assert!(way.open_rad2 == 0.0 && way.open_m2.sqrt() < 0.1, "{way:?}");
    }
}
