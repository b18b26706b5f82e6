//! The sides of a set of polylines, and which of them is next to a point.
//!
//! In: polylines. Out: the nearest side that faces a given way. A grid over the sides makes a look-up cheap:
//! a match asks some ten thousand times.

use super::induced::measurements;
use crate::geometry::{Point, Polyline, Segment};

/// Sides closer than this are found, metres: hypotheses start within a cell of votes (0.2 m) and a degree or
/// two of the truth, which is 0.2 m more at 6 m.
pub(super) const REACH_M: f64 = 0.4;
/// Normals of the same wall seen twice differ by no more than this: cos 45°. Corners and the far side of a thin wall
/// differ by 90° or more.
const SAME_FACING: f64 = 0.707;
const CELL_M: f64 = 0.25;
/// Bounds memory when polylines are spread over a whole site: cells grow instead.
const MOST_CELLS_A_SIDE: f64 = 320.0;

/// A side with what is asked of it again and again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    pub segment: Segment,
    pub direction: Point,
    /// Points into the free space.
    pub normal: Point,
    pub length_m: f64,
    pub bearing_rad: f64,
}

/// The sides of `polylines` that have a length, in order.
pub(super) fn walls_of(polylines: &[Polyline]) -> Vec<Wall> {
    let mut walls = Vec::new();
    for polyline in polylines {
        for segment in polyline.sides() {
            if let Some(direction) = segment.direction() {
                walls.push(Wall {
                    segment,
                    direction,
                    normal: direction.left(),
                    length_m: segment.length_m(),
                    bearing_rad: direction.bearing_rad(),
                });
            }
        }
    }
    walls
}

/// A point of a wall, with the length of wall it stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub point: Point,
    pub normal: Point,
    pub length_m: f64,
    /// How many independent measurements it is worth.
    pub measurements: f64,
}

/// Evenly spaced points on the walls, about `count` of them and at least one a wall.
pub(super) fn samples_of(walls: &[Wall], count: usize) -> Vec<Sample> {
    let total_m: f64 = walls.iter().map(|w| w.length_m).sum();
    let spacing_m = (total_m / count.max(1) as f64).max(0.05);
    let mut samples = Vec::with_capacity(count + walls.len());
    for wall in walls {
        let pieces = (wall.length_m / spacing_m).ceil().max(1.0);
        let worth = measurements(wall.length_m) / pieces;
        for k in 0..pieces as usize {
            samples.push(Sample {
                measurements: worth,
                point: wall.segment.at((k as f64 + 0.5) / pieces),
                normal: wall.normal,
                length_m: wall.length_m / pieces,
            });
        }
    }
    samples
}

/// The nearest wall to a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    pub wall: usize,
    pub distance_m: f64,
    /// Distance from the wall's line, positive on its free side.
    pub offset_m: f64,
}

/// A grid over walls.
#[derive(Debug)]
pub(super) struct WallGrid {
    walls: Vec<Wall>,
    origin: Point,
    per_m: f64,
    columns: usize,
    rows: usize,
    /// Where each cell's walls start in `entries`; one more than cells.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl WallGrid {
    pub fn new(walls: Vec<Wall>) -> Self {
        let ends = || walls.iter().flat_map(|w| [w.segment.a, w.segment.b]);
        let low = ends().fold(Point::new(f64::MAX, f64::MAX), |m, p| {
            Point::new(m.x.min(p.x), m.y.min(p.y))
        });
        let high = ends().fold(Point::new(f64::MIN, f64::MIN), |m, p| {
            Point::new(m.x.max(p.x), m.y.max(p.y))
        });
        let origin = low - Point::new(REACH_M, REACH_M);
        let size = high - low + Point::new(2.0 * REACH_M, 2.0 * REACH_M);
        let cell_m = CELL_M.max(size.x.max(size.y) / MOST_CELLS_A_SIDE);
        let cells = |length_m: f64| (length_m / cell_m).ceil().clamp(0.0, MOST_CELLS_A_SIDE) as usize + 1;
        let mut grid = Self {
            origin,
            per_m: 1.0 / cell_m,
            columns: if walls.is_empty() { 0 } else { cells(size.x) },
            rows: if walls.is_empty() { 0 } else { cells(size.y) },
            walls,
            starts: Vec::new(),
            entries: Vec::new(),
        };
        grid.enter_walls(cell_m);
        grid
    }

    pub fn walls(&self) -> &[Wall] {
        &self.walls
    }

