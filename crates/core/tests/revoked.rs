//! What becomes of a recognised place that everything else contradicts.

use polymapper_core::geometry::Pose;
use polymapper_core::join::SavedEdge;
use polymapper_core::mapper::{Mapper, Settings};
use polymapper_sim::{Motion, PlanKind, SimSettings, simulate};

#[test]
fn a_closure_that_all_else_contradicts_is_taken_out_and_says_why() {
    let log = simulate(&SimSettings {
        motion: Motion::keyframes(),
        ..SimSettings::new(PlanKind::Clutter, 1)
    })
    .expect("the settings are sound");
    let mut mapper = Mapper::new(Settings::default());
    for scan in &log.scans {
        mapper.add_scan(scan, None);
    }
    let mut right = mapper.saved();
    assert_eq!(right.agree(&Settings::default()), []);
    let closure = right.edges.iter().find(|e| e.is_loop).copied();
    let closure = closure.expect("the tour comes by the same place twice");

    let mut with = right.clone();
    let (from, to) = (2, with.keyframes.len() - 2);
    let apart_m = with.keyframes[from]
        .map_from_scan
        .distance(with.keyframes[to].map_from_scan);
    assert!(apart_m > 1.0, "{apart_m}");
    with.edges.push(SavedEdge {
        from,
        to,
        motion: Pose::IDENTITY,
        ..closure
    });
    let revoked = with.agree(&Settings::default());
    let [one] = revoked[..] else { panic!("{revoked:?}") };
    assert_eq!(
        (one.recognised, one.scan),
        (with.keyframes[from].number, with.keyframes[to].number)
    );
    assert!((one.off_m - apart_m).abs() < 0.1, "{one} {apart_m}");
    assert!(one.to_string().contains("standard deviations"), "{one}");
    assert_eq!(with.edges.len(), right.edges.len());
    for (a, b) in with.keyframes.iter().zip(&right.keyframes) {
        assert!(a.map_from_scan.distance(b.map_from_scan) < 0.01);
    }
}
