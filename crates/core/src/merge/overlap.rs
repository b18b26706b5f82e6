//! Each wall once: polylines of the map that lie on others are merged into them.
//!
//! The same wall can stand twice, when it was first seen in pieces or when a scan was a little off. Merging a polyline
//! of the map into the rest, as if it were a scan's, is the paper's merging applied to the map itself.

use super::growing_map::{GrowingMap, GrowingPolyline, Vertex};
use super::simulate::ScanPoint;
use super::{MergeReport, MergeSettings, thread};
use crate::geometry::{Near, Point, SideGrid};

/// Passes at most. Merging a polyline into two others that overlap leaves branches, which the next pass takes up; after
/// three passes there are none on the logs seen.
const MOST_PASSES: usize = 6;

/// Merges every polyline of the map into the others, those that rest on least first, until none lies on another.
pub(crate) fn merge_overlaps(map: &mut GrowingMap, settings: &MergeSettings) {
    cut_turns(map, settings.gate_m);
    for _ in 0..MOST_PASSES {
        if merge_each(map, settings) == 0 {
            break;
        }
    }
    map.refresh_skeletons(settings.skeleton_sigma_m);
}

/// Vertices of a polyline that are held against those before: one metre of it, and not the metre next to it.
const TURN_VERTICES: usize = 25;
/// Fewer vertices on what went before are no turn but a narrow place.
const LEAST_TURN: usize = 3;

/// Cuts polylines that have gone all round something and run on over their own beginning: the second turn becomes a
/// polyline of its own, which is then merged into the first.
fn cut_turns(map: &mut GrowingMap, gate_m: f64) {
    let slots: Vec<u32> = map.polylines().map(|(slot, _)| slot).collect();
    for slot in slots {
        let Some(polyline) = map.polyline(slot) else {
            continue;
        };
        let pieces = turns(&polyline.vertices, gate_m);
        if pieces.len() > 1 {
            map.replace_by(slot, pieces.into_iter().filter(|piece| piece.len() > 1));
        }
    }
}

/// The vertices, cut where they begin or cease to lie on those before.
fn turns(vertices: &[Vertex], gate_m: f64) -> Vec<Vec<Vertex>> {
    let mut before = SideGrid::default();
    for (owner, stretch) in (0_u32..).zip(vertices.windows(TURN_VERTICES + 1).step_by(TURN_VERTICES)) {
        before.insert(owner, stretch.iter().map(|v| v.point));
    }
    let points = points_of(vertices);
    let mut reader = before.reader();
    let is_again = |k: usize| {
        let near = Near {
            direction: points[k].direction,
            min_cos: 0.9,
            max_distance_m: gate_m,
            beyond_ends: true,
        };
        let stretch = (k / TURN_VERTICES) as u32;
        reader
            .nearest(points[k].vertex.point, &near, |owner| owner + 1 < stretch)
            .is_some()
    };
    let again: Vec<bool> = (0..vertices.len()).map(is_again).collect();
    let mut pieces: Vec<Vec<Vertex>> = Vec::new();
    let mut from = 0;
    let mut was_again = false;
    for run in again.chunk_by(|a, b| a == b) {
        // A few are taken with what they are in.
        let is_turn = if run.len() < LEAST_TURN { was_again } else { run[0] };
        let piece = &vertices[from..from + run.len()];
        match pieces.last_mut() {
            Some(last) if is_turn == was_again => last.extend_from_slice(piece),
            _ => pieces.push(piece.to_vec()),
        }
        was_again = is_turn;
        from += run.len();
    }
    pieces
}

/// Returns how many polylines lay on others.
fn merge_each(map: &mut GrowingMap, settings: &MergeSettings) -> usize {
    let support = |p: &GrowingPolyline| p.vertices.iter().map(|v| u64::from(v.hits)).sum::<u64>();
    let mut order: Vec<(u64, u32)> = map.polylines().map(|(slot, p)| (support(p), slot)).collect();
    order.sort_unstable();
    let mut merged = 0;
    for (_, slot) in order {
        let Some(polyline) = map.polyline(slot) else {
            continue;
        };
        let points = points_of(&polyline.vertices);
        let mut sides = map.dense.reader();
        let others = |owner: u32| owner != slot;
        let overlapping = points
            .iter()
            .filter(|p| super::link::closest(&mut sides, p, settings.gate_m, others).is_some());
        // One point is where two walls meet.
        if overlapping.take(2).count() == 2 {
            map.remove(slot);
            thread(map, &points, 0, settings, &mut MergeReport::default());
            merged += 1;
        }
    }
    merged
}

fn points_of(v: &[Vertex]) -> Vec<ScanPoint> {
    (0..v.len())
        .map(|k| {
            let across = v[(k + 1).min(v.len() - 1)].point - v[k.saturating_sub(1)].point;
            let direction = across.unit().unwrap_or(Point::new(1.0, 0.0));
            ScanPoint {
                vertex: v[k],
                direction,
                is_vertex: true,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pillar_that_was_gone_round_twice_stands_once() {
        let round = |k: i32| Point::from_polar(1.5, -0.03 * f64::from(k));
        let mut map = GrowingMap::default();
        // One and a half turns; the half lies 3 cm farther out.
        let vertices = (0..320).map(|k| {
            let out = if k < 210 { 1.0 } else { 1.02 };
            Vertex::new(round(k) * out, 0)
        });
        map.add(vertices.collect());
        merge_overlaps(&mut map, &MergeSettings::default());
        let length_m: f64 = map.skeleton.sides().map(|s| s.length_m).sum();
        let around_m = std::f64::consts::TAU * 1.5;
        assert!(
            (length_m - around_m).abs() < 0.2,
            "{length_m} m instead of {around_m} m"
        );
    }
}
