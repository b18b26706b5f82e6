use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::*;
use crate::geometry::{Point, Segment};
use crate::map::{MapPolyline, MapVertex};
use crate::scan::ScanGeometry;

fn map(polylines: &[&[(f64, f64)]]) -> Map {
    let vertex = |&(x, y): &(f64, f64)| MapVertex {
        point: Point::new(x, y),
        observations: 5,
        sigma_m: 0.01,
    };
    Map {
        polylines: (0..)
            .zip(polylines)
            .map(|(id, p)| MapPolyline {
                id,
                vertices: p.iter().map(vertex).collect(),
            })
            .collect(),
        eraser_boxes: Vec::new(),
    }
}

/// An L of two halls with a column, free space inside.
fn halls() -> Map {
    map(&[
        &[
            (0.0, 0.0),
            (12.0, 0.0),
            (12.0, 4.0),
            (5.0, 4.0),
            (5.0, 9.0),
            (0.0, 9.0),
            (0.0, 0.0),
        ],
        &[(8.0, 2.0), (8.0, 2.6), (8.6, 2.6), (8.6, 2.0), (8.0, 2.0)],
    ])
}

/// A bare room of 6 m × 4 m: half a turn makes no difference.
fn bare_room() -> Map {
    map(&[&[(0.0, 0.0), (6.0, 0.0), (6.0, 4.0), (0.0, 4.0), (0.0, 0.0)]])
}

/// A scan of 270°, beams 1° apart, without noise.
fn seen(map: &Map, map_from_scan: Pose) -> Scan {
    let geometry = ScanGeometry::new(-0.75 * PI, 1_f64.to_radians(), 271).unwrap();
    let ranges_m = (0..271)
        .map(|beam| {
            let direction = Point::from_polar(1.0, geometry.bearing_rad(beam) + map_from_scan.theta_rad);
            map.polylines
                .iter()
                .flat_map(|p| p.vertices.windows(2))
                .filter_map(|w| {
                    Segment::new(w[0].point, w[1].point).meet_ray(map_from_scan.translation(), direction)
                })
                .map(|m| m.0)
                .fold(f64::INFINITY, f64::min)
        })
        .collect();
    Scan::new(geometry, ranges_m).unwrap()
}

fn find(map: &Map, scan: &Scan) -> Localisation {
    Locator::new(map, LocateSettings::default()).find(scan)
}

fn is_at(fix: &Fix, pose: Pose) -> bool {
    fix.map_from_scan.is_within(0.03, 0.01, pose)
}

#[test]
fn a_scan_is_found_wherever_it_was_taken_and_however_turned() {
    let map = halls();
    for (x, y, theta_rad) in [
        (1.5, 1.2, 0.3),
        (3.1, 7.4, -2.0),
        (10.2, 2.9, 3.0),
        (6.0, 1.0, 1.1),
    ] {
        let pose = Pose::new(x, y, theta_rad);
        let found = find(&map, &seen(&map, pose));
        assert_eq!(found.verdict, Verdict::Located, "{pose:?}: {found:?}");
        assert!(is_at(&found.fixes[0], pose), "{pose:?}: {:?}", found.fixes[0]);
    }
}

#[test]
fn a_symmetric_room_is_ambiguous_and_both_poses_are_told() {
    let map = bare_room();
    let pose = Pose::new(2.0, 1.5, 0.4);
    let found = find(&map, &seen(&map, pose));
    assert_eq!(found.verdict, Verdict::Ambiguous);
    let turned = Pose::new(4.0, 2.5, 0.4 + PI);
    let (a, b) = (&found.fixes[0], &found.fixes[1]);
    assert!((is_at(a, pose) && is_at(b, turned)) || (is_at(a, turned) && is_at(b, pose)));
    assert!(found.confidence < 0.6, "{}", found.confidence);
}

#[test]
fn a_scan_of_another_house_is_not_found() {
    let round: Vec<(f64, f64)> = (0..=24)
        .map(|k| Point::from_polar(7.0, f64::from(k) / 24.0 * TAU))
        .map(|p| (p.x, p.y))
        .collect();
    let found = find(&halls(), &seen(&map(&[&round]), Pose::new(1.0, 0.5, 0.0)));
    assert_eq!(found.verdict, Verdict::NotFound, "{found:?}");
}

#[test]
fn an_empty_map_and_a_blind_scan_are_no_fault() {
    let blind = Scan::new(
        ScanGeometry::new(0.0, 0.1, 3).unwrap(),
        vec![f64::NAN, f64::NAN, f64::NAN],
    )
    .unwrap();
    assert_eq!(find(&halls(), &blind).verdict, Verdict::NotFound);
    let scan = seen(&halls(), Pose::new(1.0, 1.0, 0.0));
    assert_eq!(find(&Map::default(), &scan).verdict, Verdict::NotFound);
}

#[test]
fn a_map_as_large_as_a_town_takes_larger_cells() {
    let far = map(&[&[(0.0, 0.0), (3000.0, 2000.0)], &[(5.0, 0.0), (5.0, 4.0)]]);
    let scan = seen(&halls(), Pose::new(1.0, 1.0, 0.0));
    assert_ne!(find(&far, &scan).verdict, Verdict::Located);
}

#[test]
fn poses_are_carried_on_and_a_scanner_that_was_carried_away_is_found_again() {
    let map = halls();
    let mut tracker = Tracker::new(Locator::new(&map, LocateSettings::default()));
    let mut see = |pose: Pose, stamp_s: f64| {
        let tracked = tracker.add_scan(&seen(&map, pose), Some(stamp_s));
        assert_eq!(tracked.localisation.verdict, Verdict::Located, "{pose:?}");
        assert!(is_at(&tracked.localisation.fixes[0], pose), "{pose:?}");
        tracked.is_carried_on
    };
    let carried: Vec<bool> = (0..12)
        .map(|k| {
            let pose = Pose::new(1.0 + 0.1 * f64::from(k), 1.5, 0.05 * f64::from(k));
            see(pose, 0.1 * f64::from(k))
        })
        .collect();
    assert!(!carried[0] && carried[11], "{carried:?}");
    let elsewhere = Pose::new(2.5, 8.0, -FRAC_PI_2);
    assert!(!see(elsewhere, 1.2), "a jump is no going on");
}

#[test]
fn scans_far_apart_are_each_found_on_their_own() {
    let map = halls();
    let mut tracker = Tracker::new(Locator::new(&map, LocateSettings::default()));
    for k in 0..8 {
        let pose = Pose::new(1.0 + 1.2 * f64::from(k), 1.2, 0.9 * f64::from(k));
        let tracked = tracker.add_scan(&seen(&map, pose), Some(10.0 * f64::from(k)));
        assert!(!tracked.is_carried_on);
        assert!(is_at(&tracked.localisation.fixes[0], pose), "{pose:?}");
    }
}
