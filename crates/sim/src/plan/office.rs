//! Rooms on both sides of a corridor.

use std::f64::consts::{FRAC_PI_2, PI};

use polymapper_core::geometry::Point;

use super::Drawing;
use super::furniture::{cupboard, desk, door_leaf, something_small};
use crate::dice::Dice;
use crate::floor::{Paint, rectangle};

const DOOR_M: f64 = 1.0;

/// A room along the corridor: x from `x0` to `x1`, and away from the corridor from `near_y` by `depth_m`.
struct Room {
    x0: f64,
    x1: f64,
    near_y: f64,
    depth_m: f64,
    /// 1 for the rooms to the left of the corridor (larger y), −1 for those to its right.
    away: f64,
    door_x: f64,
    opens: bool,
}

impl Room {
    /// The point at `x`, `depth_m` away from the wall with the door.
    fn at(&self, x: f64, depth_m: f64) -> Point {
        Point::new(x, self.near_y + self.away * depth_m)
    }

    /// The direction back to the corridor.
    fn homeward_rad(&self) -> f64 {
        -self.away * FRAC_PI_2
    }

    fn centre(&self) -> Point {
        self.at(0.5 * (self.x0 + self.x1), 0.45 * self.depth_m)
    }
}

pub(super) fn draw(dice: &mut Dice) -> Drawing {
    let mut drawing = Drawing::default();
    let length_m = dice.built_m(26.0, 32.0);
    let width_m = dice.built_m(1.9, 2.3);
    paint_between(&mut drawing, (0.0, 0.0), (length_m, width_m));
    let mut rows = Vec::new();
    for away in [1.0, -1.0] {
        let edge_y = if away > 0.0 { width_m } else { 0.0 };
        let row = row_of_rooms(dice, length_m, edge_y, away);
        let inner_doors = paint_inner_doors(&mut drawing, dice, &row);
        for (k, room) in row.iter().enumerate() {
            let beside = Beside {
                left: k > 0 && inner_doors[k - 1],
                right: inner_doors.get(k).copied().unwrap_or(false),
            };
            paint_room(&mut drawing, dice, room, edge_y, beside);
        }
        rows.push((row, inner_doors));
    }
    furnish_corridor(&mut drawing, dice, length_m, width_m);
    tour(&mut drawing, dice, &rows, length_m, 0.5 * width_m);
    drawing
}

fn paint_between(drawing: &mut Drawing, a: (f64, f64), b: (f64, f64)) {
    let outline = rectangle(a.0.min(b.0), a.1.min(b.1), a.0.max(b.0), a.1.max(b.1));
    drawing.floor.paint(Paint::Free, outline);
}

fn row_of_rooms(dice: &mut Dice, length_m: f64, edge_y: f64, away: f64) -> Vec<Room> {
    let corridor_wall_m = dice.built_m(0.14, 0.24);
    let depth_m = dice.built_m(4.2, 5.4);
    let mut rooms = Vec::new();
    let mut x0 = dice.built_m(-0.8, 0.3);
    while x0 < length_m - 2.8 {
        let mut x1 = x0 + dice.built_m(2.9, 5.2);
        if length_m - x1 < 3.2 {
            x1 = length_m + dice.built_m(-0.2, 0.5);
        }
        let door_x = dice.built_m(
            x0.max(0.0) + 0.35,
            (x1.min(length_m) - DOOR_M - 0.35).max(x0 + 0.36),
        );
        rooms.push(Room {
            x0,
            x1,
            near_y: edge_y + away * corridor_wall_m,
            depth_m: depth_m - if dice.chance(0.3) { 0.4 } else { 0.0 },
            away,
            door_x,
            opens: dice.chance(0.75),
        });
        x0 = x1 + dice.built_m(0.1, 0.16);
    }
    rooms
}

/// Which of its neighbours a room has a door to; nothing stands in the way of these.
#[derive(Clone, Copy)]
struct Beside {
    left: bool,
    right: bool,
}

fn paint_room(drawing: &mut Drawing, dice: &mut Dice, room: &Room, edge_y: f64, beside: Beside) {
    let (left, right) = (room.door_x, room.door_x + DOOR_M);
    if !room.opens {
        // A shut door is set back a little from the wall.
        let leaf_y = edge_y + room.away * dice.built_m(0.05, 0.1);
        paint_between(drawing, (left, edge_y), (right, leaf_y));
        return;
    }
    let far_y = room.near_y + room.away * room.depth_m;
    paint_between(drawing, (room.x0, room.near_y), (room.x1, far_y));
    paint_between(drawing, (left, edge_y), (right, room.near_y));
    if dice.chance(0.6) {
        // Hinged at the left jamb, just beside the opening, standing into the room.
        let hinge = room.at(left - 0.03, 0.0);
        let opened_rad = room.away * dice.between(1.45, 2.1);
        door_leaf(&mut drawing.floor, hinge, 0.92, 0.0, opened_rad);
    }
    furnish_room(drawing, dice, room, beside);
}

