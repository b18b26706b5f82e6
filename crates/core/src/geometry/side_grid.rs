//! Sides of many polylines, found fast by place: nearest side and first side along a ray.
//!
//! A uniform grid, because it takes insertions and removals without rebalancing and gives the same answer
//! for the same history. A cell of 0.5 m holds a handful of wall sides, and the gates of alignment and
//! merging (≤ 0.5 m) then look at no more than nine cells.

use std::collections::HashMap;
use std::hash::BuildHasherDefault;

use super::cells::{CellHasher, CellWalk, cell_of, for_each_cell, key};
use super::{Point, Segment};

/// A side in the grid: which polyline it belongs to, and where.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    pub segment: Segment,
    /// Unit vector from start to end.
    pub direction: Point,
    pub length_m: f64,
    /// Name of the polyline, given by who inserted it.
    pub owner: u32,
    /// Number of the side within its polyline.
    pub index: u32,
    /// The side starts (bit 0) or ends (bit 1) its polyline.
    ends: u8,
}

impl Side {
    /// Unit normal into free space.
    pub fn normal(&self) -> Point {
        self.direction.left()
    }

    /// Whether `along_m` from the start lies before the first or behind the last vertex of the polyline.
    fn is_beyond_end(&self, along_m: f64) -> bool {
        (along_m < 0.0 && self.ends & 1 != 0) || (along_m > self.length_m && self.ends & 2 != 0)
    }
}

/// The closest point of a side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Foot {
    pub side: u32,
    pub point: Point,
    /// Share 0..=1 of the side.
    pub share: f64,
    pub distance_m: f64,
}

/// Where a ray meets a side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub side: u32,
    /// Along the ray, metres.
    pub range_m: f64,
    /// Share 0..=1 of the side.
    pub share: f64,
}

/// What a side must be like to count as near.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// Unit direction that the side shall have.
    pub direction: Point,
    /// Smallest cosine between the two directions.
    pub min_cos: f64,
    /// Largest distance, metres.
    pub max_distance_m: f64,
    /// Whether a foot on an end vertex counts for a point that lies beyond the end.
    pub beyond_ends: bool,
}

#[derive(Clone, Default)]
pub(crate) struct SideGrid {
    sides: Vec<Side>,
    unused: Vec<u32>,
    of_owner: Vec<Vec<u32>>,
    cells: HashMap<u64, Vec<u32>, BuildHasherDefault<CellHasher>>,
}

impl SideGrid {
    pub fn side(&self, side: u32) -> &Side {
        &self.sides[side as usize]
    }

    /// All sides ever taken in, by number; some may have been taken out since.
    pub fn numbered(&self) -> &[Side] {
        &self.sides
    }

