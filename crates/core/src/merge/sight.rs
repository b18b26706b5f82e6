//! What a scan looked through: evidence that something is not, or no longer, there.
//!
//! Not in the paper, which takes moved things out by their shape alone. A beam that returns from behind a side of the
//! map says that the side is gone; sides that more scans looked through than hit are taken out. Statistics of the
//! same kind as an occupancy grid's, kept on the vertices.

use super::MergeSettings;
use super::growing_map::{GrowingMap, Vertex};
use crate::geometry::{Crossing, Point, Pose};
use crate::scan::Scan;

/// Counts every side that a beam of the scan went through well before it returned, and takes out what has been
/// looked through more often than seen. Returns the number of vertices taken out.
pub(crate) fn clear_sight(map: &mut GrowingMap, scan: &Scan, map_from_scan: Pose, number: u32, settings: &MergeSettings) -> usize {
    let origin = map_from_scan.translation();
    let mut through: Vec<(u32, u32)> = Vec::new();
    for (_, point) in scan.points() {
        let place = map_from_scan * point;
        let Some(direction) = (place - origin).unit() else { continue };
        let free_m = origin.distance(place) - settings.sight_margin_m;
        map.dense.along_ray(origin, direction, free_m, |crossing| {
            if is_looked_through(map, &crossing, direction, place, settings) {
                let side = map.dense.side(crossing.side);
                through.push((side.owner, side.index));
            }
            true
        });
    }
    through.sort_unstable();
    through.dedup();
    for &(slot, side) in &through {
        map.look_through(slot, side, number);
    }
    through.dedup_by_key(|t| t.0);
    through.iter().map(|&(slot, _)| take_out(map, slot, settings)).sum()
}

/// A grazing beam passes a wall at a hand's breadth and returns metres behind it: such a crossing, and one at the
/// very end of a polyline, may be a small error of the pose.
fn is_looked_through(map: &GrowingMap, crossing: &Crossing, direction: Point, place: Point, settings: &MergeSettings) -> bool {
    let side = map.dense.side(crossing.side);
    let normal = side.normal();
    let off_wall_m = normal.dot(place - side.segment.a).abs();
    if normal.dot(direction).abs() < settings.sight_min_sine || off_wall_m < settings.sight_margin_m * 0.5 {
        return false;
    }
    let Some(polyline) = map.polyline(side.owner) else { return false };
    let at = side.segment.at(crossing.share);
    let (first, last) = (&polyline.vertices[0], &polyline.vertices[polyline.vertices.len() - 1]);
    let length_m = first.point.distance(last.point);
    let end_m = 0.05_f64.min(0.25 * length_m);
    first.point.distance(at) > end_m && last.point.distance(at) > end_m
}

fn is_gone(v: &Vertex, settings: &MergeSettings) -> bool {
    v.seen_through >= settings.sight_min_looks && v.seen_through > v.hits
}

/// Takes the vertices that are gone out of a polyline; what is left on either side becomes polylines of their own.
fn take_out(map: &mut GrowingMap, slot: u32, settings: &MergeSettings) -> usize {
    let Some(polyline) = map.polyline(slot) else { return 0 };
    let gone = polyline.vertices.iter().filter(|v| is_gone(v, settings)).count();
    if gone == 0 {
        return 0;
    }
    let vertices = polyline.vertices.clone();
    let mut pieces = vertices.split(|v| is_gone(v, settings)).filter(|p| p.len() >= 2);
    match pieces.next() {
        Some(first) => map.replace(slot, first.to_vec()),
        None => map.remove(slot),
    }
    for piece in pieces {
        map.add(piece.to_vec());
    }
    gone
}
