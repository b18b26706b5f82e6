//! How near each cell is to a side of the map, by the way the side faces, at several resolutions.

use crate::geometry::{Point, Segment};

/// Edge of a cell, metres. Alignment finds the way from 0.1 m off; half the size would cost four times as much.
pub(crate) const CELL_M: f64 = 0.10;
/// Facing directions are sorted into this many sectors; a side belongs to every sector within 67.5° of its own.
const SECTORS: usize = 4;
/// Levels of the pyramid: level k holds the maximum over 2ᵏ × 2ᵏ cells.
pub(crate) const LEVELS: usize = 5;
/// Cells beside the outermost side.
const MARGIN_CELLS: i32 = 4;
/// Cells along an edge at most (a hall of 120 m).
const MOST_CELLS: i32 = 1200;
/// Nearness by squared distance in cells: exp(−d²/2σ²) with σ = 1 cell, in 255ths, zero from 3 cells on.
const REACH_CELLS: i32 = 2;

/// The field of a map, as a pyramid.
pub(crate) struct Field {
    origin: Point,
    width: i32,
    height: i32,
    /// By level, then sector, then row by row.
    levels: Vec<Vec<u8>>,
}

/// A place on the grid, and which way what stands there faces.
#[derive(Clone, Copy)]
pub(crate) struct FieldPoint {
    x: i32,
    y: i32,
    /// Where the cells of its sector begin.
    plane: u32,
}

impl FieldPoint {
    /// The same elsewhere, by cells.
    pub fn moved(self, dx: i32, dy: i32) -> Self {
        Self {
            x: self.x + dx,
            y: self.y + dy,
            ..self
        }
    }
}

/// Sector of a direction.
fn sector(bearing_rad: f64) -> usize {
    let turn = bearing_rad / std::f64::consts::TAU * SECTORS as f64;
    (turn.round() as i64).rem_euclid(SECTORS as i64) as usize
}

impl Field {
    /// The field of `sides`; those farther than the largest field reaches from `centre` are left out.
    pub fn new(sides: impl Iterator<Item = Segment> + Clone, centre: Point, reach_m: f64) -> Option<Self> {
        let (mut min, mut max) = (Point::new(f64::MAX, f64::MAX), Point::new(f64::MIN, f64::MIN));
        for p in sides.clone().flat_map(|s| [s.a, s.b]) {
            if p.distance(centre) <= reach_m {
                min = Point::new(min.x.min(p.x), min.y.min(p.y));
                max = Point::new(max.x.max(p.x), max.y.max(p.y));
            }
        }
        if min.x > max.x {
            return None;
        }
        let cells = |span_m: f64| ((span_m / CELL_M) as i32 + 1 + 2 * MARGIN_CELLS).min(MOST_CELLS);
        let (width, height) = (cells(max.x - min.x), cells(max.y - min.y));
        let margin_m = f64::from(MARGIN_CELLS) * CELL_M;
        let origin = min - Point::new(margin_m, margin_m);
        let mut field = Self {
            origin,
            width,
            height,
            levels: vec![vec![0; width as usize * height as usize * SECTORS]],
        };
        let kernel = kernel();
        for side in sides {
            field.draw(side, &kernel);
        }
        field.build_pyramid();
        Some(field)
    }

    fn draw(&mut self, side: Segment, kernel: &[(i32, i32, u8)]) {
        let Some(direction) = side.direction() else { return };
        let length_m = side.length_m();
        let steps = (length_m / (0.5 * CELL_M)).ceil().max(1.0);
        let main = sector(direction.bearing_rad()) as f64;
        for s in 0..SECTORS {
            let axis = Point::from_polar(1.0, s as f64 * std::f64::consts::TAU / SECTORS as f64);
            // cos 67.5°: a side may turn by 22.5° against the sector's edge and still be found.
            if (s as f64 - main).abs() > 0.1 && axis.dot(direction) < 0.3827 {
                continue;
            }
            let mut before = None;
            for k in 0..=steps as i64 {
                let cell = self.cell(side.at(k as f64 / steps));
                if before != Some(cell) {
                    self.stamp(s, cell, kernel);
                    before = Some(cell);
                }
            }
        }
    }

    fn stamp(&mut self, sector: usize, (cx, cy): (i32, i32), kernel: &[(i32, i32, u8)]) {
        for &(dx, dy, value) in kernel {
            let (x, y) = (cx + dx, cy + dy);
            if x >= 0 && y >= 0 && x < self.width && y < self.height {
                let k = self.index(sector, x, y);
                let cell = &mut self.levels[0][k];
                *cell = (*cell).max(value);
            }
        }
    }

