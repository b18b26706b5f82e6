//! Things that stand about, as a scanner sees them 0.3 m above the floor.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use polymapper_core::geometry::Point;

use crate::dice::{Dice, direction};
use crate::floor::{Floor, Paint, circle, turned_rectangle};

/// An office chair: the column, and castors on a star of five feet.
pub(super) fn office_chair(floor: &mut Floor, dice: &mut Dice, centre: Point) {
    floor.paint(Paint::Solid, circle(centre, 0.035));
    let turn_rad = dice.between(0.0, TAU);
    for k in 0..5 {
        let foot = centre + direction(turn_rad + TAU * f64::from(k) / 5.0) * 0.28;
        floor.paint(Paint::Solid, circle(foot, 0.025));
    }
}

/// A chair or table: four square legs at the corners of a box.
pub(super) fn four_legs(
    floor: &mut Floor,
    centre: Point,
    length_m: f64,
    width_m: f64,
    leg_m: f64,
    bearing_rad: f64,
) {
    let along = direction(bearing_rad) * (0.5 * length_m);
    let across = direction(bearing_rad).left() * (0.5 * width_m);
    for corner in [along + across, across - along, -along - across, along - across] {
        floor.paint(
            Paint::Solid,
            turned_rectangle(centre + corner, leg_m, leg_m, bearing_rad),
        );
    }
}

/// A desk with its back to the wall: two legs at one end, a box of drawers at the other, a chair before it.
/// `back` is the middle of its back edge, `ahead_rad` the direction away from the wall.
pub(super) fn desk(floor: &mut Floor, dice: &mut Dice, back: Point, ahead_rad: f64) {
    let length_m = dice.built_m(1.3, 1.8);
    let ahead = direction(ahead_rad);
    let side = if dice.chance(0.5) {
        ahead.left()
    } else {
        -ahead.left()
    };
    let drawers = back + ahead * 0.4 + side * (0.5 * length_m - 0.22);
    floor.paint(Paint::Solid, turned_rectangle(drawers, 0.6, 0.42, ahead_rad));
    for depth_m in [0.08, 0.72] {
        let leg = back + ahead * depth_m - side * (0.5 * length_m - 0.05);
        floor.paint(Paint::Solid, turned_rectangle(leg, 0.05, 0.05, ahead_rad));
    }
    if dice.chance(0.8) {
        let pushed_m = dice.between(-0.25, 0.15);
        office_chair(floor, dice, back + ahead * 0.95 + side * pushed_m);
    }
}

/// The leaf of a door that stands open, `opened_rad` away from the closed position. `hinge` is in the plane of
/// the wall, `closed_rad` the direction of the shut leaf seen from the hinge, positive angles open leftwards.
pub(super) fn door_leaf(floor: &mut Floor, hinge: Point, width_m: f64, closed_rad: f64, opened_rad: f64) {
    let bearing_rad = closed_rad + opened_rad;
    let middle = hinge + direction(bearing_rad) * (0.5 * width_m);
    floor.paint(Paint::Solid, turned_rectangle(middle, width_m, 0.04, bearing_rad));
}

/// Something small at a random angle: a box, a bin, a stool, or a chair with four legs.
pub(super) fn something_small(floor: &mut Floor, dice: &mut Dice, centre: Point) {
    let bearing_rad = dice.between(0.0, PI);
    match dice.below(5) {
        0 => floor.paint(Paint::Solid, circle(centre, dice.built_m(0.12, 0.2))),
        1 => office_chair(floor, dice, centre),
        2 => {
            let width_m = dice.built_m(0.38, 0.46);
            four_legs(floor, centre, 0.42, width_m, 0.035, bearing_rad);
        }
        _ => {
            let length_m = dice.built_m(0.25, 0.7);
            let width_m = dice.built_m(0.2, 0.45);
            floor.paint(
                Paint::Solid,
                turned_rectangle(centre, length_m, width_m, bearing_rad),
            );
        }
    }
}

/// A box standing with its back to a wall. `back` is the middle of its back edge; the box reaches 2 cm into the
/// wall, so that nothing is left between them.
pub(super) fn cupboard(floor: &mut Floor, back: Point, length_m: f64, depth_m: f64, ahead_rad: f64) {
    let middle = back + direction(ahead_rad) * (0.5 * depth_m - 0.01);
    floor.paint(
        Paint::Solid,
        turned_rectangle(middle, length_m, depth_m + 0.02, ahead_rad + FRAC_PI_2),
    );
}
