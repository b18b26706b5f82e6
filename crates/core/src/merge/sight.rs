//! What a scan looked through: evidence that something is not, or no longer, there.
//!
//! Not in the paper, which takes moved things out by their shape alone. A beam that returns from behind a side of the
//! map says that the side is gone; sides that more scans looked through than hit are taken out. Statistics of the
//! same kind as an occupancy grid's, kept on the sides.

use super::MergeSettings;
use super::growing_map::{Evidence, GrowingMap};
use crate::geometry::{Crossing, Point, Pose};
use crate::scan::Scan;

/// Counts every side that a beam of the scan went through well before it returned, once a scan; returns the
/// polylines they belong to.
pub(crate) fn look(
    map: &mut GrowingMap,
    scan: &Scan,
    map_from_scan: Pose,
    number: u32,
    settings: &MergeSettings,
) -> Vec<u32> {
    let origin = map_from_scan.translation();
    let mut through: Vec<(u32, u32)> = Vec::new();
    for (_, point) in scan.points() {
        let place = map_from_scan * point;
        let Some(direction) = (place - origin).unit() else {
            continue;
        };
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
    through.into_iter().map(|(slot, _)| slot).collect()
}

/// Counts what the scan looked through, and takes out what has been looked through more often than seen. Returns the
/// number of sides taken out.
pub(crate) fn clear_sight(
    map: &mut GrowingMap,
    scan: &Scan,
    map_from_scan: Pose,
    number: u32,
    settings: &MergeSettings,
) -> usize {
    let touched = look(map, scan, map_from_scan, number, settings);
    touched
        .iter()
        .map(|&slot| take_out(map, slot, |side| is_gone(side, settings)))
        .sum()
}

/// A grazing beam passes a wall at a hand's breadth and returns metres behind it: such a crossing, and one at the
/// very end of a polyline, may be a small error of the pose.
fn is_looked_through(
    map: &GrowingMap,
    crossing: &Crossing,
    direction: Point,
    place: Point,
    settings: &MergeSettings,
) -> bool {
    let side = map.dense.side(crossing.side);
    let normal = side.normal();
    let off_wall_m = normal.dot(place - side.segment.a).abs();
    if normal.dot(direction).abs() < settings.sight_min_sine || off_wall_m < settings.sight_margin_m * 0.5 {
        return false;
    }
    let Some(polyline) = map.polyline(side.owner) else {
        return false;
    };
    let at = side.segment.at(crossing.share);
    let (first, last) = (
        &polyline.vertices[0],
        &polyline.vertices[polyline.vertices.len() - 1],
    );
    let length_m = first.point.distance(last.point);
    let end_m = 0.05_f64.min(0.25 * length_m);
    first.point.distance(at) > end_m && last.point.distance(at) > end_m
}

fn is_gone(side: &Evidence, settings: &MergeSettings) -> bool {
    side.seen_through >= settings.sight_min_looks && side.seen_through > side.hits
}

/// Takes out, everywhere, the sides that more than `share` of the scans that could tell looked through.
pub(crate) fn clear_all(map: &mut GrowingMap, share: f64) {
    let slots: Vec<u32> = map.polylines().map(|(slot, _)| slot).collect();
    for slot in slots {
        take_out(map, slot, |side| {
            let looks = f64::from(side.seen_through);
            side.seen_through >= 2 && looks > share * (looks + f64::from(side.hits))
        });
    }
}

/// Takes the sides that are gone out of a polyline; what is left on either side becomes polylines of their own.
/// Returns how many sides were taken out.
fn take_out(map: &mut GrowingMap, slot: u32, is_gone: impl Fn(&Evidence) -> bool) -> usize {
    let Some(polyline) = map.polyline(slot) else {
        return 0;
    };
    let sides = &polyline.vertices[..polyline.vertices.len() - 1];
    let gone = sides.iter().filter(|v| is_gone(&v.onward)).count();
    if gone == 0 {
        return 0;
    }
    let vertices = polyline.vertices.clone();
    let mut pieces = vertices
        .split_inclusive(|v| is_gone(&v.onward))
        .filter(|piece| piece.len() >= 2);
    match pieces.next() {
        Some(first) => map.replace(slot, first.to_vec()),
        None => map.remove(slot),
    }
    for piece in pieces {
        map.add(piece.to_vec());
    }
    gone
}
