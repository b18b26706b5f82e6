//! Merging in small drawn worlds: what the paper's section 4 promises.

use super::growing_map::GrowingMap;
use super::{MergeSettings, merge_all};
use crate::geometry::Pose;
use crate::keyframe::Keyframe;
use crate::keyframe::drawn::{Wall, keyframe};

fn merged(keyframes: &[Keyframe]) -> GrowingMap {
    let mut map = GrowingMap::default();
    merge_all(&mut map, (0..).zip(keyframes), &[], &MergeSettings::default());
    map
}

/// Length of every polyline's skeleton, shortest first.
fn lengths_m(map: &GrowingMap) -> Vec<f64> {
    let mut lengths: Vec<f64> = map
        .polylines()
        .map(|(slot, _)| map.skeleton.sides_of(slot).map(|s| s.length_m).sum())
        .collect();
    lengths.sort_by(f64::total_cmp);
    lengths
}

/// A wall 6 m long, 2 m ahead, that faces the scanner.
const WALL: Wall = &[(2.0, -3.0), (2.0, 3.0)];

#[test]
fn a_wall_seen_from_two_places_stands_once() {
    let map = merged(&[
        keyframe(&[WALL], Pose::IDENTITY),
        keyframe(&[WALL], Pose::new(0.5, 1.0, 0.4)),
    ]);
    let lengths = lengths_m(&map);
    assert_eq!(lengths.len(), 1, "{lengths:?}");
    assert!((lengths[0] - 6.0).abs() < 0.1, "{lengths:?}");
}

#[test]
fn merging_the_same_scan_again_changes_nothing_but_the_evidence() {
    let seen = keyframe(&[WALL, &[(1.0, 3.5), (-2.0, 3.5), (-2.0, 1.0)]], Pose::IDENTITY);
    let once = merged(std::slice::from_ref(&seen));
    let twice = merged(&[seen.clone(), seen]);
    let (a, b) = (lengths_m(&once), lengths_m(&twice));
    assert_eq!(a.len(), b.len());
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 0.01), "{a:?} {b:?}");
    let hits = |map: &GrowingMap| {
        map.polylines()
            .flat_map(|(_, p)| &p.vertices)
            .map(|v| v.hits)
            .min()
    };
    assert_eq!((hits(&once), hits(&twice)), (Some(1), Some(2)));
}

#[test]
fn the_weight_is_on_the_map() {
    // Nine scans put the wall at 2.00 m, a tenth at 2.10 m: the mean is 2.01 m.
    let mut keyframes = vec![keyframe(&[WALL], Pose::IDENTITY); 9];
    keyframes.push(keyframe(&[&[(2.1, -3.0), (2.1, 3.0)]], Pose::IDENTITY));
    let map = merged(&keyframes);
    let middle: Vec<f64> = map
        .polylines()
        .flat_map(|(_, p)| &p.vertices)
        .filter(|v| v.point.y.abs() < 2.0 && v.hits == 10)
        .map(|v| v.point.x)
        .collect();
    assert!(middle.len() > 20);
    assert!(middle.iter().all(|x| (x - 2.01).abs() < 0.005), "{middle:?}");
}

#[test]
fn parts_of_a_wall_are_joined_when_a_scan_sees_them_as_one() {
    // A pillar hides the middle of the wall from the first place, not from the second.
    let pillar: Wall = &[(1.0, -0.2), (1.0, 0.2)];
    let first = keyframe(&[WALL, pillar], Pose::IDENTITY);
    let parted = merged(std::slice::from_ref(&first));
    assert_eq!(lengths_m(&parted).len(), 3, "two parts and the pillar");
    let whole = merged(&[first, keyframe(&[WALL], Pose::new(1.5, 0.0, 0.0))]);
    let lengths = lengths_m(&whole);
    assert!((lengths[lengths.len() - 1] - 6.0).abs() < 0.15, "{lengths:?}");
}

#[test]
fn a_door_that_opened_gives_two_polylines() {
    // First shut, in line with the wall; then open, at 30° into the room.
    let shut: Wall = &[(2.0, -3.0), (2.0, 1.0)];
    let open: Wall = &[(2.0, -3.0), (2.0, 0.0), (1.5, 0.866)];
    let mut map = GrowingMap::default();
    let settings = MergeSettings::default();
    let keyframes = [
        keyframe(&[shut], Pose::IDENTITY),
        keyframe(&[open], Pose::IDENTITY),
    ];
    merge_all(&mut map, (0..).zip(&keyframes), &[], &settings);
    let lengths = lengths_m(&map);
    assert_eq!(lengths.len(), 2, "{lengths:?}");
    assert!(
        (lengths[0] - 0.8).abs() < 0.25,
        "the branch of the shut door: {lengths:?}"
    );
    assert!((lengths[1] - 4.0).abs() < 0.2, "wall and open door: {lengths:?}");
}

#[test]
fn what_scans_look_through_is_taken_out() {
    let passer_by: Wall = &[(1.0, -0.3), (1.0, 0.3)];
    let mut keyframes = vec![keyframe(&[WALL, passer_by], Pose::IDENTITY)];
    keyframes.extend(vec![keyframe(&[WALL], Pose::IDENTITY); 4]);
    let map = merged(&keyframes);
    let near = map
        .polylines()
        .flat_map(|(_, p)| &p.vertices)
        .filter(|v| v.point.x < 1.5)
        .count();
    assert_eq!(near, 0, "somebody who walked by once");
}

#[test]
fn the_other_side_of_a_thin_wall_is_another_wall() {
    let back: Wall = &[(2.08, 3.0), (2.08, -3.0)];
    let map = merged(&[
        keyframe(&[WALL, back], Pose::IDENTITY),
        keyframe(&[WALL, back], Pose::new(4.0, 0.0, 0.0)),
    ]);
    let lengths = lengths_m(&map);
    assert_eq!(lengths.len(), 2, "{lengths:?}");
    assert!(lengths.iter().all(|l| (l - 6.0).abs() < 0.1), "{lengths:?}");
}
