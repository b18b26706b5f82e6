//! Round and oblique walls: a ring-shaped corridor, a round hall inside it, and rooms outside without right angles.

use std::f64::consts::TAU;

use polymapper_core::geometry::Point;

use super::Drawing;
use crate::dice::{Dice, direction};
use crate::floor::{Floor, Paint, circle, turned_rectangle};

pub(super) fn draw(dice: &mut Dice) -> Drawing {
    let mut drawing = Drawing::default();
    let floor = &mut drawing.floor;
    let inner_m = dice.built_m(8.2, 9.2);
    let outer_m = inner_m + dice.built_m(1.9, 2.4);
    let middle_m = 0.5 * (inner_m + outer_m);
    let hall_m = dice.built_m(4.0, 4.8);
    floor.paint(Paint::Free, circle(Point::default(), outer_m));
    floor.paint(Paint::Solid, circle(Point::default(), inner_m));
    floor.paint(Paint::Free, circle(Point::default(), hall_m));
    let off_centre = Point::new(dice.between(-0.8, 0.8), dice.between(-0.8, 0.8));
    floor.paint(Paint::Solid, circle(off_centre, dice.built_m(0.4, 0.7)));

    // Three passages from the hall to the ring: not through the middle, not at even angles.
    let first_rad = dice.between(0.0, TAU);
    let passages: Vec<f64> = (0..3)
        .map(|k| first_rad + TAU / 3.0 * f64::from(k) + dice.between(-0.3, 0.3))
        .collect();
    for &bearing_rad in &passages {
        let skew_rad = dice.between(-0.35, 0.35);
        let middle = direction(bearing_rad) * (0.5 * (hall_m + inner_m));
        let wide_m = dice.built_m(1.3, 1.9);
        let long_m = inner_m - hall_m + 2.0;
        floor.paint(
            Paint::Free,
            turned_rectangle(middle, long_m, wide_m, bearing_rad + skew_rad),
        );
    }

    let rooms: Vec<f64> = (0..5)
        .map(|k| first_rad + 0.5 + TAU / 5.0 * f64::from(k))
        .collect();
    for (k, &bearing_rad) in rooms.iter().enumerate() {
        room(floor, dice, bearing_rad, outer_m, k == 0);
    }

    let on_ring = |bearing_rad: f64| direction(bearing_rad) * middle_m;
    let in_hall = off_centre + direction(first_rad) * -2.2;
    drawing.stops.push(on_ring(passages[0]));
    for &bearing_rad in &rooms {
        drawing.stops.push(on_ring(bearing_rad));
        drawing.stops.push(direction(bearing_rad) * (outer_m + 2.2));
        drawing.stops.push(on_ring(bearing_rad + 0.5));
    }
    drawing
        .stops
        .extend([on_ring(passages[0]), in_hall, on_ring(passages[1])]);
    drawing
        .stops
        .extend([on_ring(passages[2]), in_hall, on_ring(passages[0])]);
    drawing
}

/// A room outside the ring: a quadrilateral without right angles, or an apse (half round).
fn room(floor: &mut Floor, dice: &mut Dice, bearing_rad: f64, outer_m: f64, apse: bool) {
    let ahead = direction(bearing_rad);
    let left = ahead.left();
    let door_m = dice.built_m(1.2, 1.8);
    // From inside the ring to past the nearer wall of the room, oblique as it is.
    let door = ahead * (outer_m + 0.2);
    floor.paint(Paint::Free, turned_rectangle(door, 1.6, door_m, bearing_rad));
    let near_m = outer_m + 0.35;
    if apse {
        floor.paint(
            Paint::Free,
            circle(ahead * (near_m + 2.2), dice.built_m(2.2, 2.6)),
        );
    } else {
        let corner = |ahead_m: f64, left_m: f64| ahead * (near_m + ahead_m) + left * left_m;
        let near_left_m = dice.between(1.5, 2.4);
        let near_right_m = -dice.between(1.5, 2.4);
        let outline = vec![
            corner(dice.between(0.05, 0.5), near_left_m),
            corner(dice.between(0.05, 0.5), near_right_m),
            corner(dice.between(3.2, 4.6), near_right_m - dice.between(-0.6, 0.6)),
            corner(dice.between(3.2, 4.6), near_left_m + dice.between(-0.6, 0.6)),
        ];
        floor.paint(Paint::Free, outline);
    }
    if dice.chance(0.7) {
        let place = ahead * (near_m + dice.between(2.9, 3.1)) + left * dice.between(-1.0, 1.0);
        let turn_rad = dice.between(0.0, TAU);
        floor.paint(
            Paint::Solid,
            turned_rectangle(place, dice.built_m(0.5, 1.1), 0.45, turn_rad),
        );
    }
}
