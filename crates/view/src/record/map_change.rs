//! What has changed from one map to the next, so that a page can go forwards and back without holding them all.

use std::collections::BTreeMap;

use polymapper_core::map::{EraserBox, Map, MapPolyline};
use serde::{Deserialize, Serialize};

use super::points::millimetres;
use super::{Chain, chain};

/// Changes since the map before.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MapChange {
    /// How many scans the map rests on.
    pub scans: usize,
    /// New and changed polylines.
    pub put: Vec<PolylineRecord>,
    /// Ids of those that are gone.
    pub drop: Vec<u64>,
    /// All eraser boxes, `[left, bottom, right, top]` in millimetres; absent when they are as before.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub boxes: Option<Vec<[i64; 4]>>,
}

/// A polyline of the map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolylineRecord {
    /// Its name.
    pub id: u64,
    /// Vertices.
    pub points: Chain,
    /// For each vertex, the observations it rests on.
    pub observations: Vec<u32>,
    /// For each vertex, its standard deviation across the wall, tenths of a millimetre.
    pub sigma_tenth_mm: Vec<i64>,
}

/// The map as those who read the record know it.
#[derive(Debug, Default)]
pub struct MapState {
    polylines: BTreeMap<u64, PolylineRecord>,
    boxes: Vec<[i64; 4]>,
}

impl MapState {
    /// What has to be told so that `map`, of `scans` scans, is known.
    pub fn change_to(&mut self, map: &Map, scans: usize) -> MapChange {
        let mut gone = std::mem::take(&mut self.polylines);
        let mut put = Vec::new();
        for now in map.polylines.iter().map(record) {
            if gone.remove(&now.id).as_ref() != Some(&now) {
                put.push(now.clone());
            }
            self.polylines.insert(now.id, now);
        }
        let boxes: Vec<[i64; 4]> = map.eraser_boxes.iter().map(box_record).collect();
        let boxes_changed = boxes != self.boxes;
        self.boxes.clone_from(&boxes);
        MapChange {
            scans,
            put,
            drop: gone.into_keys().collect(),
            boxes: boxes_changed.then_some(boxes),
        }
    }
}

fn record(polyline: &MapPolyline) -> PolylineRecord {
    let vertices = &polyline.vertices;
    PolylineRecord {
        id: polyline.id,
        points: chain(vertices.iter().map(|v| v.point)),
        observations: vertices.iter().map(|v| v.observations).collect(),
        sigma_tenth_mm: vertices.iter().map(|v| millimetres(v.sigma_m * 10.0)).collect(),
    }
}

fn box_record(b: &EraserBox) -> [i64; 4] {
    [b.min.x, b.min.y, b.max.x, b.max.y].map(millimetres)
}

#[cfg(test)]
mod tests {
    use polymapper_core::geometry::Point;
    use polymapper_core::map::MapVertex;

    use super::*;

    fn wall(id: u64, to_x: f64) -> MapPolyline {
        let vertex = |x| MapVertex {
            point: Point::new(x, 1.0),
            observations: 2,
            sigma_m: 0.01,
        };
        MapPolyline {
            id,
            vertices: vec![vertex(0.0), vertex(to_x)],
        }
    }

    fn map(polylines: Vec<MapPolyline>) -> Map {
        Map {
            polylines,
            eraser_boxes: Vec::new(),
        }
    }

    #[test]
    fn only_what_changed_is_told() {
        let mut state = MapState::default();
        let first = state.change_to(&map(vec![wall(1, 1.0), wall(2, 1.0), wall(3, 1.0)]), 4);
        assert_eq!((first.put.len(), first.drop.len(), first.boxes), (3, 0, None));
        let second = state.change_to(&map(vec![wall(1, 1.0), wall(3, 2.0), wall(4, 1.0)]), 9);
        let put: Vec<u64> = second.put.iter().map(|p| p.id).collect();
        assert_eq!((put, second.drop), (vec![3, 4], vec![2]));
    }
}
