//! An occupancy grid of the map: walls from the polylines, free space from the scans.
//!
//! In goes the map, and where they are known the placed scans; out comes a grid of free, occupied and unknown
//! cells:
//!
//! | cell | when |
//! |---|---|
//! | occupied | a wall of the map runs through it; or two beams and at least half of those that came to it ended in it, and no wall is within two cells (what has no place among the polylines: plants, small things) |
//! | free | more beams passed through it than ended in it, and no wall runs through it |
//! | unknown | else: no beam came there. No return says nothing about free space, see `polymapper_core::scan` |
//!
//! Beams are followed cell by cell (Amanatides and Woo 1987). What moved through is passed through by other
//! beams, and free.

use polymapper_core::geometry::Point;

use super::extent::{Extent, vertices};
use super::{ExportError, Place, PlacedScan, Subject};

/// The most cells of a grid: 790 m by 790 m at 5 cm. Counting takes 2 bytes a cell, the result one more.
const MOST_CELLS: f64 = 250e6;
/// Unknown cells round what is known.
const MARGIN_CELLS: f64 = 2.0;
/// A return this near a wall of the map, in cells, belongs to it.
const NEAR_WALL_CELLS: usize = 2;

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cell {
    Unknown,
    Free,
    Occupied,
}

/// Cells by rows, the lowest row first, each from left to right.
pub(super) struct Grid {
    /// Lower left corner of the lower left cell, metres; a multiple of the resolution.
    pub origin: Point,
    pub resolution_m: f64,
    pub width: usize,
    pub height: usize,
    pub cells: Vec<Cell>,
}

impl Grid {
    /// The grid of the whole map.
    ///
    /// # Errors
    /// More cells than [`MOST_CELLS`]; the scans cannot be read.
    pub fn of(subject: &Subject<'_>, place: &Place<'_>) -> Result<Self, ExportError> {
        let mut tracks = Tracks::covering(bounds(subject)?, subject.options.resolution_m, place)?;
        for polyline in &subject.map.polylines {
            for side in polyline.vertices.windows(2) {
                tracks.wall(side[0].point, side[1].point);
            }
        }
        subject.for_each_scan(&mut |scan| {
            tracks.scan(&scan);
            Ok(())
        })?;
        Ok(tracks.judged())
    }

    /// The cell in `column` of `row`, both from the lower left corner.
    pub fn at(&self, column: usize, row: usize) -> Cell {
        self.cells
            .get(row * self.width + column)
            .copied()
            .unwrap_or(Cell::Unknown)
    }
}

/// The smallest box round walls, scanners and returns; `None` when there are none.
fn bounds(subject: &Subject<'_>) -> Result<Option<[Point; 2]>, ExportError> {
    let mut extent = Extent::of(vertices(subject.map));
    subject.for_each_scan(&mut |scan| {
        extent.take(scan.map_from_scan.translation());
        returns(&scan).for_each(|p| extent.take(p));
        Ok(())
    })?;
    Ok(extent.0)
}

fn returns<'a>(scan: &'a PlacedScan<'_>) -> impl Iterator<Item = Point> + 'a {
    let map_from_scan = scan.map_from_scan;
    (0..scan.readings.geometry().beams())
        .filter_map(|beam| scan.readings.point(beam))
        .map(move |p| map_from_scan * p)
}

/// Where walls run, and how many beams went through and ended in every cell.
struct Tracks {
    origin: Point,
    resolution_m: f64,
    width: usize,
    height: usize,
    /// Beams that passed and beams that ended; halved together when one is full, so that their ratio stays.
    beams: Vec<[u8; 2]>,
    walls: Vec<bool>,
}

const PASSED: usize = 0;
const ENDED: usize = 1;

impl Tracks {
    fn covering(
        bounds: Option<[Point; 2]>,
        resolution_m: f64,
        place: &Place<'_>,
    ) -> Result<Self, ExportError> {
        let [min, max] = bounds.unwrap_or([Point::new(0.0, 0.0); 2]);
        let first = |v: f64| (v / resolution_m).floor() - MARGIN_CELLS;
        let count = |low: f64, high: f64| (high / resolution_m).floor() + MARGIN_CELLS + 1.0 - first(low);
        let (width, height) = (count(min.x, max.x), count(min.y, max.y));
        // Written so that numbers that are none do not pass.
        let fits = width * height <= MOST_CELLS;
        if !fits {
            return Err(place.unfit(format!(
                "{:.0} m by {:.0} m at {resolution_m} m a cell are {width:.0} by {height:.0} cells, {:.0} million at most; \
                 choose a coarser --resolution",
                max.x - min.x,
                max.y - min.y,
                MOST_CELLS / 1e6
            )));
        }
        let (width, height) = (width as usize, height as usize);
        Ok(Self {
            origin: Point::new(first(min.x) * resolution_m, first(min.y) * resolution_m),
            resolution_m,
            width,
            height,
            beams: vec![[0; 2]; width * height],
            walls: vec![false; width * height],
        })
    }

    fn wall(&mut self, from: Point, to: Point) {
        let (from, to) = (self.in_cells(from), self.in_cells(to));
        walk(from, to, |column, row| {
            if let Some(k) = index(self.width, self.height, column, row) {
                self.walls[k] = true;
            }
        });
    }

