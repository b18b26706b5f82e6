//! A hall with rows of racks, pillars, gates and stacks.

use polymapper_core::geometry::Point;

use super::Drawing;
use crate::dice::Dice;
use crate::floor::{Floor, Paint, rectangle, turned_rectangle};

/// Depth of a rack, and the distance between its uprights.
const RACK_M: f64 = 1.1;
const BAY_M: f64 = 2.8;

pub(super) fn draw(dice: &mut Dice) -> Drawing {
    let mut drawing = Drawing::default();
    let (width_m, height_m) = (dice.built_m(32.0, 40.0), dice.built_m(22.0, 27.0));
    let floor = &mut drawing.floor;
    floor.paint(Paint::Free, rectangle(0.0, 0.0, width_m, height_m));
    gates(floor, dice, width_m);
    wall_piers(floor, dice, width_m, height_m);

    let aisle_m = dice.built_m(2.8, 3.4);
    let first_y = dice.built_m(5.0, 6.0);
    let (rack_x0, bays) = (4.5, ((width_m - 9.0) / BAY_M) as usize);
    let rack_x1 = rack_x0 + bays as f64 * BAY_M;
    let mut row_y = first_y;
    let mut aisles = vec![row_y - 0.5 * aisle_m];
    while row_y + RACK_M + aisle_m < height_m {
        rack(floor, dice, rack_x0, row_y, bays);
        pillars(floor, (rack_x0, rack_x1), row_y + RACK_M + 0.1, width_m);
        aisles.push(row_y + RACK_M + 0.5 * aisle_m + 0.25);
        row_y += RACK_M + aisle_m + 0.5;
    }
    stacks(floor, dice, width_m);

    let (left, right) = (2.2, width_m - 2.2);
    drawing.stops.push(Point::new(left, 2.6));
    for (k, &y) in aisles.iter().enumerate() {
        let ends = if k % 2 == 0 { [left, right] } else { [right, left] };
        drawing.stops.extend(ends.map(|x| Point::new(x, y)));
    }
    // Back to the start, and through one aisle again the other way.
    let again = aisles[dice.below(aisles.len())];
    drawing.stops.push(Point::new(left, 2.6));
    drawing.stops.extend([right, left].map(|x| Point::new(x, again)));
    drawing.stops.push(Point::new(left, 2.6));
    drawing
}

/// Gates in the wall below, set back by the thickness of the wall.
fn gates(floor: &mut Floor, dice: &mut Dice, width_m: f64) {
    let deep_m = dice.built_m(0.2, 0.35);
    let mut x = dice.built_m(2.5, 5.0);
    while x < width_m - 6.0 {
        floor.paint(Paint::Free, rectangle(x, -deep_m, x + 3.2, 0.0));
        x += 3.2 + dice.built_m(2.5, 5.5);
    }
}

/// Steel piers at the walls, in the raster of the roof.
fn wall_piers(floor: &mut Floor, dice: &mut Dice, width_m: f64, height_m: f64) {
    let raster_m = dice.built_m(5.5, 7.0);
    let mut x = raster_m;
    while x < width_m - 1.0 {
        floor.paint(
            Paint::Solid,
            rectangle(x - 0.15, height_m - 0.3, x + 0.15, height_m + 0.1),
        );
        x += raster_m;
    }
    let mut y = raster_m;
    while y < height_m - 1.0 {
        floor.paint(Paint::Solid, rectangle(-0.1, y - 0.15, 0.3, y + 0.15));
        floor.paint(
            Paint::Solid,
            rectangle(width_m - 0.3, y - 0.15, width_m + 0.1, y + 0.15),
        );
        y += raster_m;
    }
}

/// Uprights in pairs, and pallets between them, not quite straight.
fn rack(floor: &mut Floor, dice: &mut Dice, x0: f64, y0: f64, bays: usize) {
    for k in 0..=bays {
        let x = x0 + k as f64 * BAY_M;
        for y in [y0, y0 + RACK_M - 0.08] {
            floor.paint(Paint::Solid, rectangle(x - 0.05, y, x + 0.05, y + 0.08));
        }
    }
    for k in 0..bays {
        for slot in [0.75, 2.05] {
            if dice.chance(0.6) {
                let centre = Point::new(
                    x0 + k as f64 * BAY_M + slot + dice.between(-0.05, 0.05),
                    y0 + 0.5 * RACK_M + dice.between(-0.1, 0.1),
                );
                let (long_m, deep_m) = (dice.built_m(0.75, 1.05), dice.built_m(0.85, 1.1));
                let turn_rad = dice.between(-0.04, 0.04);
                floor.paint(Paint::Solid, turned_rectangle(centre, long_m, deep_m, turn_rad));
            }
        }
    }
}

/// Pillars of concrete along a rack.
fn pillars(floor: &mut Floor, span: (f64, f64), y: f64, width_m: f64) {
    let raster_m = width_m / 4.0;
    for k in 1..4 {
        let x = raster_m * f64::from(k);
        if x > span.0 && x < span.1 {
            floor.paint(Paint::Solid, rectangle(x - 0.2, y, x + 0.2, y + 0.4));
        }
    }
}

/// Stacks of goods waiting near the gates.
fn stacks(floor: &mut Floor, dice: &mut Dice, width_m: f64) {
    let mut x = 5.0;
    while x < width_m - 5.0 {
        let centre = Point::new(x, dice.between(0.9, 1.3));
        let turn_rad = dice.between(-0.5, 0.5);
        let (long_m, deep_m) = (dice.built_m(0.8, 1.2), dice.built_m(0.8, 1.2));
        floor.paint(Paint::Solid, turned_rectangle(centre, long_m, deep_m, turn_rad));
        x += dice.between(2.5, 7.0);
    }
}
