//! Worlds drawn with a few walls, and what a scanner sees of them.

use polymapper_core::geometry::{Point, Pose};
use polymapper_core::scan::{Scan, ScanGeometry};

pub type Wall = [(f64, f64); 2];

/// Corners of a room with a niche.
pub const LIVING: [(f64, f64); 6] = [
    (-3.0, -2.0),
    (4.0, -2.0),
    (4.0, 0.5),
    (2.5, 0.5),
    (2.5, 3.0),
    (-3.0, 3.0),
];
/// Corners of a room that is like no other.
pub const SHED: [(f64, f64); 5] = [(-1.2, -1.0), (0.9, -1.4), (1.6, 0.2), (0.3, 1.1), (-0.9, 0.8)];

/// Closed rooms as walls.
pub fn walls(corners: &[(f64, f64)]) -> Vec<Wall> {
    (0..corners.len())
        .map(|k| [corners[k], corners[(k + 1) % corners.len()]])
        .collect()
}

/// What a scanner with 1° all round and `reach_m` sees of the walls.
pub fn scan_from(walls: &[Wall], map_from_scan: Pose, reach_m: f64) -> Scan {
    let geometry = ScanGeometry::new(0.0, 1_f64.to_radians(), 360).expect("360 beams of 1° are a geometry");
    let origin = map_from_scan.translation();
    let range = |direction: Point| {
        walls
            .iter()
            .filter_map(|&[a, b]| {
                let (a, b) = (Point::new(a.0, a.1) - origin, Point::new(b.0, b.1) - origin);
                let along = b - a;
                let cross = direction.cross(along);
                let (range_m, share) = (a.cross(along) / cross, a.cross(direction) / cross);
                (cross.abs() > 1e-12 && range_m > 0.0 && (0.0..=1.0).contains(&share)).then_some(range_m)
            })
            .fold(f64::INFINITY, f64::min)
    };
    let ranges_m = (0..360)
        .map(|beam| {
            let range_m = range(Point::from_polar(
                1.0,
                geometry.bearing_rad(beam) + map_from_scan.theta_rad,
            ));
            if range_m < reach_m { range_m } else { f64::NAN }
        })
        .collect();
    Scan::new(geometry, ranges_m).expect("as many ranges as beams")
}