    fn enter_walls(&mut self, cell_m: f64) {
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        for (number, wall) in self.walls.iter().enumerate() {
            self.cells_near(wall, cell_m, |cell| pairs.push((cell as u32, number as u32)));
        }
        self.starts = vec![0; self.columns * self.rows + 1];
        for &(cell, _) in &pairs {
            self.starts[cell as usize + 1] += 1;
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        let mut next = self.starts.clone();
        self.entries = vec![0; pairs.len()];
        for (cell, number) in pairs {
            let place = &mut next[cell as usize];
            self.entries[*place as usize] = number;
            *place += 1;
        }
    }

    /// Every cell that holds a point within reach of the wall.
    fn cells_near(&self, wall: &Wall, cell_m: f64, mut visit: impl FnMut(usize)) {
        let reach_m = REACH_M + cell_m * std::f64::consts::FRAC_1_SQRT_2;
        let (a, b) = (wall.segment.a - self.origin, wall.segment.b - self.origin);
        let span = |a: f64, b: f64, count: usize| {
            let from = ((a.min(b) - REACH_M) * self.per_m).max(0.0) as usize;
            let to = ((a.max(b) + REACH_M) * self.per_m).max(0.0) as usize;
            from..(to + 1).min(count)
        };
        for row in span(a.y, b.y, self.rows) {
            for column in span(a.x, b.x, self.columns) {
                let middle = self.origin + Point::new(column as f64 + 0.5, row as f64 + 0.5) * cell_m;
                if wall.segment.distance(middle) <= reach_m {
                    visit(row * self.columns + column);
                }
            }
        }
    }

    /// The nearest wall within `reach_m` (at most [`REACH_M`]) of `point` that faces the way of `normal`.
    pub fn nearest(&self, point: Point, normal: Point, reach_m: f64) -> Option<Near> {
        let place = (point - self.origin) * self.per_m;
        if !(place.x >= 0.0 && place.y >= 0.0) {
            return None;
        }
        let (column, row) = (place.x as usize, place.y as usize);
        if column >= self.columns || row >= self.rows {
            return None;
        }
        let cell = row * self.columns + column;
        let entries = &self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize];
        let mut best: Option<Near> = None;
        let mut best_m = reach_m;
        for &number in entries {
            let wall = &self.walls[number as usize];
            if wall.normal.dot(normal) < SAME_FACING {
                continue;
            }
            let from_a = point - wall.segment.a;
            let offset_m = from_a.dot(wall.normal);
            if offset_m.abs() >= best_m {
                continue;
            }
            let along_m = from_a.dot(wall.direction);
            let beyond_m = (-along_m).max(along_m - wall.length_m).max(0.0);
            let distance_m = if beyond_m > 0.0 {
                (offset_m * offset_m + beyond_m * beyond_m).sqrt()
            } else {
                offset_m.abs()
            };
            if distance_m < best_m {
                best_m = distance_m;
                best = Some(Near {
                    wall: number as usize,
                    distance_m,
                    offset_m,
                });
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_finds_what_looking_at_every_wall_finds() {
        let mut state = 7u64;
        let mut next = |scale: f64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((state >> 33) as f64 / (1u64 << 30) as f64 - 1.0) * scale
        };
        let polylines: Vec<Polyline> = (0..12)
            .map(|_| {
                let start = Point::new(next(6.0), next(6.0));
                let points = (0..4).map(|_| start + Point::new(next(2.0), next(2.0))).collect();
                Polyline::new(points).unwrap()
            })
            .collect();
        let walls = walls_of(&polylines);
        let grid = WallGrid::new(walls.clone());
        let mut found = 0;
        for _ in 0..3000 {
            let (point, normal) = (
                Point::new(next(9.0), next(9.0)),
                Point::from_polar(1.0, next(3.0)),
            );
            let naive = walls
                .iter()
                .filter(|w| w.normal.dot(normal) >= SAME_FACING)
                .map(|w| w.segment.distance(point))
                .filter(|&d| d < REACH_M)
                .fold(f64::INFINITY, f64::min);
            let fast = grid
                .nearest(point, normal, REACH_M)
                .map_or(f64::INFINITY, |n| n.distance_m);
            assert!(
                fast.to_bits() == naive.to_bits() || (fast - naive).abs() < 1e-9,
                "{fast} {naive}"
            );
            found += usize::from(fast.is_finite());
        }
        assert!(found > 100);
    }

    #[test]
    fn no_walls_are_no_trouble() {
        let grid = WallGrid::new(Vec::new());
        assert!(
            grid.nearest(Point::default(), Point::new(1.0, 0.0), REACH_M)
                .is_none()
        );
    }
}
