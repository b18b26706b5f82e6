//! Small drawn worlds, scanned without and with noise.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::*;
use crate::geometry::{Point, Segment};
use crate::scan::ScanGeometry;

/// A world of walls.
struct World(Vec<Segment>);

impl World {
    fn chain(corners: &[(f64, f64)]) -> Self {
        let point = |&(x, y): &(f64, f64)| Point::new(x, y);
        Self(
            corners
                .windows(2)
                .map(|w| Segment::new(point(&w[0]), point(&w[1])))
                .collect(),
        )
    }

    fn with(mut self, corners: &[(f64, f64)]) -> Self {
        self.0.extend(Self::chain(corners).0);
        self
    }

    /// The scan from the origin, with a noise that has the given standard deviation.
    fn scan(&self, geometry: ScanGeometry, noise_m: f64) -> Scan {
        let mut seed = 7_u64;
        let ranges_m = (0..geometry.beams())
            .map(|beam| {
                let ray = Point::from_polar(1.0, geometry.bearing_rad(beam));
                let hits = self
                    .0
                    .iter()
                    .filter_map(|wall| wall.meet_ray(Point::default(), ray));
                let range_m = hits.map(|(t, _)| t).fold(f64::INFINITY, f64::min);
                range_m + noise_m * normal(&mut seed)
            })
            .collect();
        Scan::new(geometry, ranges_m).unwrap()
    }
}

/// About normal: the sum of twelve even numbers from a congruential sequence.
fn normal(seed: &mut u64) -> f64 {
    (0..12)
        .map(|_| {
            *seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (*seed >> 11) as f64 / (1_u64 << 53) as f64
        })
        .sum::<f64>()
        - 6.0
}

fn half_circle() -> ScanGeometry {
    ScanGeometry::new(-FRAC_PI_2, PI / 360.0, 361).unwrap()
}

fn full_circle() -> ScanGeometry {
    ScanGeometry::new(-PI, TAU / 360.0, 360).unwrap()
}

fn default(scan: &Scan) -> Extraction {
    extract(scan, &ExtractSettings::default())
}

#[test]
fn corners_are_sharp_and_walls_straight() {
    let corners = [(0.0, -2.0), (3.0, -2.0), (3.0, 2.0), (0.0, 2.0)];
    let out = default(&World::chain(&corners).scan(half_circle(), 0.01));
    assert_eq!(out.polylines.len(), 1);
    let vertices = out.polylines[0].polyline.vertices();
    assert_eq!(vertices.len(), 4, "{vertices:?}");
    for (v, (x, y)) in vertices.iter().zip(corners) {
        assert!(v.distance(Point::new(x, y)) < 0.02, "{v:?} should be ({x}, {y})");
    }
    assert_eq!(
        (out.polylines[0].first_beam, out.polylines[0].last_beam),
        (0, 360)
    );
}

#[test]
fn every_beam_hits_the_polyline_that_it_made() {
    let world = World::chain(&[(0.0, -2.0), (3.0, -2.0), (3.0, 2.0), (0.0, 2.0)]);
    let scan = world.scan(half_circle(), 0.01);
    let out = default(&scan);
    for (beam, p) in scan.points() {
        let ray = Point::from_polar(1.0, scan.geometry().bearing_rad(beam));
        let mut sides = out.polylines.iter().flat_map(|line| line.polyline.sides());
        let hit = sides.find_map(|side| side.meet_ray(Point::default(), ray));
        assert!(
            hit.is_some_and(|(t, _)| (t - p.norm()).abs() < 0.05),
            "beam {beam}: {hit:?}"
        );
    }
}

#[test]
fn noise_is_found_without_being_told() {
    let world = World::chain(&[(0.0, -2.0), (3.0, -2.0), (3.0, 2.0), (0.0, 2.0)]);
    for noise_m in [0.005, 0.01, 0.03] {
        let found_m = estimate_noise_m(&world.scan(half_circle(), noise_m)).unwrap();
        assert!((found_m / noise_m - 1.0).abs() < 0.35, "{found_m} for {noise_m}");
    }
    assert_eq!(
        estimate_noise_m(&Scan::new(half_circle(), vec![f64::NAN; 361]).unwrap()),
        None
    );
}

#[test]
fn a_room_over_the_end_of_the_circle_is_one_polyline() {
    // The wall behind the scanner is where the beams begin and end; the door is ahead.
    let world = World::chain(&[
        (2.0, 0.6),
        (2.0, 2.0),
        (-2.0, 2.0),
        (-2.0, -2.0),
        (2.0, -2.0),
        (2.0, -0.6),
    ]);
    let out = default(&world.scan(full_circle(), 0.005));
    assert_eq!(out.polylines.len(), 1);
    let line = &out.polylines[0];
    assert_eq!(line.polyline.vertices().len(), 6, "{line:?}");
    assert!(line.last_beam < line.first_beam);
}

#[test]
fn a_closed_room_has_no_vertex_inside_a_wall() {
    let world = World::chain(&[(2.0, 2.5), (-3.0, 2.5), (-3.0, -2.0), (2.0, -2.0), (2.0, 2.5)]);
    let out = default(&world.scan(full_circle(), 0.005));
    assert_eq!((out.polylines.len(), out.vertices()), (1, 5));
}

#[test]
fn a_far_grazing_wall_is_one_wall() {
    let world = World::chain(&[(0.0, -1.0), (12.0, -1.0)]);
    let out = default(&world.scan(half_circle(), 0.005));
    assert_eq!((out.polylines.len(), out.vertices()), (1, 2));
    assert!((out.polylines[0].polyline.last().x - 12.0).abs() < 1.0);
}

