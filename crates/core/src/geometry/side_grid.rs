//! Sides of many polylines, found fast by place: nearest side and first side along a ray.
//!
//! A uniform grid, because it takes insertions and removals without rebalancing. A cell of 0.5 m holds a handful of
//! wall sides, and the gates of alignment and merging (≤ 0.5 m) then look at no more than nine cells. Answers depend on
//! what the grid holds, not on how it came there: of two sides equally near, that of the lower polyline is taken, and of
//! its sides the first.

use super::cell_lists::{CellLists, Reader};
use super::cells::{CELL_M, Cell, CellWalk, cell_at, cell_of, for_each_cell};
use super::{Bends, Point, Segment};

/// A side in the grid: which polyline it belongs to, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// How it bends into the sides before and behind it.
    bends: Bends,
}

impl Side {
    /// Unit normal into free space.
    pub fn normal(&self) -> Point {
        self.direction.left()
    }

    /// Unit vector along the curve that the side may be part of, at a share 0..=1 of the side.
    pub fn along(&self, share: f64) -> Point {
        self.bends.along(self.direction, self.length_m, share)
    }

    /// How much wall tells its direction, metres.
    pub fn told_by_m(&self) -> f64 {
        self.bends.told_by_m(self.length_m)
    }

    /// Bends into the side that follows.
    fn bend_into(&mut self, next: &mut Self) {
        Bends::join(
            (&mut self.bends, self.direction, self.length_m),
            (&mut next.bends, next.direction, next.length_m),
        );
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
    cells: CellLists,
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

    /// Takes the sides of a polyline in, in the place of those it had; sides of no length are left out. Costs as much as
    /// is different.
    pub fn insert(&mut self, owner: u32, vertices: impl IntoIterator<Item = Point>) {
        if self.of_owner.len() <= owner as usize {
            self.of_owner.resize(owner as usize + 1, Vec::new());
        }
        let before = std::mem::take(&mut self.of_owner[owner as usize]);
        let sides = self.sides_through(owner, vertices, &before);
        let stays = |&(&id, side): &(&u32, &Side)| self.side(id).segment == side.segment;
        let head = before.iter().zip(&sides).take_while(stays).count();
        let rest = before.len().min(sides.len()) - head;
        let ends = before.iter().rev().zip(sides.iter().rev());
        let tail = ends.take(rest).take_while(stays).count();

        let (gone, new) = (head..before.len() - tail, head..sides.len() - tail);
        let mut ids = Vec::with_capacity(sides.len());
        ids.extend_from_slice(&before[..head]);
        let mut old = before[gone.clone()].iter();
        for &side in &sides[new] {
            ids.push(match old.next() {
                Some(&id) => self.replace(id, side),
                None => self.add(side),
            });
        }
        for &id in old {
            self.take_out(id);
        }
        ids.extend_from_slice(&before[gone.end..]);
        for (&id, side) in ids.iter().zip(&sides) {
            let kept = &mut self.sides[id as usize];
            (kept.index, kept.ends, kept.bends) = (side.index, side.ends, side.bends);
        }
        self.of_owner[owner as usize] = ids;
    }

    /// The sides between vertices; what has no length is left out. `before` are those that the polyline had.
    fn sides_through(
        &self,
        owner: u32,
        vertices: impl IntoIterator<Item = Point>,
        before: &[u32],
    ) -> Vec<Side> {
        let mut sides: Vec<Side> = Vec::with_capacity(before.len() + 8);
        let mut previous: Option<Point> = None;
        for (index, vertex) in (0_u32..).zip(vertices) {
            let Some(from) = previous.replace(vertex) else {
                continue;
            };
            let segment = Segment::new(from, vertex);
            let Some((direction, length_m)) = self.measured(segment, before.get(sides.len())) else {
                continue;
            };
            sides.push(Side {
                segment,
                direction,
                length_m,
                owner,
                index: index - 1,
                ends: 0,
                bends: Bends::default(),
            });
        }
        for k in 1..sides.len() {
            let (before, behind) = sides.split_at_mut(k);
            if let ([.., before], [behind, ..]) = (before, behind) {
                before.bend_into(behind);
            }
        }
        if let Some(first) = sides.first_mut() {
            first.ends |= 1;
        }
        if let Some(last) = sides.last_mut() {
            last.ends |= 2;
        }
        sides
    }

    /// Direction and length of a side, known already where the one `before` it in its place was the same; `None` when it has
    /// no length.
    fn measured(&self, segment: Segment, before: Option<&u32>) -> Option<(Point, f64)> {
        match before.map(|&id| self.side(id)) {
            Some(side) if side.segment == segment => Some((side.direction, side.length_m)),
            _ => Some((segment.direction()?, segment.length_m())),
        }
    }

    /// Takes all sides of a polyline out.
    pub fn remove(&mut self, owner: u32) {
        let Some(ids) = self.of_owner.get_mut(owner as usize) else {
            return;
        };
        for id in std::mem::take(ids) {
            self.take_out(id);
        }
    }

    /// Puts a side in the place of another; returns its number.
    fn replace(&mut self, id: u32, side: Side) -> u32 {
        let before = std::mem::replace(&mut self.sides[id as usize], side).segment;
        let is_same_cell = |p: Point, q: Point| cell_at(p) == cell_at(q);
        let segment = side.segment;
        let stays = is_same_cell(segment.a, before.a)
            && is_same_cell(segment.b, before.b)
            && is_same_cell(segment.a, segment.b);
        if !stays {
            for_each_cell(before, |cell| self.cells.remove(cell, id));
            for_each_cell(segment, |cell| self.cells.add(cell, id));
        }
        id
    }

    fn take_out(&mut self, id: u32) {
        for_each_cell(self.sides[id as usize].segment, |cell| {
            self.cells.remove(cell, id);
        });
        self.unused.push(id);
    }

    fn add(&mut self, side: Side) -> u32 {
        let id = self.unused.pop().unwrap_or_else(|| {
            self.sides.push(side);
            (self.sides.len() - 1) as u32
        });
        self.sides[id as usize] = side;
        for_each_cell(side.segment, |cell| self.cells.add(cell, id));
        id
    }

    /// For many questions about places near each other.
    pub fn reader(&self) -> GridReader<'_> {
        GridReader {
            grid: self,
            cells: self.cells.reader(),
        }
    }

