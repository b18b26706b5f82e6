use super::*;
use crate::geometry::{Pose, Segment};
use crate::keyframe::drawn::{Wall, keyframe};
use crate::merge::refit::refit;

/// A room with a cupboard at its lower wall.
const ROOM: Wall = &[
    (3.0, 2.0),
    (-3.0, 2.0),
    (-3.0, -1.0),
    (-0.5, -1.0),
    (-0.5, -0.6),
    (0.5, -0.6),
    (0.5, -1.0),
    (3.0, -1.0),
    (3.0, 2.0),
];

/// The lower wall with a slant across the corner to the right of the cupboard, traced by scans from these places.
fn traced(poses_x_m: &[f64]) -> Vec<Vec<Point>> {
    let keyframes: Vec<Keyframe> = poses_x_m
        .iter()
        .map(|&x| keyframe(&[ROOM], Pose::new(x, 0.3, 0.0)))
        .collect();
    let run = |from: (f64, f64), to: (f64, f64)| {
        let (from, to) = (Point::new(from.0, from.1), Point::new(to.0, to.1));
        let pieces = (from.distance(to) / 0.04) as usize;
        (0..pieces).map(move |k| Vertex::new(from.lerp(to, k as f64 / pieces as f64), 0))
    };
    let front = run((-0.5, -0.6), (0.4, -0.6));
    let slant = run((0.4, -0.6), (0.8, -1.0));
    let wall = run((0.8, -1.0), (3.0, -1.0));
    let mut map = GrowingMap::default();
    map.add(front.chain(slant).chain(wall).collect());
    let settings = MergeSettings::default();
    let covered = refit(&mut map, &keyframes, &settings);
    retrace(&mut map, &covered, &keyframes, &settings);
    map.polylines()
        .map(|(_, p)| p.vertices.iter().map(|v| v.point).collect())
        .collect()
}

/// Length of the lines that is farther than 3 cm from the room's walls, metres.
fn off_walls_m(lines: &[Vec<Point>]) -> f64 {
    let is_off = |p: Point| {
        ROOM.windows(2).all(|side| {
            let (a, b) = (Point::new(side[0].0, side[0].1), Point::new(side[1].0, side[1].1));
            Segment::new(a, b).distance(p) > 0.03
        })
    };
    let sides = lines.iter().flat_map(|line| line.windows(2));
    sides
        .filter(|side| is_off(side[0].lerp(side[1], 0.5)))
        .map(|side| side[0].distance(side[1]))
        .sum()
}

#[test]
fn a_slant_that_nobody_saw_goes_and_the_walls_are_drawn_on() {
    let lines = traced(&[-1.2, -1.1, -1.0, -0.9, -0.8, 0.3, 0.35]);
    assert!(off_walls_m(&lines) < 0.05, "{lines:?}");
    let ends_at = |place: Point| {
        let points = lines.iter().flatten();
        points.map(|p| p.distance(place)).fold(f64::INFINITY, f64::min)
    };
    assert!(
        ends_at(Point::new(0.5, -0.6)) < 0.03,
        "the cupboard's front ends at its corner"
    );
}

#[test]
fn a_slant_before_a_face_that_was_seen_becomes_the_face() {
    let lines = traced(&[1.0, 1.1, 1.2, 1.3, 1.4, 1.5]);
    assert!(off_walls_m(&lines) < 0.05, "{lines:?}");
    assert_eq!(lines.len(), 1, "front, face and wall are one polyline");
    let on_face = |p: &&Point| (p.x - 0.5).abs() < 0.02 && p.y > -0.9 && p.y < -0.7;
    assert!(lines[0].iter().filter(on_face).count() >= 3, "{lines:?}");
}
