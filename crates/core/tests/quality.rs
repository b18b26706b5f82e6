//! What a step says of how well its scan was placed.

mod worlds;

use polymapper_core::geometry::Pose;
use polymapper_core::mapper::{Mapper, Origin, Settings, Step};
use worlds::{LIVING, SHED, Wall, scan_from, walls};

/// Steps of a drive along the x axis, 10 cm a scan, of a scanner that sees 8 m.
fn driven(world: &[Wall], from_m: f64, to_m: f64) -> Vec<Step> {
    let mut mapper = Mapper::new(Settings::default());
    let scans = ((to_m - from_m) / 0.1) as i32;
    (0..scans)
        .map(|k| {
            let pose = Pose::new(from_m + 0.1 * f64::from(k), 0.0, 0.0);
            mapper.add_scan(&scan_from(world, pose, 8.0), None)
        })
        .collect()
}

/// Standard deviations along the corridor and across it, metres.
fn sigmas_m(step: &Step) -> (f64, f64) {
    let [[along, ..], [_, across, _], _] = step.covariance.expect("the scan is placed").rows;
    (along.sqrt(), across.sqrt())
}

#[test]
fn along_a_bare_corridor_the_place_is_known_less_and_less_until_its_end_is_in_sight() {
    let corridor = walls(&[(0.0, -1.0), (40.0, -1.0), (40.0, 1.0), (0.0, 1.0)]);
    // The end behind goes out of sight after 70 scans, the one ahead comes into it after 310.
    let steps = driven(&corridor, 1.0, 36.0);
    for (k, step) in steps.iter().enumerate().take(60).skip(2) {
        assert_eq!(step.rank, Some(3), "scan {k}");
    }
    let bare = &steps[80..300];
    for (k, step) in (80..).zip(bare) {
        assert_eq!(step.rank, Some(2), "scan {k}");
        let open = step.alignment.and_then(|a| a.unobservable);
        let open = open.expect("the walls do not tell the place along them");
        assert!(open.y.abs() < 0.02, "scan {k}: {open:?}");
        assert!(sigmas_m(step).1 < 0.02, "scan {k}: {:?}", sigmas_m(step));
    }
    for (k, pair) in (80..).zip(bare.windows(2)) {
        let (before, after) = (sigmas_m(&pair[0]).0, sigmas_m(&pair[1]).0);
        assert!(after > before, "scan {k}: {before} m, then {after} m");
    }
    let (lost_m, found_m) = (sigmas_m(&steps[299]).0, sigmas_m(&steps[340]).0);
    assert!(lost_m > 0.1 && found_m < 0.02, "{lost_m} m, then {found_m} m");
    assert_eq!(steps[340].rank, Some(3));
}

#[test]
fn a_step_says_where_its_pose_came_from() {
    let room = walls(&LIVING);
    let shed = walls(&SHED);
    let mut mapper = Mapper::new(Settings::default());
    let mut see =
        |world: &[Wall], x_m: f64| mapper.add_scan(&scan_from(world, Pose::new(x_m, 0.0, 0.0), 20.0), None);
    let first = see(&room, 0.0);
    assert_eq!(first.won, Some(Origin::First));
    assert_eq!(
        (first.rank, sigmas_m(&first)),
        (None, (0.0, 0.0)),
        "the map begins here"
    );
    let steps: Vec<Step> = (1..12).map(|k| see(&room, 0.1 * f64::from(k))).collect();
    assert_eq!(steps[10].won, Some(Origin::Predicted));
    assert_eq!(
        steps[10].quality().hypotheses,
        Some(1),
        "nothing else was looked at"
    );
    let apart = see(&shed, 0.0);
    assert_eq!((apart.won, apart.covariance), (Some(Origin::Apart), None));
    let back = see(&room, 1.2);
    assert_eq!(back.won, Some(Origin::Back));
    assert!(sigmas_m(&back).0 < 0.02, "{:?}", sigmas_m(&back));
}

#[test]
fn directions_of_the_quality_stay_with_the_scanner() {
    let corridor = walls(&[(0.0, -1.0), (40.0, -1.0), (40.0, 1.0), (0.0, 1.0)]);
    let mut mapper = Mapper::new(Settings::default());
    let mut last = None;
    for k in 0..100 {
        // Looking ahead at first, then more and more to the left: the map is as it looked at first.
        let pose = Pose::new(1.0 + 0.1 * f64::from(k), 0.0, 0.005 * f64::from(k));
        last = Some(mapper.add_scan(&scan_from(&corridor, pose, 8.0), None));
    }
    let quality = last.expect("a hundred scans").quality();
    let open_rad = quality
        .open_rad
        .expect("the walls do not tell the place along them");
    assert!(
        (open_rad + 0.495).sin().abs() < 0.02,
        "{open_rad}: along the corridor"
    );
    let rows = quality.covariance.expect("the scan is placed").rows;
    assert!(rows[0][1] < 0.0 && rows[0][0] > rows[1][1], "{rows:?}");
}
