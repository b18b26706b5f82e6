//! Each wall once: polylines of the map that lie on others are merged into them.
//!
//! The same wall can stand twice, when it was first seen in pieces or when a scan was a little off. Merging a polyline
//! of the map into the rest, as if it were a scan's, is the paper's merging applied to the map itself.

use super::growing_map::{GrowingMap, GrowingPolyline};
use super::simulate::ScanPoint;
use super::{MergeReport, MergeSettings, thread};
use crate::geometry::Point;

/// Passes at most. Merging a polyline into two others that overlap leaves branches, which the next pass takes up; after
/// three passes there are none on the logs seen.
const MOST_PASSES: usize = 6;

/// Merges every polyline of the map into the others, those that rest on least first, until none lies on another.
pub(crate) fn merge_overlaps(map: &mut GrowingMap, settings: &MergeSettings) {
    for _ in 0..MOST_PASSES {
        if merge_each(map, settings) == 0 {
            break;
        }
    }
    map.refresh_skeletons(settings.skeleton_sigma_m);
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
        let points = points_of(polyline);
        let others = |owner: u32| owner != slot;
        let overlapping = points
            .iter()
            .filter(|p| super::link::closest(map, p, settings.gate_m, others).is_some());
        // One point is where two walls meet.
        if overlapping.take(2).count() == 2 {
            map.remove(slot);
            thread(map, &points, 0, settings, &mut MergeReport::default());
            merged += 1;
        }
    }
    merged
}

fn points_of(polyline: &GrowingPolyline) -> Vec<ScanPoint> {
    let v = &polyline.vertices;
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