    /// What decides between two sides that are equally near.
    fn rank(&self, side: u32) -> (u32, u32) {
        let side = self.side(side);
        (side.owner, side.index)
    }
}

/// Answers questions about places near each other: it remembers where the sides there are kept.
pub(crate) struct GridReader<'a> {
    grid: &'a SideGrid,
    cells: Reader<'a>,
}

impl<'a> GridReader<'a> {
    /// A side of the grid.
    pub fn side(&self, side: u32) -> &'a Side {
        self.grid.side(side)
    }

    /// The nearest side that `near` allows and `allowed` (given its owner) agrees to.
    pub fn nearest(&mut self, p: Point, near: &Near, allowed: impl Fn(u32) -> bool) -> Option<Foot> {
        let mut best = Nearest {
            grid: self.grid,
            p,
            near,
            reach_m: near.max_distance_m,
            foot: None,
        };
        // What is found in the point's own cell most often leaves no other to look at.
        let own = cell_at(p);
        best.look(self.cells.get(own), &allowed);
        let (x0, x1) = (cell_of(p.x - best.reach_m), cell_of(p.x + best.reach_m));
        let (y0, y1) = (cell_of(p.y - best.reach_m), cell_of(p.y + best.reach_m));
        for cy in y0..=y1 {
            for cx in x0..=x1 {
                let list = self.cells.get((cx, cy));
                if !list.is_empty() && (cx, cy) != own && best.reaches((cx, cy)) {
                    best.look(list, &allowed);
                }
            }
        }
        best.foot
    }

    /// Calls `visit` for every side that the ray meets between 0 and `max_range_m`, in no order of range,
    /// possibly twice for a side; stops at the cell in which `visit` returns false.
    ///
    /// `direction` has length 1.
    pub fn along_ray(
        &mut self,
        origin: Point,
        direction: Point,
        max_range_m: f64,
        mut visit: impl FnMut(Crossing) -> bool,
    ) {
        let mut walk = CellWalk::new(origin, direction, max_range_m);
        while let Some((cell, leave_m)) = walk.next_cell() {
            let mut go_on = true;
            for &id in self.cells.get(cell) {
                let Some((range_m, share)) = self.grid.sides[id as usize].segment.meet_ray(origin, direction)
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
    pub fn first_along_ray(&mut self, origin: Point, direction: Point, max_range_m: f64) -> Option<Crossing> {
        let grid = self.grid;
        let mut first: Option<Crossing> = None;
        self.along_ray(origin, direction, max_range_m, |c| {
            if first.is_none_or(|f| {
                c.range_m < f.range_m || (c.range_m <= f.range_m && grid.rank(c.side) < grid.rank(f.side))
            }) {
                first = Some(c);
            }
            false
        });
        first
    }
}

/// The nearest side so far.
struct Nearest<'a> {
    grid: &'a SideGrid,
    p: Point,
    near: &'a Near,
    /// What is farther is not looked at, metres.
    reach_m: f64,
    foot: Option<Foot>,
}

impl Nearest<'_> {
    /// Whether something in a cell may be nearer than what was found.
    fn reaches(&self, (cx, cy): Cell) -> bool {
        let off_m = |coordinate_m: f64, cell: i32| {
            let low_m = f64::from(cell) * CELL_M;
            (low_m - coordinate_m).max(coordinate_m - low_m - CELL_M).max(0.0)
        };
        let off = Point::new(off_m(self.p.x, cx), off_m(self.p.y, cy));
        off.dot(off) <= (self.reach_m + 1e-9).powi(2)
    }

    fn look(&mut self, list: &[u32], allowed: &impl Fn(u32) -> bool) {
        for &id in list {
            let side = &self.grid.sides[id as usize];
            if side.direction.dot(self.near.direction) < self.near.min_cos {
                continue;
            }
            let from_start = self.p - side.segment.a;
            // No foot is nearer than the side's line.
            if side.direction.cross(from_start).abs() > self.reach_m + 1e-9 {
                continue;
            }
            let along_m = from_start.dot(side.direction);
            let clamped_m = along_m.clamp(0.0, side.length_m);
            let foot = side.segment.a + side.direction * clamped_m;
            let distance_m = foot.distance(self.p);
            if distance_m > self.reach_m || !allowed(side.owner) {
                continue;
            }
            if !self.near.beyond_ends && side.is_beyond_end(along_m) {
                continue;
            }
            let is_closer = self.foot.is_none_or(|best| {
                distance_m < best.distance_m
                    || (distance_m <= best.distance_m && self.grid.rank(id) < self.grid.rank(best.side))
            });
            if is_closer {
                self.reach_m = distance_m;
                self.foot = Some(Foot {
                    side: id,
                    point: foot,
                    share: clamped_m / side.length_m,
                    distance_m,
                });
            }
        }
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
                .reader()
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
            match grid.reader().nearest(p, &near, |_| true) {
                Some(foot) => assert!((foot.distance_m - naive).abs() < 1e-9),
                None => assert!(naive > 0.8, "missed a side at {naive} m"),
            }
        }
    }

    #[test]
    fn a_polyline_that_changed_is_as_if_taken_in_anew() {
        let wave =
            |count: u32| (0..count).map(|k| Point::new(0.3 * f64::from(k), (0.7 * f64::from(k)).sin()));
        let aside = [Point::new(3.0, 4.0), Point::new(3.5, 4.2), Point::new(3.5, 4.2)];
        let longer: Vec<Point> = wave(10).chain(aside).chain(wave(30).skip(11)).collect();
        let shorter: Vec<Point> = wave(5).chain(wave(30).skip(25)).collect();
        let mut grid = SideGrid::default();
        for vertices in [wave(30).collect(), longer, shorter.clone(), shorter, Vec::new()] {
            grid.insert(0, vertices.iter().copied());
            let mut anew = SideGrid::default();
            anew.insert(0, vertices);
            assert!(grid.sides().eq(anew.sides()));
            for k in 0..200 {
                let (origin, direction) = (Point::new(4.0, 2.0), Point::from_polar(1.0, f64::from(k)));
                let met = |grid: &SideGrid| {
                    let crossing = grid.reader().first_along_ray(origin, direction, 20.0)?;
                    Some((grid.side(crossing.side).index, crossing.range_m))
                };
                assert_eq!(met(&grid), met(&anew), "ray {k}");
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
            grid.reader()
                .first_along_ray(Point::default(), Point::new(1.0, 0.0), 50.0)
                .is_none()
        );
    }
}
