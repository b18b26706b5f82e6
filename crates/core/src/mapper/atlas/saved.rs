//! A map taken apart to be kept, and put together again.

use std::sync::Arc;

use super::Atlas;
use super::shown::Shown;
use crate::geometry::Pose;
use crate::join::{SavedEdge, SavedKeyframe, SavedMap};
use crate::keyframe::Keyframe;
use crate::loops::graph::Edge;
use crate::mapper::Settings;

impl Atlas {
    /// What must be kept for the map to be made again.
    pub fn saved(&self) -> SavedMap {
        SavedMap {
            keyframes: self.keyframes.iter().map(saved_keyframe).collect(),
            edges: self.edges.iter().map(saved_edge).collect(),
        }
    }

    /// The map that was kept. What each scan shows is found again from the scan.
    pub fn restored(saved: &SavedMap, settings: &Settings) -> Self {
        let mut keyframes: Vec<Keyframe> = Vec::with_capacity(saved.keyframes.len());
        for kept in &saved.keyframes {
            let way_m = keyframes
                .last()
                .map_or(0.0, |k| k.way_m + k.map_from_scan.distance(kept.map_from_scan));
            keyframes.push(restored_keyframe(kept, way_m, settings));
        }
        let count = keyframes.len();
        let edges = saved.edges.iter().filter(|e| e.from < count && e.to < count);
        Self {
            keyframes,
            edges: edges.map(restored_edge).collect(),
            ..Self::default()
        }
    }

    /// Edges to be kept from now on.
    pub fn tie_by(&mut self, edges: impl IntoIterator<Item = Edge>) {
        self.edges.extend(edges);
    }

    /// Puts another map's keyframes and edges after those of this one, moved by `here_from_other`; their scans count from
    /// `scans_before` on. Returns the number that the first of its keyframes gets.
    pub fn append(&mut self, other: Self, here_from_other: Pose, scans_before: usize) -> usize {
        let offset = self.keyframes.len();
        let before_m = self.keyframes.last().map_or(0.0, |k| k.way_m);
        self.keyframes
            .extend(other.keyframes.into_iter().map(|k| Keyframe {
                number: k.number + scans_before,
                map_from_scan: here_from_other * k.map_from_scan,
                way_m: before_m + k.way_m,
                ..k
            }));
        self.edges.extend(other.edges.into_iter().map(|e| Edge {
            from: e.from + offset,
            to: e.to + offset,
            ..e
        }));
        offset
    }
}

fn saved_keyframe(k: &Keyframe) -> SavedKeyframe {
    SavedKeyframe {
        number: k.number,
        scan: (*k.scan).clone(),
        noise_m: k.extraction.noise_m,
        moving: (0..k.is_moving.len()).filter(|&p| k.is_moving[p]).collect(),
        map_from_scan: k.map_from_scan,
    }
}

fn restored_keyframe(kept: &SavedKeyframe, way_m: f64, settings: &Settings) -> Keyframe {
    let shown = Shown::by(&kept.scan, kept.noise_m, settings);
    Keyframe {
        number: kept.number,
        is_moving: (0..shown.extraction.polylines.len())
            .map(|p| kept.moving.contains(&p))
            .collect(),
        extraction: shown.extraction,
        points: shown.points,
        middle: shown.middle,
        disordered_runs: shown.disordered_runs,
        scan: Arc::new(kept.scan.clone()),
        way_m,
        is_doubtful: false,
        step: Pose::IDENTITY,
        map_from_scan: kept.map_from_scan,
    }
}

fn saved_edge(e: &Edge) -> SavedEdge {
    SavedEdge {
        from: e.from,
        to: e.to,
        motion: e.motion,
        information: e.information,
        is_loop: e.is_loop,
    }
}

fn restored_edge(e: &SavedEdge) -> Edge {
    Edge {
        from: e.from,
        to: e.to,
        motion: e.motion,
        information: e.information,
        is_loop: e.is_loop,
    }
}
