//! Square cells of the plane: which one a point lies in, and which ones a segment or a ray goes through.

use std::hash::Hasher;

use super::{Point, Segment};

/// Edge of a cell, metres.
const CELL_M: f64 = 0.5;

pub(super) fn cell_of(coordinate_m: f64) -> i32 {
    (coordinate_m / CELL_M).floor() as i32
}

pub(super) fn key(cx: i32, cy: i32) -> u64 {
    (u64::from(cx as u32) << 32) | u64::from(cy as u32)
}

pub(super) fn for_each_cell(segment: Segment, mut visit: impl FnMut(u64)) {
    let length_m = segment.length_m();
    let Some(direction) = segment.direction() else {
        return;
    };
    let mut walk = CellWalk::new(segment.a, direction, length_m);
    while let Some((cell, _)) = walk.next_cell() {
        visit(cell);
    }
}

/// The cells along a ray, in order (Amanatides and Woo 1987).
pub(super) struct CellWalk {
    cell: (i32, i32),
    step: (i32, i32),
    next_m: (f64, f64),
    delta_m: (f64, f64),
    at_m: f64,
    max_m: f64,
}

impl CellWalk {
    pub(super) fn new(origin: Point, direction: Point, max_m: f64) -> Self {
        let axis = |o: f64, d: f64| {
            let cell = cell_of(o);
            if d > 1e-12 {
                (cell, 1, (f64::from(cell + 1) * CELL_M - o) / d, CELL_M / d)
            } else if d < -1e-12 {
                (cell, -1, (f64::from(cell) * CELL_M - o) / d, -CELL_M / d)
            } else {
                (cell, 0, f64::INFINITY, f64::INFINITY)
            }
        };
        let (cx, sx, nx, dx) = axis(origin.x, direction.x);
        let (cy, sy, ny, dy) = axis(origin.y, direction.y);
        Self {
            cell: (cx, cy),
            step: (sx, sy),
            next_m: (nx, ny),
            delta_m: (dx, dy),
            at_m: 0.0,
            max_m,
        }
    }

    /// The next cell and the range at which the ray leaves it.
    pub(super) fn next_cell(&mut self) -> Option<(u64, f64)> {
        if self.at_m > self.max_m {
            return None;
        }
        let cell = key(self.cell.0, self.cell.1);
        if self.next_m.0 < self.next_m.1 {
            self.at_m = self.next_m.0;
            self.next_m.0 += self.delta_m.0;
            self.cell.0 += self.step.0;
        } else {
            self.at_m = self.next_m.1;
            self.next_m.1 += self.delta_m.1;
            self.cell.1 += self.step.1;
        }
        Some((cell, self.at_m))
    }
}

/// Cell keys are small integers: one multiplication mixes them well enough and is ten times faster than SipHash.
#[derive(Clone, Copy, Default)]
pub(super) struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.write_u64(u64::from(b));
        }
    }
    fn write_u64(&mut self, key: u64) {
        let mixed = (self.0 ^ key).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = mixed ^ (mixed >> 29);
    }
}
