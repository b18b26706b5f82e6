//! The virtual scan (paper section 2): the part of the map that the last scan was merged into.
//!
//! In: the map, the last pose, which polylines the last scan was merged into. Out: polylines in the frame of the last
//! pose, in cyclic order round it: the last scan with its noise corrected by all scans before.
//!
//! The paper goes by provenance alone. We complete it by what can be seen of the map from the last pose all round,
//! because the next scan may look where the last did not.

use crate::geometry::{Point, Polyline, Pose};
use crate::merge::growing_map::GrowingMap;

/// Angle between the rays that look for visible polylines, radians (1°).
const STEP_RAD: f64 = std::f64::consts::PI / 180.0;
/// Polylines farther than this are left out, metres.
const REACH_M: f64 = 30.0;

/// A stretch of a polyline of the map, as far as it is seen: sides `first..=last` of its skeleton.
struct Stretch {
    slot: u32,
    first: (u32, Point),
    last: (u32, Point),
}

/// The polylines of the virtual scan, in the frame of the pose, counter-clockwise from straight behind it.
pub(crate) fn virtual_scan(map: &GrowingMap, map_from_last: Pose, merged_into: &[u32]) -> Vec<Polyline> {
    let mut stretches = visible(map, map_from_last);
    for &slot in merged_into {
        if !stretches.iter().any(|s| s.slot == slot) {
            stretches.extend(whole(map, slot));
        }
    }
    let last_from_map = map_from_last.inverse();
    let mut polylines: Vec<(f64, Polyline)> = stretches
        .iter()
        .filter_map(|s| {
            let polyline = polyline(map, s)?.transformed(last_from_map);
            Some((polyline.first().bearing_rad(), polyline))
        })
        .collect();
    polylines.sort_by(|a, b| a.0.total_cmp(&b.0));
    polylines.into_iter().map(|p| p.1).collect()
}

/// What rays all round meet first, joined along each polyline.
fn visible(map: &GrowingMap, map_from_last: Pose) -> Vec<Stretch> {
    let origin = map_from_last.translation();
    let mut out: Vec<Stretch> = Vec::new();
    let rays = (std::f64::consts::TAU / STEP_RAD).round() as i32;
    let mut reader = map.skeleton.reader();
    for k in 0..rays {
        let bearing_rad = map_from_last.theta_rad + std::f64::consts::PI + STEP_RAD * f64::from(k);
        let direction = Point::from_polar(1.0, bearing_rad);
        let Some(hit) = reader.first_along_ray(origin, direction, REACH_M) else {
            continue;
        };
        let side = map.skeleton.side(hit.side);
        // Free space lies on the left: what turns its back is seen through a gap or by mistake.
        if side.normal().dot(direction) >= 0.0 {
            continue;
        }
        let at = (side.index, side.segment.at(hit.share));
        match out.last_mut() {
            Some(last)
                if last.slot == side.owner && last.last.0 <= side.index && side.index <= last.last.0 + 1 =>
            {
                last.last = at;
            }
            _ => out.push(Stretch {
                slot: side.owner,
                first: at,
                last: at,
            }),
        }
    }
    out
}

fn whole(map: &GrowingMap, slot: u32) -> Option<Stretch> {
    let (first, last) = map.skeleton.ends(slot)?;
    Some(Stretch {
        slot,
        first: (first.index, first.segment.a),
        last: (last.index, last.segment.b),
    })
}

/// The stretch with its corners, and a little more at either end when it was hit by a single ray.
fn polyline(map: &GrowingMap, stretch: &Stretch) -> Option<Polyline> {
    let mut vertices = vec![stretch.first.1];
    for side in map.skeleton.sides_of(stretch.slot) {
        if side.index >= stretch.first.0 && side.index < stretch.last.0 {
            vertices.push(side.segment.b);
        }
    }
    vertices.push(stretch.last.1);
    vertices.dedup_by(|a, b| a.distance(*b) < 1e-6);
    Polyline::new(vertices).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::merge::growing_map::Vertex;

    fn map(walls: &[&[(f64, f64)]]) -> GrowingMap {
        let mut map = GrowingMap::default();
        for wall in walls {
            map.add(
                wall.iter()
                    .map(|&(x, y)| Vertex::new(Point::new(x, y), 0))
                    .collect(),
            );
        }
        map.refresh_skeletons(0.01);
        map
    }

    #[test]
    fn what_stands_behind_a_wall_is_not_in_the_virtual_scan() {
        let near = [(2.0, -1.0), (2.0, 1.0)];
        let hidden = [(3.0, -0.5), (3.0, 0.5)];
        let map = map(&[&near, &hidden]);
        let seen = virtual_scan(&map, Pose::new(1.0, 0.0, 0.0), &[]);
        assert_eq!(seen.len(), 1);
        assert!((seen[0].first().x - 1.0).abs() < 1e-9, "in the frame of the pose");
        assert!(seen[0].length_m() > 1.9);
        let with_provenance = virtual_scan(&map, Pose::new(1.0, 0.0, 0.0), &[1]);
        assert_eq!(with_provenance.len(), 2, "merged into, and therefore part of it");
    }

    #[test]
    fn corners_are_kept() {
        let map = map(&[&[(2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]]);
        let seen = virtual_scan(&map, Pose::IDENTITY, &[]);
        assert_eq!(seen.len(), 1);
        assert!(
            seen[0]
                .vertices()
                .iter()
                .any(|v| v.distance(Point::new(2.0, 2.0)) < 1e-6)
        );
    }
}
