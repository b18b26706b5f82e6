//! How near each cell of a whole map is to a wall, by the way the wall faces, at several resolutions.
//!
//! In: the sides of a map. Out: upper bounds of the field over blocks of cells. Unlike the field around one place
//! (`place::search`), this one is made once for a map and must hold a campus: level k stands for blocks of 2ᵏ cells
//! and is kept at every 2ᵏ⁻¹th cell only, so that all levels together cost little more than twice the finest.

use crate::geometry::{Point, Segment};

/// Edge of a cell, metres: alignment finds the way from 0.1 m off.
const CELL_M: f64 = 0.10;
/// Facing directions are sorted into this many sectors; a side belongs to every sector within 37.5° of its own.
pub(super) const SECTORS: usize = 8;
const MIN_SECTOR_COS: f64 = 0.793;
/// Levels of the pyramid; the coarsest stands for blocks of 32 cells.
pub(super) const LEVELS: usize = 6;
/// Cells beside the outermost side. A scanner may stand a little outside of what it has seen.
const MARGIN_M: f64 = 1.0;
/// Cells of one sector at most, 16 million: 400 m × 400 m. The cells of larger maps are larger.
const MOST_CELLS: f64 = 1.6e7;
/// Nearness by squared distance in cells: exp(−d²/2σ²) with σ = 1 cell, in 255ths, zero from 3 cells on.
const REACH_CELLS: i32 = 2;

/// The field of a map, as a pyramid.
pub(super) struct Field {
    pub cell_m: f64,
    pub origin: Point,
    pub width: i32,
    pub height: i32,
    levels: Vec<Level>,
}

/// Maxima over blocks of 2ᵏ cells, one for every `1 << shift` cells.
struct Level {
    shift: u32,
    width: i32,
    height: i32,
    /// By sector, then row by row.
    cells: Vec<u8>,
}

/// Sector of a direction.
pub(super) fn sector(direction: Point) -> usize {
    let turn = direction.y.atan2(direction.x) / std::f64::consts::TAU * SECTORS as f64;
    (turn.round() as i64).rem_euclid(SECTORS as i64) as usize
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
        let area_m2 = span.x * span.y;
        // As long as the area is small the longer edge is short enough as well, but for a single wall.
        let cell_m = CELL_M
            .max((area_m2 / MOST_CELLS).sqrt())
            .max(span.x.max(span.y) / MOST_CELLS);
        let cells = |span_m: f64| (span_m / cell_m) as i32 + 1;
        let (width, height) = (cells(span.x), cells(span.y));
        let mut finest = Level::empty(0, width, height);
        let kernel = kernel();
        for side in sides {
            finest.draw(side, origin, cell_m, &kernel);
        }
        let mut field = Self {
            cell_m,
            origin,
            width,
            height,
            levels: vec![finest],
        };
        for level in 1..LEVELS {
            let next = field.levels[level - 1].coarser(level, width, height);
            field.levels.push(next);
        }
        Some(field)
    }

    /// An upper bound, in 255ths, of the field over the block of 2^level cells from (x, y) on.
    #[inline]
    pub fn value(&self, level: usize, sector: usize, x: i32, y: i32) -> u32 {
        self.levels[level].value(sector, x, y)
    }
}

/// Cells before the first: a block that begins outside may reach in.
const PAD: i32 = 2;

impl Level {
    fn empty(shift: u32, width: i32, height: i32) -> Self {
        let (width, height) = ((width >> shift) + 1 + PAD, (height >> shift) + 1 + PAD);
        Self {
            shift,
            width,
            height,
            cells: vec![0; SECTORS * width as usize * height as usize],
        }
    }

    #[inline]
    fn value(&self, sector: usize, x: i32, y: i32) -> u32 {
        let (x, y) = ((x >> self.shift) + PAD, (y >> self.shift) + PAD);
        if x < 0 || y < 0 || x >= self.width || y >= self.height {
            return 0;
        }
        u32::from(self.cells[self.index(sector, x, y)])
    }

    fn index(&self, sector: usize, x: i32, y: i32) -> usize {
        (sector * self.height as usize + y as usize) * self.width as usize + x as usize
    }

    fn draw(&mut self, side: Segment, origin: Point, cell_m: f64, kernel: &[(i32, i32, u8)]) {
        let Some(direction) = side.direction() else { return };
        let steps = (side.length_m() / (0.5 * cell_m)).ceil().max(1.0);
        for s in 0..SECTORS {
            let axis = Point::from_polar(1.0, s as f64 * std::f64::consts::TAU / SECTORS as f64);
            if axis.dot(direction) < MIN_SECTOR_COS {
                continue;
            }
            let mut before = None;
            for k in 0..=steps as i64 {
                let p = (side.at(k as f64 / steps) - origin) / cell_m;
                let cell = (p.x.floor() as i32, p.y.floor() as i32);
                if before != Some(cell) {
                    self.stamp(s, cell, kernel);
                    before = Some(cell);
                }
            }
        }
    }

    fn stamp(&mut self, sector: usize, (cx, cy): (i32, i32), kernel: &[(i32, i32, u8)]) {
        for &(dx, dy, value) in kernel {
            let (x, y) = (cx + dx + PAD, cy + dy + PAD);
            if x >= 0 && y >= 0 && x < self.width && y < self.height {
                let k = self.index(sector, x, y);
                self.cells[k] = self.cells[k].max(value);
            }
        }
    }

    /// Level `level`, made of the one below. With s = 2^(level−1) its cell i must bound every block that begins in
    /// is .. is + s − 1 and is 2s long. Cells 2i, 2i + 2 and 2i + 3 of the level below (1 for the first) cover that.
    fn coarser(&self, level: usize, width: i32, height: i32) -> Self {
        let mut out = Self::empty(level as u32 - 1, width, height);
        let double = if level > 1 { 2 } else { 1 };
        let offsets: &[i32] = if level > 1 { &[0, 2, 3] } else { &[0, 1] };
        for sector in 0..SECTORS {
            for y in 0..out.height {
                for x in 0..out.width {
                    let mut most = 0;
                    for dy in offsets {
                        let from_y = (y - PAD) * double + dy + PAD;
                        for dx in offsets {
                            let from_x = (x - PAD) * double + dx + PAD;
                            let inside =
                                (0..self.width).contains(&from_x) && (0..self.height).contains(&from_y);
                            if inside {
                                most = most.max(self.cells[self.index(sector, from_x, from_y)]);
                            }
                        }
                    }
                    let k = out.index(sector, x, y);
                    out.cells[k] = most;
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
