//! The sides of walls, binned so that rays and near sides are found fast.
//!
//! A uniform grid; a ray walks from cell to cell (Amanatides and Woo, "A fast voxel traversal algorithm for
//! ray tracing", 1987) and stops at the first hit inside the cell it is in.

use polymapper_core::geometry::{Point, Polyline, Segment};

use crate::floor::bounds;

/// Small enough to hold few sides, large enough that a ray of 10 m passes few cells.
const CELL_M: f64 = 0.5;
/// Cells across; a map with a stray vertex kilometres away gets larger cells instead of more.
const MOST_CELLS: f64 = 1000.0;

/// Where a ray met a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SideHit {
    /// Distance along the ray, metres.
    pub(crate) range_m: f64,
    /// Number of the side, counted through all polylines.
    pub(crate) side: usize,
    /// Share of the side, 0..=1.
    pub(crate) share: f64,
}

/// All sides of a set of polylines with a grid over them.
pub(crate) struct SideGrid {
    sides: Vec<Segment>,
    min: Point,
    cell_m: f64,
    columns: usize,
    rows: usize,
    /// Sides of cell k: `items[starts[k]..starts[k + 1]]`.
    starts: Vec<usize>,
    items: Vec<usize>,
}

impl SideGrid {
    pub(crate) fn new(polylines: &[Polyline]) -> Self {
        let sides: Vec<Segment> = polylines.iter().flat_map(Polyline::sides).collect();
        let ends: Vec<Point> = sides.iter().flat_map(|s| [s.a, s.b]).collect();
        let (low, high) = if ends.is_empty() {
            (Point::default(), Point::default())
        } else {
            bounds(&ends)
        };
        let cell_m = CELL_M.max((high.x - low.x).max(high.y - low.y) / MOST_CELLS);
        let min = low - Point::new(0.5, 0.5) * cell_m;
        let count = |from: f64, to: f64| ((to - from) / cell_m) as usize + 2;
        let (columns, rows) = (count(min.x, high.x), count(min.y, high.y));
        let mut grid = Self {
            sides,
            min,
            cell_m,
            columns,
            rows,
            starts: Vec::new(),
            items: Vec::new(),
        };
        grid.fill();
        grid
    }

    fn fill(&mut self) {
        let mut cells: Vec<Vec<usize>> = vec![Vec::new(); self.columns * self.rows];
        // Half a cell's diagonal, with room for rounding: sides on the border of two cells stand in both.
        let reach_m = self.cell_m * 0.7072;
        for (k, side) in self.sides.iter().enumerate() {
            let (low, high) = bounds(&[side.a, side.b]);
            for (column, row) in self.cells_of_box(low, high) {
                let middle = self.min + Point::new(column as f64 + 0.5, row as f64 + 0.5) * self.cell_m;
                if side.distance(middle) <= reach_m {
                    cells[row * self.columns + column].push(k);
                }
            }
        }
        self.starts.push(0);
        for cell in cells {
            self.items.extend(cell);
            self.starts.push(self.items.len());
        }
    }

    /// Cells that a box touches, with a hair's breadth more.
    fn cells_of_box(&self, low: Point, high: Point) -> impl Iterator<Item = (usize, usize)> + use<> {
        let cell_m = self.cell_m;
        let index = |v: f64, count: usize| ((v / cell_m).floor().max(0.0) as usize).min(count - 1);
        let hair = Point::new(1e-9, 1e-9);
        let (low, high) = (low - self.min - hair, high - self.min + hair);
        let (left, right) = (index(low.x, self.columns), index(high.x, self.columns));
        let (bottom, top) = (index(low.y, self.rows), index(high.y, self.rows));
        (bottom..=top).flat_map(move |row| (left..=right).map(move |column| (column, row)))
    }

    fn cell(&self, column: usize, row: usize) -> &[usize] {
        let k = row * self.columns + column;
        &self.items[self.starts[k]..self.starts[k + 1]]
    }

    pub(crate) fn sides(&self) -> &[Segment] {
        &self.sides
    }

    /// The first side that the ray meets within `reach_m`; `direction` has length 1.
    pub(crate) fn cast(&self, origin: Point, direction: Point, reach_m: f64) -> Option<SideHit> {
        let at = (origin - self.min) / self.cell_m;
        let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < self.columns as f64 && at.y < self.rows as f64;
        if !inside {
            return first_hit(&self.sides, 0..self.sides.len(), origin, direction)
                .filter(|h| h.range_m < reach_m);
        }
        let mut walk = Walk::new(at, direction);
        loop {
            let candidates = self.cell(walk.column, walk.row).iter().copied();
            let hit = first_hit(&self.sides, candidates, origin, direction);
            // A hit beyond the cell may have a nearer one in the next cell.
            if let Some(hit) = hit.filter(|h| h.range_m <= walk.leaves_at() * self.cell_m + 1e-9) {
                return Some(hit).filter(|h| h.range_m < reach_m);
            }
            if walk.leaves_at() * self.cell_m > reach_m || !walk.step(self.columns, self.rows) {
                return None;
            }
        }
    }

    /// The sides that pass within `within_m` of `p`, each once, with their distance; in order of their number.
    pub(crate) fn near(&self, p: Point, within_m: f64) -> Vec<(usize, f64)> {
        let around = Point::new(within_m, within_m);
        let mut found: Vec<usize> = self
            .cells_of_box(p - around, p + around)
            .flat_map(|(column, row)| self.cell(column, row).iter().copied())
            .collect();
        found.sort_unstable();
        found.dedup();
        found
            .into_iter()
            .map(|k| (k, self.sides[k].distance(p)))
            .filter(|&(_, distance_m)| distance_m <= within_m)
            .collect()
    }

