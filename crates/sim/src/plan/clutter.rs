//! Two rooms full of small things and plants.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use polymapper_core::geometry::Point;

use super::furniture::{cupboard, four_legs, office_chair, something_small};
use super::{Drawing, Plant};
use crate::dice::{Dice, direction};
use crate::floor::{Floor, Paint, rectangle};

/// Distance between the middles of things, so that a vehicle finds its way between them.
const SPACING_M: f64 = 1.3;

pub(super) fn draw(dice: &mut Dice) -> Drawing {
    let mut drawing = Drawing::default();
    let (width_m, height_m) = (dice.built_m(12.5, 15.0), dice.built_m(9.0, 11.0));
    let floor = &mut drawing.floor;
    floor.paint(Paint::Free, rectangle(0.0, 0.0, width_m, height_m));
    let wall_x = dice.built_m(0.42, 0.58) * width_m;
    // A wall between the rooms with an opening at either end, so that one can go round.
    floor.paint(
        Paint::Solid,
        rectangle(wall_x, 2.2, wall_x + 0.12, height_m - dice.built_m(2.0, 2.8)),
    );
    along_the_walls(floor, dice, width_m, height_m);

    drawing.stops = tour(width_m, height_m, wall_x);
    let mut taken: Vec<Point> = Vec::new();
    for k in 0..120 {
        let place = dice.point(Point::new(1.3, 1.3), Point::new(width_m - 1.3, height_m - 1.3));
        let at_wall = (place.x - wall_x).abs() < 1.1 && place.y > 1.0 && place.y < height_m - 1.0;
        let at_stop = drawing.stops.iter().any(|s| s.distance(place) < 1.2);
        if at_wall || at_stop || taken.iter().any(|t| t.distance(place) < SPACING_M) {
            continue;
        }
        taken.push(place);
        match k % 4 {
            0 if taken.len() < 16 => drawing.plants.push(Plant {
                centre: place,
                radius_m: dice.built_m(0.2, 0.38),
                depth_m: dice.between(0.12, 0.3),
            }),
            1 if taken.len() < 12 => table_with_chairs(&mut drawing.floor, dice, place),
            _ => something_small(&mut drawing.floor, dice, place),
        }
    }
    drawing.plants.push(Plant {
        centre: Point::new(0.45, height_m - 0.45),
        radius_m: 0.4,
        depth_m: 0.2,
    });
    drawing
}

/// Shelves and boxes with their backs to the outer walls.
fn along_the_walls(floor: &mut Floor, dice: &mut Dice, width_m: f64, height_m: f64) {
    let walls = [
        (Point::new(0.0, 0.0), Point::new(width_m, 0.0), FRAC_PI_2),
        (Point::new(width_m, 0.0), Point::new(width_m, height_m), PI),
        (
            Point::new(width_m, height_m),
            Point::new(0.0, height_m),
            -FRAC_PI_2,
        ),
    ];
    for (a, b, ahead_rad) in walls {
        let length_m = a.distance(b);
        let mut along_m = dice.built_m(0.8, 2.0);
        while along_m < length_m - 1.2 {
            let (long_m, deep_m) = (dice.built_m(0.3, 1.0), dice.built_m(0.15, 0.45));
            cupboard(floor, a.lerp(b, along_m / length_m), long_m, deep_m, ahead_rad);
            along_m += long_m + dice.built_m(0.4, 2.6);
        }
    }
}

fn table_with_chairs(floor: &mut Floor, dice: &mut Dice, centre: Point) {
    let bearing_rad = dice.between(0.0, PI);
    four_legs(floor, centre, 0.9, 0.7, 0.05, bearing_rad);
    let chair = centre + direction(bearing_rad + TAU * dice.share()) * 0.45;
    if dice.chance(0.5) {
        office_chair(floor, dice, chair);
    } else {
        four_legs(
            floor,
            chair,
            0.4,
            0.4,
            0.035,
            bearing_rad + dice.between(-0.4, 0.4),
        );
    }
}

/// Round through both openings, then across each room.
fn tour(width_m: f64, height_m: f64, wall_x: f64) -> Vec<Point> {
    let (below, above) = (1.1, height_m - 1.1);
    let (left, right) = (0.5 * wall_x, 0.5 * (wall_x + width_m));
    let middle = 0.5 * height_m;
    [
        (left, middle),
        (wall_x, below),
        (right, below),
        (right + 1.0, middle),
        (wall_x, above),
        (left, above),
        (left - 1.5, middle),
        (left, below),
        (wall_x, below),
        (right, middle),
        (width_m - 1.2, above),
        (wall_x, above),
        (left, middle),
    ]
    .map(|(x, y)| Point::new(x, y))
    .to_vec()
}
