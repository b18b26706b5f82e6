//! Places that look alike are not taken for one another, and those that are the same are still recognised.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use polymapper_core::geometry::Pose;
use polymapper_core::mapper::{Mapper, Outcome, Settings};
use polymapper_sim::{
    Motion, PlanKind, Scanner, ScannerKind, SimSettings, fit_trajectory, simulate, trajectory_error,
};

/// How far off each recognised place is against the truth, metres.
fn recognised(plan: PlanKind, kind: ScannerKind) -> Vec<f64> {
    let log = simulate(&SimSettings {
        scanner: Scanner::new(kind),
        motion: Motion::full_rate(),
        ..SimSettings::new(plan, 1)
    })
    .unwrap();
    let mut mapper = Mapper::new(Settings::default());
    let mut off_m = Vec::new();
    for scan in &log.scans {
        let step = mapper.add_scan(scan, None);
        if let Some(old) = step.recognised {
            let outcomes = mapper.outcomes();
            let motion = pose(&outcomes[old]).inverse() * pose(&outcomes[step.scan]);
            let truly = log.truth_poses[old].inverse() * log.truth_poses[step.scan];
            off_m.push(motion.distance(truly));
        }
    }
    off_m
}

fn pose(outcome: &Outcome) -> Pose {
    match *outcome {
        Outcome::Placed { map_from_scan } => map_from_scan,
        Outcome::NotPlaced { reason } => panic!("not placed: {reason:?}"),
    }
}

/// How far off the worst pose of a scanner that reaches 5.6 m is in the end, metres, after the best fit; nearly all scans
/// must have one.
fn farthest_off_m(plan: PlanKind, motion: Motion, seed: u64) -> f64 {
    let log = simulate(&SimSettings {
        scanner: Scanner::new(ScannerKind::Hokuyo240),
        motion,
        ..SimSettings::new(plan, seed)
    })
    .unwrap();
    let mut mapper = Mapper::new(Settings::default());
    for scan in &log.scans {
        mapper.add_scan(scan, None);
    }
    mapper.settle();
    let outcomes = mapper.outcomes();
    let placed: Vec<(usize, Pose)> = outcomes
        .iter()
        .enumerate()
        .filter(|(_, outcome)| matches!(outcome, Outcome::Placed { .. }))
        .map(|(scan, outcome)| (scan, pose(outcome)))
        .collect();
    assert!(
        50 * placed.len() > 49 * outcomes.len(),
        "{} of {} placed",
        placed.len(),
        outcomes.len()
    );
    let world_from_map = fit_trajectory(&placed, &log.truth_poses).unwrap();
    let error = trajectory_error(&placed, &log.truth_poses, world_from_map).unwrap();
    error.max_translation_m
}

/// Five metres before the place where it began, the scanner sees the same two walls with niches of 6 to 16 cm; the scans fit
/// there, too, if they had drifted five metres. They fit nearer, where less of the old place is in sight.
#[test]
fn a_bare_corridor_is_closed_where_it_began_and_not_five_metres_before() {
    let off_m = recognised(PlanKind::CorridorLoop, ScannerKind::Sick180);
    assert!(!off_m.is_empty() && off_m.iter().all(|m| *m < 0.2), "{off_m:?}");
}

/// One end of an aisle looks like the next to a scanner that reaches 5.6 m.
#[test]
fn one_aisle_of_a_warehouse_is_not_taken_for_the_next() {
    let off_m = recognised(PlanKind::Warehouse, ScannerKind::Hokuyo240);
    assert!(off_m.len() >= 3 && off_m.iter().all(|m| *m < 0.2), "{off_m:?}");
}

/// Between the aisles of a warehouse a scanner that reaches 5.6 m sees two posts, which fit nearly anywhere: taken at their word, they
/// put it 1.6 m off, where it had moved on by 5 cm as ever.
#[test]
fn two_posts_do_not_outweigh_the_motion_so_far() {
    let off_m = farthest_off_m(PlanKind::Warehouse, Motion::full_rate(), 4);
    assert!(off_m < 0.3, "{off_m} m");
}

/// For ten metres at a time it sees nothing but two round walls, and these look the same wherever it is: it goes on as it
/// went before.
#[test]
fn a_scanner_that_reaches_five_metres_finds_its_way_round_a_ring() {
    let off_m = farthest_off_m(PlanKind::Oblique, Motion::full_rate(), 1);
    assert!(off_m < 0.5, "{off_m} m");
}

/// The scanner sees half of a round room, turns on the spot without any sign of it, and then sees the way out again: this must not
/// become another way out (it was, 36° to 53° beside it).
#[test]
fn a_turn_in_a_round_room_is_told_by_the_way_out() {
    for seed in [4, 5, 10] {
        let log = simulate(&SimSettings {
            scanner: Scanner::new(ScannerKind::Sick180),
            motion: Motion {
                max_scans: 300,
                ..Motion::full_rate()
            },
            ..SimSettings::new(PlanKind::Oblique, seed)
        })
        .unwrap();
        let mut mapper = Mapper::new(Settings::default());
        for scan in &log.scans {
            mapper.add_scan(scan, None);
        }
        let outcomes = mapper.outcomes();
        let last = outcomes.len() - 1;
        let motion = pose(&outcomes[0]).inverse() * pose(&outcomes[last]);
        let truly = log.truth_poses[0].inverse() * log.truth_poses[last];
        let off_m = motion.distance(truly);
        assert!(off_m < 0.5, "seed {seed}: {off_m} m off after the room");
    }
}

/// One room of an office is like the next. The returns of a room that is entered lie before the backs of the walls that its neighbours
/// show: that does not speak for the room that it is like, 4 m away.
#[test]
fn a_room_that_is_entered_is_not_taken_for_a_known_one() {
    for seed in [1, 8] {
        let off_m = farthest_off_m(PlanKind::Office, Motion::keyframes(), seed);
        assert!(off_m < 0.1, "seed {seed}: {off_m}");
    }
}
