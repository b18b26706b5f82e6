//! Stubs: tiny polylines that lie on a wall.
//!
//! In: the map. Out: the map without them. Two returns beside an edge make a polyline across the wall they lie on, which merging
//! does not take up, because it faces elsewhere. What it rests on, the wall explains as well.

use super::MergeSettings;
use super::growing_map::GrowingMap;
use crate::geometry::{Near, Point};

/// Longer polylines are no stubs, metres.
const LONGEST_M: f64 = 0.1;
/// What a stub lies on is at least this long, metres: the legs of chairs stay whole.
const LEAST_WALL_M: f64 = 0.5;
/// Distance within which a stub's points lie on a wall, metres: as for returns (`refit`).
const ON_WALL_M: f64 = 0.08;

/// Takes stubs out.
pub(crate) fn clear_stubs(map: &mut GrowingMap, settings: &MergeSettings) {
    let length_m = |slot: u32| -> f64 { map.skeleton.sides_of(slot).map(|s| s.length_m).sum() };
    let is_wall: Vec<bool> = (0..map.slots())
        .map(|slot| length_m(slot) >= LEAST_WALL_M)
        .collect();
    let anyhow = Near {
        direction: Point::new(1.0, 0.0),
        min_cos: -1.0,
        max_distance_m: ON_WALL_M,
        beyond_ends: true,
    };
    let mut reader = map.skeleton.reader();
    let mut lies_on_wall = |p: Point| {
        reader
            .nearest(p, &anyhow, |owner| is_wall[owner as usize])
            .is_some()
    };
    let stubs: Vec<u32> = map
        .polylines()
        .filter(|&(slot, p)| length_m(slot) < LONGEST_M && p.vertices.iter().all(|v| lies_on_wall(v.point)))
        .map(|(slot, _)| slot)
        .collect();
    for slot in stubs {
        map.remove(slot);
    }
    map.refresh_skeletons(settings.skeleton_sigma_m);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::merge::growing_map::Vertex;

    #[test]
    fn a_stub_across_a_wall_goes_and_the_leg_of_a_chair_stays() {
        let mut map = GrowingMap::default();
        let mut add = |points: &[(f64, f64)]| {
            map.add(
                points
                    .iter()
                    .map(|&(x, y)| Vertex::new(Point::new(x, y), 0))
                    .collect(),
            );
        };
        add(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]);
        add(&[(1.5, -0.02), (1.52, 0.04)]);
        add(&[(1.0, 0.5), (1.04, 0.5)]);
        add(&[(1.02, 0.48), (1.02, 0.52)]);
        let settings = MergeSettings::default();
        map.refresh_skeletons(settings.skeleton_sigma_m);
        clear_stubs(&mut map, &settings);
        let left: Vec<u32> = map.polylines().map(|(slot, _)| slot).collect();
        assert_eq!(left, [0, 2, 3]);
    }
}
