//! Where a vehicle can go, and a way from place to place.
//!
//! In: walls, plants and a start. Out: smooth ways through free space that keep [`CLEARANCE_M`] away from
//! everything. Shortest way over a grid that prefers the middle of the floor (A*), then pulled straight like a
//! rubber band (every point moves to the middle of its neighbours as long as the clearance allows).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use polymapper_core::geometry::Point;

use crate::plan::Plan;
use crate::sides::SideGrid;

/// No way comes closer than this to walls and plants.
pub const CLEARANCE_M: f64 = 0.35;

const CELL_M: f64 = 0.1;
/// Half a cell's diagonal: how far a point can be from the middle of its cell.
const HALF_DIAGONAL_M: f64 = 0.0708;
/// Clearance of cells on a way, so that points between them keep `CLEARANCE_M`.
const CELL_CLEARANCE_M: f64 = CLEARANCE_M + HALF_DIAGONAL_M + 0.005;
/// Beyond this distance nothing counts as near.
const FAR_M: f64 = 1.0;
/// Distance between the points of a way.
pub(crate) const WAY_STEP_M: f64 = 0.05;
/// With points 5 cm apart, this many rounds turn a corner into a bend of about 0.7 m.
const SMOOTHING_ROUNDS: usize = 200;
/// A place that cannot be reached is replaced by the nearest one that can, within this distance.
const SNAP_M: f64 = 1.5;

/// A grid of clearances, and which cells can be reached.
pub(crate) struct Terrain {
    min: Point,
    columns: usize,
    rows: usize,
    clearance_m: Vec<f64>,
    reachable: Vec<bool>,
}

impl Terrain {
    /// Looks at the plan from its first stop; `None` when there is no room to stand.
    pub(crate) fn new(plan: &Plan, walls: &SideGrid) -> Option<Self> {
        let (min, max) = plan.bounds();
        let size = max - min;
        let (columns, rows) = ((size.x / CELL_M) as usize + 1, (size.y / CELL_M) as usize + 1);
        let mut terrain = Self {
            min,
            columns,
            rows,
            clearance_m: Vec::with_capacity(columns * rows),
            reachable: vec![false; columns * rows],
        };
        for k in 0..columns * rows {
            let p = terrain.middle(k);
            let to_wall_m = walls.nearest(p, FAR_M).map_or(FAR_M, |(_, d)| d);
            let to_plant_m = plan.plants().iter().map(|t| t.centre.distance(p) - t.radius_m);
            terrain.clearance_m.push(to_plant_m.fold(to_wall_m, f64::min));
        }
        let start = terrain.nearest_cell(*plan.stops().first()?, |t, k| t.is_open(k))?;
        terrain.flood(start);
        Some(terrain)
    }

    fn middle(&self, k: usize) -> Point {
        let (column, row) = (k % self.columns, k / self.columns);
        self.min + Point::new(column as f64 + 0.5, row as f64 + 0.5) * CELL_M
    }

    fn cell_of(&self, p: Point) -> Option<usize> {
        let at = (p - self.min) / CELL_M;
        let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < self.columns as f64 && at.y < self.rows as f64;
        inside.then(|| at.y as usize * self.columns + at.x as usize)
    }

    fn is_open(&self, k: usize) -> bool {
        self.clearance_m[k] >= CELL_CLEARANCE_M
    }

    /// Eight neighbours with their distance.
    fn neighbours(&self, k: usize) -> impl Iterator<Item = (usize, f64)> + use<> {
        let (columns, rows) = (self.columns as i64, self.rows as i64);
        let (column, row) = (k as i64 % columns, k as i64 / columns);
        (-1..=1_i64)
            .flat_map(|dy| (-1..=1_i64).map(move |dx| (dx, dy)))
            .filter(move |&(dx, dy)| {
                (dx, dy) != (0, 0) && (0..columns).contains(&(column + dx)) && (0..rows).contains(&(row + dy))
            })
            .map(move |(dx, dy)| {
                let steps = ((dx * dx + dy * dy) as f64).sqrt();
                (((row + dy) * columns + column + dx) as usize, steps * CELL_M)
            })
    }

    fn flood(&mut self, start: usize) {
        let mut open = vec![start];
        self.reachable[start] = true;
        while let Some(k) = open.pop() {
            for (next, _) in self.neighbours(k) {
                if !self.reachable[next] && self.is_open(next) {
                    self.reachable[next] = true;
                    open.push(next);
                }
            }
        }
    }

    fn nearest_cell(&self, p: Point, fits: impl Fn(&Self, usize) -> bool) -> Option<usize> {
        let distance_m = |k: &usize| self.middle(*k).distance(p);
        (0..self.clearance_m.len())
            .filter(|&k| fits(self, k) && distance_m(&k) <= SNAP_M)
            .min_by(|a, b| distance_m(a).total_cmp(&distance_m(b)))
    }

