//! Four bare corridors round a block: door niches are all there is to tell one place from another.

use polymapper_core::geometry::Point;

use super::Drawing;
use crate::dice::Dice;
use crate::floor::{Floor, Paint, rectangle};

pub(super) fn draw(dice: &mut Dice) -> Drawing {
    let mut drawing = Drawing::default();
    let floor = &mut drawing.floor;
    let (width_m, height_m) = (dice.built_m(30.0, 38.0), dice.built_m(16.0, 22.0));
    // Widths of the corridors below, right, above, left.
    let wide_m = [(); 4].map(|()| dice.built_m(1.8, 2.5));
    floor.paint(Paint::Free, rectangle(0.0, 0.0, width_m, height_m));
    let block = (
        Point::new(wide_m[3], wide_m[0]),
        Point::new(width_m - wide_m[1], height_m - wide_m[2]),
    );
    floor.paint(
        Paint::Solid,
        rectangle(block.0.x, block.0.y, block.1.x, block.1.y),
    );
    niches(floor, dice, (0.0, width_m), 0.0, -1.0, true);
    niches(floor, dice, (0.0, width_m), height_m, 1.0, true);
    niches(floor, dice, (0.0, height_m), 0.0, -1.0, false);
    niches(floor, dice, (0.0, height_m), width_m, 1.0, false);
    niches(floor, dice, (block.0.x, block.1.x), block.0.y, 1.0, true);
    niches(floor, dice, (block.0.x, block.1.x), block.1.y, -1.0, true);
    niches(floor, dice, (block.0.y, block.1.y), block.0.x, 1.0, false);
    niches(floor, dice, (block.0.y, block.1.y), block.1.x, -1.0, false);
    fire_doors(floor, dice, block, (width_m, height_m));
    // A bay with room for a bench: the one large feature.
    let bay_x = dice.built_m(8.0, width_m - 12.0);
    floor.paint(Paint::Free, rectangle(bay_x, -1.6, bay_x + 3.2, 0.0));

    let mid = |a: f64, b: f64| 0.5 * (a + b);
    let (left, right) = (0.5 * wide_m[3], mid(block.1.x, width_m));
    let (below, above) = (0.5 * wide_m[0], mid(block.1.y, height_m));
    let corners = [
        Point::new(right, below),
        Point::new(right, above),
        Point::new(left, above),
        Point::new(left, below),
    ];
    let start = Point::new(mid(left, right) - 4.0, below);
    // Once round, half round again, then back the other way.
    let half_way = Point::new(mid(left, right), above);
    drawing.stops = [start]
        .into_iter()
        .chain(corners)
        .chain([corners[0], corners[1], half_way, corners[1], corners[0], start])
        .collect();
    drawing
}

/// Door niches at irregular distances along a wall at coordinate `wall`, set back in direction `into`. `along_x`
/// tells whether the wall runs along x.
fn niches(floor: &mut Floor, dice: &mut Dice, span: (f64, f64), wall: f64, into: f64, along_x: bool) {
    let mut at = span.0 + dice.built_m(2.5, 6.0);
    while at < span.1 - 3.5 {
        let wide_m = if dice.chance(0.15) { 1.8 } else { 0.95 };
        let (low, high) = order(wall, wall + into * dice.built_m(0.06, 0.16));
        let outline = if along_x {
            rectangle(at, low, at + wide_m, high)
        } else {
            rectangle(low, at, high, at + wide_m)
        };
        floor.paint(Paint::Free, outline);
        at += wide_m + dice.built_m(2.4, 7.5);
    }
}

fn order(a: f64, b: f64) -> (f64, f64) {
    (a.min(b), a.max(b))
}

/// Frames of fire doors (pairs of piers) across the corridors above and below.
fn fire_doors(floor: &mut Floor, dice: &mut Dice, block: (Point, Point), size: (f64, f64)) {
    let thick_m = 0.2;
    for (low, high) in [(0.0, block.0.y), (block.1.y, size.1)] {
        let x = dice.built_m(block.0.x + 4.0, block.1.x - 4.0);
        let pier_m = dice.built_m(0.15, 0.25);
        // Reaching into the walls, past any niche.
        floor.paint(Paint::Solid, rectangle(x, low - 0.3, x + thick_m, low + pier_m));
        floor.paint(Paint::Solid, rectangle(x, high - pier_m, x + thick_m, high + 0.3));
    }
}
