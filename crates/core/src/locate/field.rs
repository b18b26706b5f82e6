//! How near each cell of a whole map is to a wall, by the way the wall faces, at several resolutions.
//!
//! In: the sides of a map. Out: the maximum of the field over blocks of 2ᵏ × 2ᵏ cells, from any cell on. The coarsest level is laid
//! out so that the blocks of one grid (every 2ᵏth cell) lie side by side: bounds for the poses of a whole map at
//! one heading are then sums of rows, which a processor adds sixteen at a time.

use crate::geometry::{Point, Segment};

/// Edge of a cell, metres: alignment finds the way from 0.1 m off.
const CELL_M: f64 = 0.10;
/// Facing directions are sorted into this many sectors; a side belongs to every sector within 37.5° of its own.
const SECTORS: usize = 8;
const MIN_SECTOR_COS: f64 = 0.793;
/// Beside the outermost side, metres. A scanner may stand a little outside of what it has seen.
const MARGIN_M: f64 = 1.0;
/// Cells of one sector at most (240 m × 240 m); the cells of larger maps are larger.
const MOST_CELLS: f64 = 6e6;
/// Coarsest blocks at most.
const MOST_BLOCKS: i64 = 30_000;
/// Nearness by squared distance in cells: exp(−d²/2σ²) with σ = 1 cell, in 255ths, zero from 3 cells on.
const REACH_CELLS: i32 = 2;

/// The field of a map, as a pyramid.
pub(super) struct Field {
    /// Edge of a cell, metres.
    pub cell_m: f64,
    /// Corner of the first cell.
    pub origin: Point,
    /// Level of the coarsest blocks.
    pub top: u32,
    /// Coarsest blocks along x and y.
    pub blocks: (usize, usize),
    /// Cells of a level along x and y, with [`Self::pad`] before the first.
    width: i32,
    height: i32,
    /// Level by level below the coarsest: by sector, then row by row.
    levels: Vec<Vec<u8>>,
    /// The coarsest: by sector, then by remainders of y and x by 2ᵏ, then row by row.
    coarsest: Vec<u8>,
}

/// A point of a scan on the grid of a field, the scanner in cell (0, 0).
#[derive(Clone, Copy)]
pub(super) struct FieldPoint {
    pub x: i32,
    pub y: i32,
    pub sector: usize,
}

impl FieldPoint {
    /// The cell of a point, and the sector of the direction of its side.
    pub fn new(p: Point, direction: Point, cell_m: f64) -> Self {
        let turn = direction.y.atan2(direction.x) / std::f64::consts::TAU * SECTORS as f64;
        Self {
            x: (p.x / cell_m).floor() as i32,
            y: (p.y / cell_m).floor() as i32,
            sector: (turn.round() as i64).rem_euclid(SECTORS as i64) as usize,
        }
    }
}

impl Field {
    /// The field of `sides`; `None` when there are none.
    pub fn new(sides: impl Iterator<Item = Segment> + Clone) -> Option<Self> {
        let (mut min, mut max) = (Point::new(f64::MAX, f64::MAX), Point::new(f64::MIN, f64::MIN));
        for p in sides.clone().flat_map(|s| [s.a, s.b]) {
            min = Point::new(min.x.min(p.x), min.y.min(p.y));
            max = Point::new(max.x.max(p.x), max.y.max(p.y));
        }
        if min.x > max.x {
            return None;
        }
        let margin = Point::new(MARGIN_M, MARGIN_M);
        let (origin, span) = (min - margin, max - min + margin * 2.0);
        let by_area_m = (span.x * span.y / MOST_CELLS).sqrt();
        let by_length_m = span.x.max(span.y) / MOST_CELLS;
        let cell_m = CELL_M.max(by_area_m).max(by_length_m);
        let cells = |span_m: f64| (span_m / cell_m) as i64 + 1;
        let (width, height) = (cells(span.x), cells(span.y));
        let top = (2..5)
            .find(|&top| (width >> top) * (height >> top) <= MOST_BLOCKS)
            .unwrap_or(5);
        let blocks = |cells: i64| (cells + (1 << top) - 1) >> top;
        let padded = |cells: i64| ((blocks(cells) + 1) << top) as i32;
        let mut field = Self {
            cell_m,
            origin,
            top,
            blocks: (blocks(width) as usize, blocks(height) as usize),
            width: padded(width),
            height: padded(height),
            levels: Vec::new(),
            coarsest: Vec::new(),
        };
        field.levels.push(field.drawn(sides));
        for level in 1..=top {
            let next = field.coarser(level);
            field.levels.push(next);
        }
        field.coarsest = field.levels.pop().map_or_else(Vec::new, |l| field.regrouped(&l));
        Some(field)
    }

    /// Cells before the first: a block that begins outside may reach in.
    fn pad(&self) -> i32 {
        1 << self.top
    }

    /// Maximum of the field over the block of 2^level cells from (x, y) on, in 255ths; not for the coarsest level.
    #[inline]
    pub fn value(&self, level: u32, sector: usize, x: i32, y: i32) -> u32 {
        let (x, y) = (x + self.pad(), y + self.pad());
        if x < 0 || y < 0 || x >= self.width || y >= self.height {
            return 0;
        }
        u32::from(self.levels[level as usize][self.index(sector, x, y)])
    }