    /// The nearest place to `p` that can be reached, if there is one close by.
    pub(crate) fn reachable_near(&self, p: Point) -> Option<Point> {
        self.nearest_cell(p, |t, k| t.reachable[k])
            .map(|k| self.middle(k))
    }

    /// The `k`-th of all places that can be reached, counted round and round.
    pub(crate) fn reachable_place(&self, k: usize) -> Option<Point> {
        let count = self.reachable.iter().filter(|&&r| r).count();
        let wanted = k.checked_rem(count)?;
        let mut cells = (0..self.reachable.len()).filter(|&c| self.reachable[c]);
        cells.nth(wanted).map(|c| self.middle(c))
    }

    /// A smooth way between two places, points 5 cm apart; `None` when one of them cannot be reached.
    pub(crate) fn way(&self, from: Point, to: Point) -> Option<Vec<Point>> {
        let (start, goal) = (self.cell_of(from)?, self.cell_of(to)?);
        if !self.reachable[start] || !self.reachable[goal] {
            return None;
        }
        let cells = self.shortest(start, goal)?;
        let points: Vec<Point> = cells.into_iter().map(|k| self.middle(k)).collect();
        Some(self.smooth(&points))
    }

    /// The same way with its corners rounded as far as the clearance allows, points 5 cm apart; the ends stay.
    pub(crate) fn smooth(&self, way: &[Point]) -> Vec<Point> {
        evenly_spaced(&self.pulled_straight(evenly_spaced(way)))
    }

    /// A*: the distance as the crow flies never exceeds the cost left, so the way found is the cheapest.
    fn shortest(&self, start: usize, goal: usize) -> Option<Vec<usize>> {
        let end = self.middle(goal);
        let mut cost = vec![f64::INFINITY; self.reachable.len()];
        let mut came_from = vec![usize::MAX; self.reachable.len()];
        let mut open = BinaryHeap::new();
        cost[start] = 0.0;
        open.push(Open {
            bound: 0.0,
            cell: start,
        });
        while let Some(Open { bound, cell }) = open.pop() {
            if cell == goal {
                break;
            }
            if bound > cost[cell] + self.middle(cell).distance(end) + 1e-9 {
                continue;
            }
            for (next, length_m) in self.neighbours(cell) {
                // Near walls a way costs up to twice its length, as people and robots keep to the middle.
                let crowding = (0.8 - self.clearance_m[next]).max(0.0) / 0.4;
                let through = cost[cell] + length_m * (1.0 + crowding);
                if self.reachable[next] && through < cost[next] - 1e-12 {
                    cost[next] = through;
                    came_from[next] = cell;
                    let bound = through + self.middle(next).distance(end);
                    open.push(Open { bound, cell: next });
                }
            }
        }
        let mut cells = vec![goal];
        while let Some(&last) = cells.last().filter(|&&c| c != start) {
            cells.push(Some(came_from[last]).filter(|&c| c != usize::MAX)?);
        }
        cells.reverse();
        Some(cells)
    }

    fn pulled_straight(&self, mut way: Vec<Point>) -> Vec<Point> {
        for _ in 0..SMOOTHING_ROUNDS {
            for k in 1..way.len().saturating_sub(1) {
                let moved = (way[k - 1] + way[k + 1]) * 0.5;
                if self.is_clear(moved) {
                    way[k] = moved;
                }
            }
        }
        way
    }

    /// Whether `p` surely keeps the clearance: clearances change by no more than the distance.
    fn is_clear(&self, p: Point) -> bool {
        self.cell_of(p)
            .is_some_and(|k| self.clearance_m[k] - self.middle(k).distance(p) >= CLEARANCE_M + 0.003)
    }
}

/// Points along a line, `WAY_STEP_M` apart; both ends are kept.
fn evenly_spaced(points: &[Point]) -> Vec<Point> {
    let Some((&first, &last)) = points.first().zip(points.last()) else {
        return Vec::new();
    };
    let mut out = vec![first];
    let mut left_m = WAY_STEP_M;
    for pair in points.windows(2) {
        let length_m = pair[0].distance(pair[1]);
        let mut at_m = left_m;
        while at_m < length_m {
            out.push(pair[0].lerp(pair[1], at_m / length_m));
            at_m += WAY_STEP_M;
        }
        left_m = at_m - length_m;
    }
    if out.last().is_some_and(|p| p.distance(last) > 1e-6) {
        out.push(last);
    }
    out
}

/// A cell to visit, the cheapest first; ties by cell, so that the order is the same everywhere.
struct Open {
    bound: f64,
    cell: usize,
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .bound
            .total_cmp(&self.bound)
            .then_with(|| other.cell.cmp(&self.cell))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}
