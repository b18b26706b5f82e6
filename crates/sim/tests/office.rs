//! What a user may expect of a map: the simulated office, through the whole mapper, measured against the truth.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use polymapper_core::geometry::{Polyline, Pose};
use polymapper_core::map::MapPolyline;
use polymapper_core::mapper::{Mapper, Outcome, Settings};
use polymapper_sim::{
    MapScore, Motion, PlanKind, Scanner, ScannerKind, SimSettings, TrajectoryError, fit_trajectory,
    score_map, simulate, trajectory_error,
};

/// A built map against the truth.
#[derive(Debug)]
struct Built {
    map: MapScore,
    trajectory: TrajectoryError,
    scans: usize,
    not_placed: usize,
}

/// The office of seed 1 at 10 Hz, with 1 cm of noise.
fn office(kind: ScannerKind, people: usize) -> Built {
    let scanner = Scanner::new(kind);
    assert!((scanner.noise_m - 0.01).abs() < 1e-9);
    let log = simulate(&SimSettings {
        scanner,
        motion: Motion::full_rate(),
        people,
        ..SimSettings::new(PlanKind::Office, 1)
    })
    .unwrap();
    let mut mapper = Mapper::new(Settings::default());
    for scan in &log.scans {
        mapper.add_scan(scan, None);
    }
    let pose = |(scan, outcome): (usize, &Outcome)| match outcome {
        Outcome::Placed { map_from_scan } => Some((scan, *map_from_scan)),
        Outcome::NotPlaced { .. } => None,
    };
    let placed: Vec<(usize, Pose)> = mapper.outcomes().iter().enumerate().filter_map(pose).collect();
    let world_from_map = fit_trajectory(&placed, &log.truth_poses).unwrap();
    let walls: Vec<Polyline> = mapper
        .map()
        .polylines
        .iter()
        .filter_map(MapPolyline::polyline)
        .collect();
    Built {
        map: score_map(&walls, world_from_map, &log.map_truth()),
        trajectory: trajectory_error(&placed, &log.truth_poses, world_from_map).unwrap(),
        scans: log.scans.len(),
        not_placed: log.scans.len() - placed.len(),
    }
}

fn check(result: &Built) {
    assert!(result.map.within_5cm.f_score() >= 0.95, "{result:#?}");
    // The doors are 0.8 m wide and more.
    assert!(result.trajectory.mean_translation_m < 0.03, "{result:#?}");
    assert!(result.trajectory.max_translation_m < 0.2, "{result:#?}");
    assert!(result.not_placed * 100 <= result.scans, "{result:#?}");
}

#[test]
fn an_office_has_its_walls_once_and_in_place() {
    for kind in [ScannerKind::Sick180, ScannerKind::LowCost360] {
        let result = office(kind, 0);
        check(&result);
        assert!(result.map.doubled_ratio <= 0.02, "{result:#?}");
    }
}

#[test]
fn people_who_walk_about_are_no_walls() {
    for kind in [ScannerKind::Sick180, ScannerKind::LowCost360] {
        let result = office(kind, 3);
        check(&result);
        assert!(result.map.people_ratio <= 0.05, "{result:#?}");
    }
}
