//! Keyframes: the scans that are merged, kept so that the map can be made again from them.

use crate::align::SidePoint;
use crate::extract::ScanPolyline;
use crate::geometry::{Point, Pose};
use crate::graph::Edge;
use crate::scan::Scan;

/// A scan that is part of the map.
#[derive(Clone, Debug)]
pub(crate) struct Keyframe {
    /// Number of the scan in the log.
    pub number: usize,
    pub scan: Scan,
    pub polylines: Vec<ScanPolyline>,
    /// Which of the polylines belong to moving objects, and are not merged.
    pub is_moving: Vec<bool>,
    pub points: Vec<SidePoint>,
    /// Returns in a row that come from no stable shape, laser frame.
    pub disordered_runs: Vec<Vec<Point>>,
    pub map_from_scan: Pose,
}

impl Keyframe {
    /// The polylines that are merged.
    pub fn standing_polylines(&self) -> impl Iterator<Item = &ScanPolyline> {
        self.polylines
            .iter()
            .zip(&self.is_moving)
            .filter(|(_, moving)| !**moving)
            .map(|(p, _)| p)
    }
}

/// Which keyframes are well tied to keyframe `from`, and how long the way along the edges is, metres: the length of
/// its motion for an edge from one keyframe to the next, 0.5 m for a recognised place. Drift grows with that way, so
/// keyframes within a short one agree with each other. Ways longer than `limit_m` are left out.
pub(crate) fn ways_m(count: usize, edges: &[Edge], from: usize, limit_m: f64) -> Vec<Option<f64>> {
    let mut neighbours: Vec<Vec<(usize, f64)>> = vec![Vec::new(); count];
    for edge in edges {
        let length_m = if edge.is_loop {
            0.5
        } else {
            edge.motion.translation().norm() + 0.05
        };
        neighbours[edge.from].push((edge.to, length_m));
        neighbours[edge.to].push((edge.from, length_m));
    }
    let mut ways: Vec<Option<f64>> = vec![None; count];
    // Dijkstra's algorithm on a sorted list; the part of the graph within the limit has some tens of nodes.
    let mut open: Vec<(f64, usize)> = vec![(0.0, from)];
    while let Some((way_m, node)) = open.pop() {
        if ways[node].is_some() {
            continue;
        }
        ways[node] = Some(way_m);
        for &(next, length_m) in &neighbours[node] {
            let total_m = way_m + length_m;
            if ways[next].is_none() && total_m <= limit_m {
                let at = open.partition_point(|o| o.0 > total_m);
                open.insert(at, (total_m, next));
            }
        }
    }
    ways
}