#[test]
fn dropouts_do_not_cut_a_wall_but_a_door_does() {
    let world = World::chain(&[(2.0, -3.0), (2.0, -0.5)]).with(&[(2.0, 0.5), (2.0, 3.0)]);
    let scan = world.scan(half_circle(), 0.005);
    let mut ranges_m = scan.ranges_m().to_vec();
    let mut seed = 3;
    for r in &mut ranges_m {
        if normal(&mut seed) > 0.5 {
            *r = f64::NAN;
        }
    }
    let out = default(&Scan::new(half_circle(), ranges_m).unwrap());
    assert_eq!(
        (out.polylines.len(), out.vertices()),
        (2, 4),
        "{:?}",
        out.polylines
    );
}

#[test]
fn a_thin_thing_in_front_of_a_wall_stays() {
    let world = World::chain(&[(4.0, -3.0), (4.0, 3.0)]).with(&[(2.0, -0.04), (2.0, 0.04)]);
    let scan = world.scan(half_circle(), 0.005);
    let is_thing = |line: &ScanPolyline| line.polyline.first().x < 2.5;
    assert_eq!(
        default(&scan)
            .polylines
            .iter()
            .filter(|&line| is_thing(line))
            .count(),
        1
    );
    // Under a budget the wall runs on behind it: four vertices are enough for both.
    let out = extract_with_budget(&scan, 4, &ExtractSettings::default());
    assert_eq!(
        (out.polylines.len(), out.returns_unused),
        (2, 0),
        "{:?}",
        out.polylines
    );
    assert_eq!(out.polylines.iter().filter(|&line| is_thing(line)).count(), 1);
}

#[test]
fn the_budget_is_kept_and_spent_on_what_matters() {
    let corners = [
        (0.0, -2.0),
        (3.0, -2.0),
        (3.0, 0.0),
        (3.03, 0.5),
        (3.0, 1.0),
        (3.0, 2.0),
        (0.0, 2.0),
    ];
    let scan = World::chain(&corners).scan(half_circle(), 0.005);
    for vertices in 0..9 {
        assert!(extract_with_budget(&scan, vertices, &ExtractSettings::default()).vertices() <= vertices);
    }
    let out = extract_with_budget(&scan, 4, &ExtractSettings::default());
    let found: Vec<Point> = out
        .polylines
        .iter()
        .flat_map(|line| line.polyline.vertices().to_vec())
        .collect();
    for (x, y) in [corners[1], corners[5]] {
        let near_m = found
            .iter()
            .map(|v| v.distance(Point::new(x, y)))
            .fold(f64::INFINITY, f64::min);
        assert!(near_m < 0.05, "no vertex near ({x}, {y}): {found:?}");
    }
}

#[test]
fn higher_relevance_levels_keep_fewer_vertices_and_the_corners() {
    let scan = World::chain(&[(0.0, -2.0), (3.0, -2.0), (3.0, 2.0), (0.0, 2.0)]).scan(half_circle(), 0.01);
    let level = |level_m: f64| extract_by_relevance(&scan, level_m, &ExtractSettings::default()).vertices();
    let counts = [0.0, 0.001, 0.005, 0.010, 0.015].map(level);
    assert_eq!(counts[0], scan.returns());
    assert!(counts.is_sorted_by(|a, b| a >= b) && counts[4] >= 4, "{counts:?}");
}

#[test]
fn scans_of_nothing_and_of_single_returns_have_no_polylines() {
    let nan = vec![f64::NAN; 361];
    for hits in [vec![], vec![100], vec![100, 200]] {
        let mut ranges_m = nan.clone();
        for &k in &hits {
            ranges_m[k] = 3.0 + k as f64 * 0.01;
        }
        let scan = Scan::new(half_circle(), ranges_m).unwrap();
        let out = default(&scan);
        assert_eq!(
            (out.polylines.len(), out.returns, out.returns_unused),
            (0, hits.len(), hits.len())
        );
        assert_eq!(
            extract_with_budget(&scan, 20, &ExtractSettings::default()).returns,
            hits.len()
        );
    }
}

#[test]
fn any_ranges_give_finite_polylines_that_do_not_turn_back() {
    let mut seed = 11;
    for geometry in [half_circle(), full_circle()] {
        for k in 0..200 {
            // From salt and pepper to walks that wander by some per cent a beam.
            let mut walk_m = 2.0;
            let ranges_m = (0..geometry.beams())
                .map(|_| {
                    walk_m *= 1.0 + 0.0005 * f64::from(k) * normal(&mut seed);
                    if k == 0 {
                        normal(&mut seed).abs() * 10.0
                    } else {
                        walk_m
                    }
                })
                .collect();
            let scan = Scan::new(geometry, ranges_m).unwrap();
            let budget = extract_with_budget(&scan, 20, &ExtractSettings::default());
            assert!(budget.vertices() <= 20);
            for line in default(&scan).polylines.iter().chain(&budget.polylines) {
                assert!(
                    line.polyline
                        .vertices()
                        .iter()
                        .all(|v| v.is_finite() && v.norm() < 1e3),
                    "{line:?}"
                );
                let mut sides = line.polyline.sides();
                assert!(
                    sides.all(|s| s.a.cross(s.b) > -0.03 * s.a.norm() * s.b.norm()),
                    "{k}: {line:?}"
                );
            }
        }
    }
}