    /// The side nearest to `p`, if one passes within `within_m`.
    pub(crate) fn nearest(&self, p: Point, within_m: f64) -> Option<(usize, f64)> {
        let around = Point::new(within_m, within_m);
        let mut best: Option<(usize, f64)> = None;
        for (column, row) in self.cells_of_box(p - around, p + around) {
            for &k in self.cell(column, row) {
                let distance_m = self.sides[k].distance(p);
                if distance_m <= within_m && best.is_none_or(|(_, d)| distance_m < d) {
                    best = Some((k, distance_m));
                }
            }
        }
        best
    }
}

/// The nearest hit among some sides.
fn first_hit(
    sides: &[Segment],
    candidates: impl Iterator<Item = usize>,
    origin: Point,
    direction: Point,
) -> Option<SideHit> {
    let mut best: Option<SideHit> = None;
    for side in candidates {
        if let Some((range_m, share)) = sides[side].meet_ray(origin, direction)
            && best.is_none_or(|b| range_m < b.range_m)
        {
            best = Some(SideHit { range_m, side, share });
        }
    }
    best
}

/// A ray's walk through the cells, lengths in cells.
struct Walk {
    column: usize,
    row: usize,
    right: bool,
    up: bool,
    next_x: f64,
    next_y: f64,
    step_x: f64,
    step_y: f64,
}

impl Walk {
    fn new(at: Point, direction: Point) -> Self {
        let (step_x, step_y) = (1.0 / direction.x.abs(), 1.0 / direction.y.abs());
        let (right, up) = (direction.x > 0.0, direction.y > 0.0);
        let to_border = |v: f64, ahead: bool| if ahead { v.floor() + 1.0 - v } else { v - v.floor() };
        let first = |rest: f64, step: f64| {
            if step.is_finite() {
                rest * step
            } else {
                f64::INFINITY
            }
        };
        Self {
            column: at.x as usize,
            row: at.y as usize,
            right,
            up,
            next_x: first(to_border(at.x, right), step_x),
            next_y: first(to_border(at.y, up), step_y),
            step_x,
            step_y,
        }
    }

    /// Length along the ray at which it leaves the cell it is in.
    fn leaves_at(&self) -> f64 {
        self.next_x.min(self.next_y)
    }

    /// Goes on to the next cell; false when that lies outside.
    fn step(&mut self, columns: usize, rows: usize) -> bool {
        let moved = |k: usize, ahead: bool| if ahead { Some(k + 1) } else { k.checked_sub(1) };
        if self.next_x < self.next_y {
            self.next_x += self.step_x;
            moved(self.column, self.right)
                .filter(|&c| c < columns)
                .map(|c| self.column = c)
                .is_some()
        } else {
            self.next_y += self.step_y;
            moved(self.row, self.up)
                .filter(|&r| r < rows)
                .map(|r| self.row = r)
                .is_some()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::{Dice, Purpose, direction};

    fn scattered(dice: &mut Dice, count: usize) -> Vec<Polyline> {
        (0..count)
            .map(|_| {
                let a = dice.point(Point::new(-6.0, -4.0), Point::new(7.0, 5.0));
                let length_m = dice.exponential(1.0);
                let b = a + direction(dice.between(-4.0, 4.0)) * length_m;
                Polyline::new(vec![a, b]).unwrap()
            })
            .collect()
    }

    #[test]
    fn rays_hit_what_trying_every_side_hits() {
        let mut dice = Dice::new(3, Purpose::Plan);
        let walls = scattered(&mut dice, 60);
        let grid = SideGrid::new(&walls);
        let mut hits = 0;
        for _ in 0..3000 {
            let origin = dice.point(Point::new(-8.0, -6.0), Point::new(9.0, 7.0));
            let towards = direction(dice.between(-4.0, 4.0));
            let naive = first_hit(grid.sides(), 0..60, origin, towards).filter(|h| h.range_m < 5.0);
            assert_eq!(grid.cast(origin, towards, 5.0), naive);
            hits += usize::from(naive.is_some());
        }
        assert!(hits > 500, "only {hits} rays hit");
    }

    #[test]
    fn rays_along_the_grid_lines_hit_too() {
        let wall = Polyline::new(vec![Point::new(5.0, -1.0), Point::new(5.0, 1.0)]).unwrap();
        let back = Polyline::new(vec![Point::new(0.0, 1.0), Point::new(0.0, -1.0)]).unwrap();
        let grid = SideGrid::new(&[wall, back]);
        for y in [-0.25, 0.0, 0.25, 0.5] {
            let hit = grid.cast(Point::new(1.0, y), Point::new(1.0, 0.0), 80.0).unwrap();
            assert!((hit.range_m - 4.0).abs() < 1e-12);
            let hit = grid
                .cast(Point::new(1.0, y), Point::new(-1.0, 0.0), 80.0)
                .unwrap();
            assert!((hit.range_m - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_nearest_side_is_the_nearest_of_all() {
        let mut dice = Dice::new(4, Purpose::Plan);
        let grid = SideGrid::new(&scattered(&mut dice, 60));
        for _ in 0..1000 {
            let p = dice.point(Point::new(-8.0, -6.0), Point::new(9.0, 7.0));
            let naive = grid
                .sides()
                .iter()
                .map(|s| s.distance(p))
                .fold(f64::INFINITY, f64::min);
            match grid.nearest(p, 0.8) {
                Some((_, distance_m)) => assert!((distance_m - naive).abs() < 1e-12),
                None => assert!(naive > 0.8),
            }
            assert_eq!(grid.near(p, 0.8).is_empty(), naive > 0.8);
        }
    }
}
