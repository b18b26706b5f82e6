//! What becomes of scans that fit nowhere: they are kept apart, never merged just to keep going, and found again.

mod worlds;

use polymapper_core::geometry::Pose;
use polymapper_core::mapper::{Mapper, NotPlaced, Outcome, Settings};
use worlds::{LIVING, SHED, Wall, scan_from, walls};

fn placed(outcome: &Outcome) -> Option<Pose> {
    match *outcome {
        Outcome::Placed { map_from_scan } => Some(map_from_scan),
        Outcome::NotPlaced { .. } => None,
    }
}

#[test]
fn another_room_is_kept_apart_and_the_first_one_taken_up_again() {
    let living = walls(&LIVING);
    let shed = walls(&SHED);
    let mut mapper = Mapper::new(Settings::default());
    let walk = |k: i32| Pose::new(0.1 * f64::from(k), 0.02 * f64::from(k), 0.03 * f64::from(k));
    for k in 0..12 {
        mapper.add_scan(&scan_from(&living, walk(k), 20.0), None);
    }
    for k in 0..5 {
        mapper.add_scan(
            &scan_from(&shed, Pose::new(0.0, 0.0, 0.1 * f64::from(k)), 20.0),
            None,
        );
    }
    for k in 12..18 {
        mapper.add_scan(&scan_from(&living, walk(k), 20.0), None);
    }
    let outcomes = mapper.outcomes();
    for (k, outcome) in outcomes[12..17].iter().enumerate() {
        let apart = Outcome::NotPlaced {
            reason: NotPlaced::SeparateSubmap,
        };
        assert_eq!(*outcome, apart, "scan {k} of the shed");
    }
    for (k, outcome) in (12..18).zip(&outcomes[17..]) {
        let off_m = placed(outcome).map(|p| p.distance(walk(k)));
        assert!(off_m.is_some_and(|m| m < 0.03), "{outcome:?} after the shed");
    }
    let map = mapper.map();
    let wall_m: f64 = map
        .polylines
        .iter()
        .filter_map(|p| p.polyline())
        .map(|p| p.length_m())
        .sum();
    assert!(
        (wall_m - 24.0).abs() < 0.5,
        "{wall_m} m of wall: the shed is not among it"
    );
}

/// A hall of 10 m × 4 m with uneven pilasters, and a narrow corridor of 14 m with niches that leads on from it.
fn hall_and_corridor() -> Vec<Wall> {
    walls(&[
        (0.0, 0.0),
        (1.3, 0.0),
        (1.3, 0.5),
        (1.7, 0.5),
        (1.7, 0.0),
        (4.4, 0.0),
        (4.4, 0.3),
        (5.6, 0.3),
        (5.6, 0.0),
        (7.1, 0.0),
        (7.1, 0.7),
        (7.4, 0.7),
        (7.4, 0.0),
        (10.0, 0.0),
        (10.0, 1.3),
        (12.1, 1.3),
        (12.1, 0.9),
        (12.9, 0.9),
        (12.9, 1.3),
        (16.2, 1.3),
        (16.2, 0.7),
        (16.6, 0.7),
        (16.6, 1.3),
        (24.0, 1.3),
        (24.0, 2.7),
        (18.4, 2.7),
        (18.4, 3.3),
        (17.5, 3.3),
        (17.5, 2.7),
        (14.4, 2.7),
        (14.4, 3.0),
        (13.6, 3.0),
        (13.6, 2.7),
        (10.0, 2.7),
        (10.0, 4.0),
        (6.3, 4.0),
        (6.3, 3.2),
        (5.9, 3.2),
        (5.9, 4.0),
        (3.1, 4.0),
        (3.1, 3.6),
        (2.2, 3.6),
        (2.2, 4.0),
        (0.0, 4.0),
    ])
}

