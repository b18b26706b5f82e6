//! Simulated scan points (paper section 4): where the rays of the scanner meet the polylines of the aligned scan.

use super::growing_map::Vertex;
use crate::extract::ScanPolyline;
use crate::geometry::{Point, Pose, Segment};
use crate::scan::ScanGeometry;

/// A point that is to be merged, map frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScanPoint {
    /// Its place and what it rests on: one observation for a point of a scan.
    pub vertex: Vertex,
    /// Unit vector along its polyline.
    pub direction: Point,
    /// A corner of its polyline, to be kept whatever the spacing.
    pub is_vertex: bool,
}

/// The simulated scan points of one polyline of scan number `number`, in its order, and all its vertices.
///
/// The paper adds the end points to the rays' points; we add every vertex, because a corner between two rays would
/// be cut off otherwise, and leave out points nearer than `spacing_m` to the one before, which near walls would add
/// by the dozen and which tell nothing new.
pub(crate) fn scan_points(
    polyline: &ScanPolyline,
    geometry: &ScanGeometry,
    map_from_scan: Pose,
    number: u32,
    spacing_m: f64,
) -> Vec<ScanPoint> {
    let map_from_scan = map_from_scan.isometry();
    let mut out = Vec::new();
    for side in polyline.polyline.sides() {
        let Some(direction) = side.direction() else {
            continue;
        };
        let direction = map_from_scan.rotate(direction);
        let mut push = |p: Point, is_vertex| {
            out.push(ScanPoint {
                vertex: Vertex::new(map_from_scan * p, number),
                direction,
                is_vertex,
            });
        };
        push(side.a, true);
        let length_m = side.length_m();
        let mut last_m = 0.0;
        for share in ray_shares(side, geometry) {
            let along_m = share * length_m;
            if along_m - last_m >= spacing_m && length_m - along_m >= spacing_m {
                push(side.at(share), false);
                last_m = along_m;
            }
        }
    }
    if let Some(last) = out.last().copied() {
        let end = map_from_scan * polyline.polyline.last();
        if end.distance(last.vertex.point) > 1e-6 {
            out.push(ScanPoint {
                vertex: Vertex::new(end, number),
                is_vertex: true,
                ..last
            });
        }
    }
    out
}

/// Shares of the side, ascending, at which the scanner's rays meet it.
fn ray_shares(side: Segment, geometry: &ScanGeometry) -> impl Iterator<Item = f64> {
    let first = geometry.beam_of_bearing(side.a.bearing_rad());
    let turn_rad = side.a.cross(side.b).atan2(side.a.dot(side.b));
    let last = first + turn_rad / geometry.step_rad();
    let geometry = *geometry;
    (first.ceil() as i64..=last.floor() as i64).filter_map(move |beam| {
        let bearing_rad = geometry.bearing_rad(0) + geometry.step_rad() * beam as f64;
        side.meet_ray(Point::default(), Point::from_polar(1.0, bearing_rad))
            .map(|(_, share)| share)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polyline;

    #[test]
    fn a_wall_gets_the_points_of_the_rays_and_its_ends() {
        let geometry = ScanGeometry::new(-1.0, 0.1, 21).unwrap();
        let wall = Polyline::new(vec![Point::new(2.0, -1.05), Point::new(2.0, 1.05)]).unwrap();
        let wall = ScanPolyline {
            polyline: wall,
            first_beam: 0,
            last_beam: 20,
        };
        let points = scan_points(&wall, &geometry, Pose::new(1.0, 0.0, 0.0), 0, 0.01);
        let rays = (-4..=4).map(|k| 2.0 * (0.1 * f64::from(k)).tan());
        let expected: Vec<f64> = [-1.05].into_iter().chain(rays).chain([1.05]).collect();
        assert_eq!(points.len(), expected.len());
        for (p, y) in points.iter().zip(expected) {
            assert!(
                (p.vertex.point.x - 3.0).abs() < 1e-9 && (p.vertex.point.y - y).abs() < 1e-9,
                "{:?} {y}",
                p.vertex.point
            );
        }
    }
}