    fn scan(&mut self, scan: &PlacedScan<'_>) {
        let from = self.in_cells(scan.map_from_scan.translation());
        for end in returns(scan) {
            let end = self.in_cells(end);
            let last = [end.x.floor() as i64, end.y.floor() as i64];
            walk(from, end, |column, row| {
                let what = if [column, row] == last { ENDED } else { PASSED };
                if let Some(k) = index(self.width, self.height, column, row) {
                    count(&mut self.beams[k], what);
                }
            });
        }
    }

    fn in_cells(&self, p: Point) -> Point {
        (p - self.origin) * (1.0 / self.resolution_m)
    }

    fn judged(self) -> Grid {
        let cells = (0..self.beams.len()).map(|k| self.cell(k)).collect();
        Grid {
            origin: self.origin,
            resolution_m: self.resolution_m,
            width: self.width,
            height: self.height,
            cells,
        }
    }

    fn cell(&self, k: usize) -> Cell {
        let [passed, ended] = self.beams[k];
        if self.walls[k] {
            Cell::Occupied
        } else if passed > ended {
            Cell::Free
        } else if ended >= 2 && !self.is_near_wall(k) {
            Cell::Occupied
        } else {
            Cell::Unknown
        }
    }

    fn is_near_wall(&self, k: usize) -> bool {
        let (column, row) = (k % self.width, k / self.width);
        let around =
            |v: usize, end: usize| v.saturating_sub(NEAR_WALL_CELLS)..(v + NEAR_WALL_CELLS + 1).min(end);
        around(row, self.height).any(|r| around(column, self.width).any(|c| self.walls[r * self.width + c]))
    }
}

fn count(beams: &mut [u8; 2], what: usize) {
    if beams[what] == u8::MAX {
        *beams = beams.map(|n| n / 2);
    }
    beams[what] += 1;
}

fn index(width: usize, height: usize, column: i64, row: i64) -> Option<usize> {
    let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
    (column < width && row < height).then_some(row * width + column)
}

/// Gives every cell that the segment touches to `each`, in order; lengths are cells.
fn walk(from: Point, to: Point, mut each: impl FnMut(i64, i64)) {
    let mut x = Axis::new(from.x, to.x);
    let mut y = Axis::new(from.y, to.y);
    each(x.cell, y.cell);
    for _ in 0..x.steps + y.steps {
        let next = if y.steps == 0 || x.steps > 0 && x.at_border < y.at_border {
            &mut x
        } else {
            &mut y
        };
        next.step();
        each(x.cell, y.cell);
    }
}

/// One coordinate of a walk.
struct Axis {
    cell: i64,
    /// Borders that are still to cross.
    steps: u64,
    direction: i64,
    /// Share of the segment at which the next border is crossed.
    at_border: f64,
    /// Share of the segment from border to border.
    between_borders: f64,
}

impl Axis {
    fn new(from: f64, to: f64) -> Self {
        let (first, last) = (from.floor(), to.floor());
        let length = to - from;
        let border = if length > 0.0 { first + 1.0 } else { first };
        Self {
            cell: first as i64,
            steps: (last as i64).abs_diff(first as i64),
            direction: if length > 0.0 { 1 } else { -1 },
            at_border: (border - from) / length,
            between_borders: 1.0 / length.abs(),
        }
    }

    fn step(&mut self) {
        self.cell += self.direction;
        self.at_border += self.between_borders;
        self.steps -= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(from: (f64, f64), to: (f64, f64)) -> Vec<(i64, i64)> {
        let mut cells = Vec::new();
        walk(Point::new(from.0, from.1), Point::new(to.0, to.1), |c, r| {
            cells.push((c, r));
        });
        cells
    }

    #[test]
    fn a_walk_touches_every_cell_between_and_ends_in_the_last() {
        assert_eq!(cells((0.5, 0.5), (2.5, 0.6)), [(0, 0), (1, 0), (2, 0)]);
        assert_eq!(cells((0.5, 2.5), (0.4, 0.5)), [(0, 2), (0, 1), (0, 0)]);
        assert_eq!(cells((0.2, 0.5), (1.8, 1.5)), [(0, 0), (0, 1), (1, 1)]);
        assert_eq!(cells((1.5, 1.5), (1.5, 1.5)), [(1, 1)]);
        let long = cells((0.1, 99.7), (-77.3, -12.4));
        assert_eq!(long.last(), Some(&(-78, -13)));
        let next = |p: &[(i64, i64)]| (p[0].0 - p[1].0).abs() + (p[0].1 - p[1].1).abs() == 1;
        assert!(long.windows(2).all(next));
    }

    #[test]
    fn full_counts_keep_their_ratio() {
        let mut beams = [0, 0];
        for k in 0..1000 {
            count(&mut beams, if k % 4 == 0 { ENDED } else { PASSED });
        }
        let ratio = f64::from(beams[PASSED]) / f64::from(beams[ENDED]);
        assert!((2.5..3.5).contains(&ratio), "{beams:?}");
    }
}