    /// Every side in the grid, by polyline.
    pub fn sides(&self) -> impl Iterator<Item = &Side> + Clone + '_ {
        self.of_owner.iter().flatten().map(|&id| &self.sides[id as usize])
    }

    /// The numbers of the sides of one polyline, in order.
    pub fn numbers_of(&self, owner: u32) -> &[u32] {
        self.of_owner.get(owner as usize).map_or(&[], Vec::as_slice)
    }

    /// The sides of one polyline, in order.
    pub fn sides_of(&self, owner: u32) -> impl Iterator<Item = &Side> + '_ {
        self.of_owner
            .get(owner as usize)
            .into_iter()
            .flatten()
            .map(|&id| &self.sides[id as usize])
    }

    /// First and last side of a polyline.
    pub fn ends(&self, owner: u32) -> Option<(&Side, &Side)> {
        let ids = self.of_owner.get(owner as usize)?;
        Some((
            &self.sides[*ids.first()? as usize],
            &self.sides[*ids.last()? as usize],
        ))
    }

    /// Takes the sides of a polyline in; sides of no length are left out.
    pub fn insert(&mut self, owner: u32, vertices: impl IntoIterator<Item = Point>) {
        self.remove(owner);
        if self.of_owner.len() <= owner as usize {
            self.of_owner.resize(owner as usize + 1, Vec::new());
        }
        let mut ids = std::mem::take(&mut self.of_owner[owner as usize]);
        let mut previous: Option<Point> = None;
        for (index, vertex) in (0_u32..).zip(vertices) {
            let segment = previous.map(|from| Segment::new(from, vertex));
            previous = Some(vertex);
            let Some((segment, direction)) = segment.and_then(|s| Some((s, s.direction()?))) else {
                continue;
            };
            let ends = u8::from(ids.is_empty());
            let side = Side {
                segment,
                direction,
                length_m: segment.length_m(),
                owner,
                index: index - 1,
                ends,
            };
            ids.push(self.add(side));
        }
        if let Some(&last) = ids.last() {
            self.sides[last as usize].ends |= 2;
        }
        self.of_owner[owner as usize] = ids;
    }

    /// Takes all sides of a polyline out.
    pub fn remove(&mut self, owner: u32) {
        let Some(ids) = self.of_owner.get_mut(owner as usize) else {
            return;
        };
        let ids = std::mem::take(ids);
        // Sides of some centimetres come a dozen to a cell, one after the other: the cell is gone through once for all.
        let mut emptied = None;
        for &id in &ids {
            for_each_cell(self.sides[id as usize].segment, |cell| {
                if emptied.replace(cell) != Some(cell)
                    && let Some(list) = self.cells.get_mut(&cell)
                {
                    list.retain(|&s| self.sides[s as usize].owner != owner);
                }
            });
        }
        self.unused.extend(ids);
    }

    fn add(&mut self, side: Side) -> u32 {
        let id = self.unused.pop().unwrap_or_else(|| {
            self.sides.push(side);
            (self.sides.len() - 1) as u32
        });
        self.sides[id as usize] = side;
        for_each_cell(side.segment, |cell| self.cells.entry(cell).or_default().push(id));
        id
    }

    /// The nearest side that `near` allows and `allowed` (given its owner) agrees to.
    pub fn nearest(&self, p: Point, near: &Near, allowed: impl Fn(u32) -> bool) -> Option<Foot> {
        let mut best: Option<Foot> = None;
        let mut reach_m = near.max_distance_m;
        let (x0, x1) = (cell_of(p.x - reach_m), cell_of(p.x + reach_m));
        let (y0, y1) = (cell_of(p.y - reach_m), cell_of(p.y + reach_m));
        for cx in x0..=x1 {
            for cy in y0..=y1 {
                let Some(list) = self.cells.get(&key(cx, cy)) else {
                    continue;
                };
                for &id in list {
                    let side = &self.sides[id as usize];
                    if side.direction.dot(near.direction) < near.min_cos {
                        continue;
                    }
                    let from_start = p - side.segment.a;
                    let along_m = from_start.dot(side.direction);
                    let clamped_m = along_m.clamp(0.0, side.length_m);
                    let foot = side.segment.a + side.direction * clamped_m;
                    let distance_m = foot.distance(p);
                    if distance_m > reach_m || !allowed(side.owner) {
                        continue;
                    }
                    if !near.beyond_ends && side.is_beyond_end(along_m) {
                        continue;
                    }
                    let closer = best.is_none_or(|b| {
                        distance_m < b.distance_m || (distance_m <= b.distance_m && id < b.side)
                    });
                    if closer {
                        reach_m = distance_m;
                        best = Some(Foot {
                            side: id,
                            point: foot,
                            share: clamped_m / side.length_m,
                            distance_m,
                        });
                    }
                }
            }
        }
        best
    }

    /// Calls `visit` for every side that the ray meets between 0 and `max_range_m`, in no order of range,
    /// possibly twice for a side; stops at the cell in which `visit` returns false.
    ///
    /// `direction` has length 1.
    pub fn along_ray(
        &self,
        origin: Point,
        direction: Point,
        max_range_m: f64,
        mut visit: impl FnMut(Crossing) -> bool,
    ) {
        let mut walk = CellWalk::new(origin, direction, max_range_m);
        while let Some((cell, leave_m)) = walk.next_cell() {
            let Some(list) = self.cells.get(&cell) else {
                continue;
            };
            let mut go_on = true;
            for &id in list {
                let Some((range_m, share)) = self.sides[id as usize].segment.meet_ray(origin, direction)
                else {
                    continue;
                };
                // A side is met in the cell that holds the meeting point, so that the first cell with a hit has the first hit.
                if range_m <= leave_m + 1e-9 && range_m <= max_range_m {
                    go_on &= visit(Crossing {
                        side: id,
                        range_m,
                        share,
                    });
                }
            }
            if !go_on {
                return;
            }
        }
    }

    /// The first side along the ray.
    pub fn first_along_ray(&self, origin: Point, direction: Point, max_range_m: f64) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        self.along_ray(origin, direction, max_range_m, |c| {
            if first.is_none_or(|f| c.range_m < f.range_m || (c.range_m <= f.range_m && c.side < f.side)) {
                first = Some(c);
            }
            false
        });
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn world() -> (SideGrid, Vec<Segment>) {
        let mut grid = SideGrid::default();
        let mut all = Vec::new();
        for k in 0..40_u32 {
            let turn = f64::from(k) * 0.7;
            let from = Point::from_polar(0.3 * f64::from(k), turn);
            let to = from + Point::from_polar(0.2 + 0.1 * f64::from(k % 7), 2.1 * turn);
            grid.insert(k, [from, to]);
            all.push(Segment::new(from, to));
        }
        (grid, all)
    }

    #[test]
    fn rays_meet_what_a_search_of_all_sides_finds() {
        let (grid, all) = world();
        for k in 0..360 {
            let direction = Point::from_polar(1.0, f64::from(k) * 0.01745);
            let origin = Point::new(0.13, -0.21);
            let naive = all
                .iter()
                .filter_map(|s| s.meet_ray(origin, direction))
                .map(|h| h.0)
                .fold(20.0, f64::min);
            let found = grid
                .first_along_ray(origin, direction, 20.0)
                .map_or(20.0, |c| c.range_m);
            assert!((naive - found).abs() < 1e-9, "ray {k}: {naive} against {found}");
        }
    }

    #[test]
    fn the_nearest_side_is_the_nearest_of_all() {
        let (grid, all) = world();
        for k in 0..500 {
            let p = Point::from_polar(0.02 * f64::from(k), f64::from(k));
            let near = Near {
                direction: Point::new(1.0, 0.0),
                min_cos: -1.0,
                max_distance_m: 0.8,
                beyond_ends: true,
            };
            let naive = all.iter().map(|s| s.distance(p)).fold(f64::INFINITY, f64::min);
            match grid.nearest(p, &near, |_| true) {
                Some(foot) => assert!((foot.distance_m - naive).abs() < 1e-9),
                None => assert!(naive > 0.8, "missed a side at {naive} m"),
            }
        }
    }

    #[test]
    fn what_is_taken_out_is_found_no_more() {
        let (mut grid, _) = world();
        for k in 0..40 {
            grid.remove(k);
        }
        assert!(
            grid.first_along_ray(Point::default(), Point::new(1.0, 0.0), 50.0)
                .is_none()
        );
    }
}