fn furnish_room(drawing: &mut Drawing, dice: &mut Dice, room: &Room, beside: Beside) {
    let floor = &mut drawing.floor;
    let homeward_rad = room.homeward_rad();
    let width_m = room.x1 - room.x0;
    // A cupboard in a far corner, a desk below the window, another at a side wall.
    let cupboard_m = dice.built_m(0.8, 1.3);
    let at_left = dice.chance(0.5);
    let (cupboard_x, desk_x) = if at_left {
        (room.x0 + 0.5 * cupboard_m, room.x1 - 1.1)
    } else {
        (room.x1 - 0.5 * cupboard_m, room.x0 + 1.1)
    };
    let deep_m = dice.built_m(0.38, 0.6);
    cupboard(
        floor,
        room.at(cupboard_x, room.depth_m),
        cupboard_m,
        deep_m,
        homeward_rad,
    );
    if width_m > 3.2 {
        desk(floor, dice, room.at(desk_x, room.depth_m), homeward_rad);
    }
    let door_at_right = room.door_x - room.x0 > room.x1 - room.door_x - DOOR_M;
    let (wall_x, ahead_rad, blocked) = if door_at_right {
        (room.x0, 0.0, beside.left)
    } else {
        (room.x1, PI, beside.right)
    };
    if dice.chance(0.7) && width_m > 3.8 && !blocked {
        desk(floor, dice, room.at(wall_x, 0.4 * room.depth_m), ahead_rad);
    }
    if dice.chance(0.6) {
        let x = if at_left { room.x0 + 0.3 } else { room.x1 - 0.3 };
        let depth_m = dice.built_m(2.85, 3.1);
        something_small(floor, dice, room.at(x, depth_m));
    }
}

/// Doors from one open room to the next; returns, for each room, whether one leads to the next.
fn paint_inner_doors(drawing: &mut Drawing, dice: &mut Dice, row: &[Room]) -> Vec<bool> {
    row.windows(2)
        .map(|pair| {
            let joined = pair[0].opens && pair[1].opens && dice.chance(0.5);
            if joined {
                let depth_m = dice.built_m(1.0, 1.6);
                let (a, b) = (
                    pair[0].at(pair[0].x1, depth_m),
                    pair[1].at(pair[1].x0, depth_m + DOOR_M),
                );
                paint_between(drawing, (a.x, a.y), (b.x, b.y));
            }
            joined
        })
        .collect()
}

fn furnish_corridor(drawing: &mut Drawing, dice: &mut Dice, length_m: f64, width_m: f64) {
    // A window recess at one end, a double door at the other.
    let recess_m = dice.built_m(0.1, 0.3);
    paint_between(drawing, (-recess_m, 0.3), (0.0, width_m - 0.4));
    paint_between(
        drawing,
        (length_m, 0.25),
        (length_m + dice.built_m(0.08, 0.2), width_m - 0.25),
    );
    // A low shelf or two in the corridor, where the other wall stays more than 1.4 m away.
    for _ in 0..2 {
        let x = dice.built_m(3.0, length_m - 3.0);
        let deep_m = dice.built_m(0.22, 0.36);
        let blocks_a_door = drawing_has_door_near(drawing, x, width_m);
        if !blocks_a_door {
            cupboard(
                &mut drawing.floor,
                Point::new(x, width_m),
                0.8,
                deep_m,
                -FRAC_PI_2,
            );
        }
    }
}

/// Whether the left wall of the corridor opens within 0.8 m of `x`.
fn drawing_has_door_near(drawing: &Drawing, x: f64, width_m: f64) -> bool {
    (-8..=8).any(|k| {
        drawing
            .floor
            .is_free(Point::new(x + 0.1 * f64::from(k), width_m + 0.03))
    })
}

/// Up the corridor calling at the rooms on the left, back calling at those on the right; inner doors are used, so
/// that the tour comes out of another door than it went in. Then half way up the corridor again.
fn tour(
    drawing: &mut Drawing,
    dice: &mut Dice,
    rows: &[(Vec<Room>, Vec<bool>)],
    length_m: f64,
    middle_y: f64,
) {
    let stops = &mut drawing.stops;
    stops.push(Point::new(1.2, middle_y));
    for (row, inner_doors) in rows {
        let mut calls: Vec<Point> = Vec::new();
        for (k, room) in row.iter().enumerate() {
            let through = k > 0 && inner_doors[k - 1];
            if room.opens && (through || dice.chance(0.8)) {
                calls.push(room.centre());
                let leaves_by_next = inner_doors.get(k).copied().unwrap_or(false);
                if !leaves_by_next {
                    calls.push(Point::new(room.door_x + 0.5 * DOOR_M, middle_y));
                }
            }
        }
        if row.first().is_some_and(|room| room.away < 0.0) {
            calls.reverse();
        } else {
            calls.push(Point::new(length_m - 1.2, middle_y));
        }
        stops.extend(calls);
    }
    stops.push(Point::new(1.2, middle_y));
    stops.push(Point::new(0.5 * length_m, middle_y));
}