#[test]
fn a_map_kept_apart_is_joined_when_the_scanner_comes_back_to_a_known_place() {
    let hall = hall_and_corridor();
    let reach_m = 4.5;
    let mut mapper = Mapper::new(Settings::default());
    // Through the hall, in the dark to the far end of the corridor, and back to where it was.
    let there = (0..20).map(|k| 2.0 + 0.2 * f64::from(k));
    let back = (0..75).map(|k| 19.0 - 0.2 * f64::from(k));
    let truth: Vec<Pose> = there.chain(back).map(|x| Pose::new(x, 2.0, 0.0)).collect();
    for pose in &truth {
        mapper.add_scan(&scan_from(&hall, *pose, reach_m), None);
    }
    let outcomes = mapper.outcomes();
    let lost = outcomes.iter().filter(|o| placed(o).is_none()).count();
    assert_eq!(lost, 0, "scans without a place in the one map");
    let relative = |k: usize| truth[0].inverse() * truth[k];
    let frame = placed(&outcomes[0]).unwrap();
    for (k, outcome) in outcomes.iter().enumerate() {
        let off_m = (frame * relative(k)).distance(placed(outcome).unwrap());
        assert!(off_m < 0.1, "scan {k} is {off_m} m off");
    }
}

/// Where a corridor widens: from and to, metres along it, and how far, metres; below its axis and above.
type Niches<'a> = &'a [(f64, f64, f64)];

/// A corridor of 40 m × 2 m along the x axis with niches on either side.
fn corridor(below: Niches, above: Niches) -> Vec<Wall> {
    let side = |niches: Niches, y: f64| {
        let niche = |&(from, to, depth): &(f64, f64, f64)| {
            let deep = y + depth * y.signum();
            [(from, y), (from, deep), (to, deep), (to, y)]
        };
        niches.iter().flat_map(niche).collect::<Vec<_>>()
    };
    let mut corners = vec![(0.0, -1.0)];
    corners.extend(side(below, -1.0));
    corners.extend([(40.0, -1.0), (40.0, 1.0)]);
    corners.extend(side(above, 1.0).into_iter().rev());
    corners.push((0.0, 1.0));
    walls(&corners)
}

/// Drives along a corridor.
fn drive(mapper: &mut Mapper, corridor: &[Wall], from_m: f64, to_m: f64) -> usize {
    let steps = ((to_m - from_m) / 0.25) as i32;
    for k in 0..steps {
        let pose = Pose::new(from_m + 0.25 * f64::from(k), 0.0, 0.0);
        mapper.add_scan(&scan_from(corridor, pose, 8.0), None);
    }
    steps as usize
}

#[test]
fn a_corridor_that_begins_and_ends_unlike_a_known_one_is_not_taken_for_it() {
    let alike_below = [
        (11.0, 12.1, 0.4),
        (15.2, 15.8, 0.7),
        (19.0, 21.3, 0.3),
        (24.7, 25.5, 0.5),
        (30.2, 31.1, 0.4),
    ];
    let alike_above = [
        (9.3, 10.0, 0.5),
        (13.3, 14.8, 0.3),
        (17.5, 18.1, 0.6),
        (22.2, 23.1, 0.4),
        (27.9, 29.4, 0.3),
        (32.0, 32.7, 0.6),
    ];
    let with = |first: &[(f64, f64, f64)], alike: &[(f64, f64, f64)], last: &[(f64, f64, f64)]| {
        [first, alike, last].concat()
    };
    let known = corridor(
        &with(
            &[(2.0, 3.1, 0.5), (6.4, 7.0, 0.3)],
            &alike_below,
            &[(35.0, 36.2, 0.6)],
        ),
        &with(&[(4.1, 5.5, 0.4)], &alike_above, &[(37.2, 38.0, 0.3)]),
    );
    let other = corridor(
        &with(&[(0.0, 7.5, 2.5)], &alike_below, &[(33.5, 39.0, 1.4)]),
        &with(
            &[(0.0, 3.0, 1.6), (5.0, 8.0, 3.0)],
            &alike_above,
            &[(34.5, 36.0, 2.2)],
        ),
    );
    let mut mapper = Mapper::new(Settings::default());
    let seen = drive(&mut mapper, &known, 1.0, 39.0);
    // In the dark to where the other one begins.
    drive(&mut mapper, &other, 1.0, 34.0);
    let outcomes = mapper.outcomes();
    assert!(outcomes[..seen].iter().all(|o| placed(o).is_some()));
    let taken = outcomes[seen..].iter().filter(|o| placed(o).is_some()).count();
    assert_eq!(taken, 0, "scans of the other corridor in the known one");
}