    /// For every coarsest block, the sum of the maxima that the points can have when the scanner stands in it; row by
    /// row into `sums`. At most 257 points.
    pub fn sum_coarsest(&self, points: &[FieldPoint], sums: &mut Vec<u16>) {
        let (columns, rows) = self.blocks;
        sums.clear();
        sums.resize(columns * rows, 0);
        let size = 1 << self.top;
        let (width, height) = ((self.width >> self.top) as i64, (self.height >> self.top) as i64);
        for p in points {
            let split = |v: i32| {
                let v = v + self.pad();
                (i64::from(v.div_euclid(size)), v.rem_euclid(size))
            };
            let ((by_x, rest_x), (by_y, rest_y)) = (split(p.x), split(p.y));
            let plane = ((p.sector as i64 * i64::from(size) + i64::from(rest_y)) * i64::from(size)
                + i64::from(rest_x))
                * width
                * height;
            let (from, to) = ((-by_x).max(0), (width - by_x).min(columns as i64));
            if from >= to {
                continue;
            }
            for row in (-by_y).max(0)..(height - by_y).min(rows as i64) {
                let here = (row * columns as i64 + from) as usize;
                let there = (plane + (row + by_y) * width + from + by_x) as usize;
                let count = (to - from) as usize;
                let cells = &self.coarsest[there..there + count];
                for (sum, &cell) in sums[here..here + count].iter_mut().zip(cells) {
                    *sum = sum.saturating_add(u16::from(cell));
                }
            }
        }
    }

    fn index(&self, sector: usize, x: i32, y: i32) -> usize {
        (sector * self.height as usize + y as usize) * self.width as usize + x as usize
    }

    fn drawn(&self, sides: impl Iterator<Item = Segment>) -> Vec<u8> {
        let mut cells = vec![0; SECTORS * self.width as usize * self.height as usize];
        let kernel = kernel();
        for side in sides {
            let Some(direction) = side.direction() else {
                continue;
            };
            let steps = (side.length_m() / (0.5 * self.cell_m)).ceil().max(1.0);
            for sector in 0..SECTORS {
                let axis = Point::from_polar(1.0, sector as f64 * std::f64::consts::TAU / SECTORS as f64);
                if axis.dot(direction) < MIN_SECTOR_COS {
                    continue;
                }
                let mut before = None;
                for k in 0..=steps as i64 {
                    let p = (side.at(k as f64 / steps) - self.origin) / self.cell_m;
                    let cell = (p.x.floor() as i32, p.y.floor() as i32);
                    if before != Some(cell) {
                        self.stamp(&mut cells, sector, cell, &kernel);
                        before = Some(cell);
                    }
                }
            }
        }
        cells
    }

    fn stamp(&self, cells: &mut [u8], sector: usize, (cx, cy): (i32, i32), kernel: &[(i32, i32, u8)]) {
        for &(dx, dy, value) in kernel {
            let (x, y) = (cx + dx + self.pad(), cy + dy + self.pad());
            if x >= 0 && y >= 0 && x < self.width && y < self.height {
                let cell = &mut cells[self.index(sector, x, y)];
                *cell = (*cell).max(value);
            }
        }
    }

    /// Level k at (x, y) is the maximum of level k − 1 at (x, y), (x + 2ᵏ⁻¹, y), (x, y + 2ᵏ⁻¹) and both.
    fn coarser(&self, level: u32) -> Vec<u8> {
        let reach = 1_usize << (level - 1);
        let (width, height) = (self.width as usize, self.height as usize);
        let mut out = self.levels[level as usize - 1].clone();
        for row in out.chunks_exact_mut(width) {
            for x in 0..width.saturating_sub(reach) {
                row[x] = row[x].max(row[x + reach]);
            }
        }
        for plane in out.chunks_exact_mut(width * height) {
            for k in 0..(width * height).saturating_sub(reach * width) {
                plane[k] = plane[k].max(plane[k + reach * width]);
            }
        }
        out
    }

    fn regrouped(&self, level: &[u8]) -> Vec<u8> {
        let size = 1_i32 << self.top;
        let mut out = Vec::with_capacity(level.len());
        for sector in 0..SECTORS {
            for rest_y in 0..size {
                for rest_x in 0..size {
                    for y in (rest_y..self.height).step_by(size as usize) {
                        out.extend(
                            (rest_x..self.width)
                                .step_by(size as usize)
                                .map(|x| level[self.index(sector, x, y)]),
                        );
                    }
                }
            }
        }
        out
    }
}

fn kernel() -> Vec<(i32, i32, u8)> {
    let mut out = Vec::new();
    for dy in -REACH_CELLS..=REACH_CELLS {
        for dx in -REACH_CELLS..=REACH_CELLS {
            let d2 = f64::from(dx * dx + dy * dy);
            if d2 < 9.0 {
                out.push((dx, dy, (255.0 * (-0.5 * d2).exp()).round() as u8));
            }
        }
    }
    out
}