    /// Level k + 1 at (x, y) is the maximum of level k at (x, y), (x + 2ᵏ, y), (x, y + 2ᵏ) and both: full resolution,
    /// so that a block may start at any cell.
    fn build_pyramid(&mut self) {
        let (width, height) = (self.width as usize, self.height as usize);
        for level in 1..LEVELS {
            let reach = 1_usize << (level - 1);
            let below = &self.levels[level - 1];
            let mut wide = below.clone();
            for (wide, below) in wide.chunks_exact_mut(width).zip(below.chunks_exact(width)) {
                raise(wide, below.get(reach..).unwrap_or_default());
            }
            let mut above = wide.clone();
            let planes = above.chunks_exact_mut(width * height);
            for (above, wide) in planes.zip(wide.chunks_exact(width * height)) {
                raise(above, wide.get(reach * width..).unwrap_or_default());
            }
            self.levels.push(above);
        }
    }

    fn index(&self, sector: usize, x: i32, y: i32) -> usize {
        (sector * self.height as usize + y as usize) * self.width as usize + x as usize
    }

    /// The cell that holds a point; may lie outside.
    fn cell(&self, p: Point) -> (i32, i32) {
        let q = (p - self.origin) / CELL_M;
        (q.x.floor() as i32, q.y.floor() as i32)
    }

    /// A point on the grid; `bearing_rad` is the direction of its side.
    pub fn point(&self, p: Point, bearing_rad: f64) -> FieldPoint {
        let (x, y) = self.cell(p);
        FieldPoint {
            x,
            y,
            plane: (sector(bearing_rad) * self.height as usize * self.width as usize) as u32,
        }
    }

    /// Maximum of the field over the block of 2^level cells from a place on, in 255ths.
    pub fn value(&self, level: usize, at: FieldPoint) -> u32 {
        // A block that starts outside may still reach in; its overhang is bounded by the block's first inner cell.
        let reach = (1_i32 << level) - 1;
        if at.x < -reach || at.y < -reach || at.x >= self.width || at.y >= self.height {
            return 0;
        }
        let cell = at.y.max(0) as usize * self.width as usize + at.x.max(0) as usize;
        u32::from(self.levels[level][at.plane as usize + cell])
    }

    /// Sums of [`Self::value`] over points moved by (`dx`, `dy`): of the blocks that begin there, of those beside them, of those
    /// above, and of those above beside them.
    pub fn sum_four(&self, level: usize, points: &[FieldPoint], (dx, dy): (i32, i32)) -> [u32; 4] {
        let step = 1_i32 << level;
        let (inner_width, inner_height) = ((self.width - step).max(0), (self.height - step).max(0));
        let width = self.width as usize;
        let (right, up) = (step as usize, step as usize * width);
        let cells = self.levels[level].as_slice();
        let mut sums = [0; 4];
        for p in points {
            let at = p.moved(dx, dy);
            let is_inside = (at.x as u32) < inner_width as u32 && (at.y as u32) < inner_height as u32;
            if is_inside {
                let first = at.plane as usize + at.y as usize * width + at.x as usize;
                let Some(block) = cells.get(first..=first + up + right) else {
                    continue;
                };
                sums[0] += u32::from(block[0]);
                sums[1] += u32::from(block[right]);
                sums[2] += u32::from(block[up]);
                sums[3] += u32::from(block[up + right]);
            } else {
                let blocks = [(0, 0), (step, 0), (0, step), (step, step)];
                for (sum, (dx, dy)) in sums.iter_mut().zip(blocks) {
                    *sum += self.value(level, at.moved(dx, dy));
                }
            }
        }
        sums
    }
}

/// Each cell becomes the larger one of itself and the other.
fn raise(cells: &mut [u8], others: &[u8]) {
    for (cell, other) in cells.iter_mut().zip(others) {
        *cell = (*cell).max(*other);
    }
}

fn kernel() -> Vec<(i32, i32, u8)> {
    let mut out = Vec::new();
    for dy in -REACH_CELLS..=REACH_CELLS {
        for dx in -REACH_CELLS..=REACH_CELLS {
            let d2 = f64::from(dx * dx + dy * dy);
            let value = 255.0 * (-0.5 * d2).exp();
            if d2 < 9.0 {
                out.push((dx, dy, value.round() as u8));
            }
        }
    }
    out
}
