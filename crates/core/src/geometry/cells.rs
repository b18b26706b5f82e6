//! Square cells of the plane: which one a point lies in, and which ones a segment or a ray goes through.

use super::{Point, Segment};

/// Edge of a cell, metres.
pub(super) const CELL_M: f64 = 0.25;

/// A cell by its column and row.
pub(super) type Cell = (i32, i32);

/// Column or row that a coordinate lies in.
pub(super) fn cell_of(coordinate_m: f64) -> i32 {
    // Rounding towards zero is one instruction on every processor, rounding down a call on some.
    let scaled = coordinate_m / CELL_M;
    let towards_zero = scaled as i32;
    towards_zero.saturating_sub(i32::from(f64::from(towards_zero) > scaled))
}

/// The cell that a point lies in.
pub(super) fn cell_at(p: Point) -> Cell {
    (cell_of(p.x), cell_of(p.y))
}

/// Calls `visit` for every cell that the segment goes through.
pub(super) fn for_each_cell(segment: Segment, mut visit: impl FnMut(Cell)) {
    let first = cell_at(segment.a);
    if first == cell_at(segment.b) {
        visit(first);
        return;
    }
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
    cell: Cell,
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
    pub(super) fn next_cell(&mut self) -> Option<(Cell, f64)> {
        if self.at_m > self.max_m {
            return None;
        }
        let cell = self.cell;
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
