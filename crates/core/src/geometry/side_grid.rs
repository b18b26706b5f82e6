//! Sides of many polylines, found fast by place: nearest side and first side along a ray.
//!
//! A uniform grid, because it takes insertions and removals without rebalancing. A cell of 0.25 m holds one or two
//! sides of a wall, or six of a polyline that is being merged, and most questions are answered by the point's own cell (raw
//! intel: 10 % less time than with 0.5 m). Answers depend on
//! what the grid holds, not on how it came there: of two sides equally near, that of the lower polyline is taken, and of
//! its sides the first.

use super::cell_lists::{CellLists, Reader};
use super::cells::{CELL_M, Cell, CellWalk, cell_at, cell_of, for_each_cell};
use super::{Bends, Point, Segment};

/// A side in the grid: which polyline it belongs to, and where. One line of the processor's cache: most of what the grid does is
/// to look at sides here and there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(crate) struct Side {
    pub segment: Segment,
    /// Unit vector from start to end.
    pub direction: Point,
    pub length_m: f64,
    /// Name of the polyline, given by who inserted it.
    pub owner: u32,
    /// Number of the side within its polyline.
    pub index: u32,
}

/// Whether a side starts or ends its polyline, or both.
const STARTS: u8 = 1;
const ENDS: u8 = 2;

impl Side {
    /// Unit normal into free space.
    pub fn normal(&self) -> Point {
        self.direction.left()
    }

    /// From `a` to `b`; `None` when it has no length.
    fn between(a: Point, b: Point, owner: u32, index: u32) -> Option<Self> {
        let segment = Segment::new(a, b);
        Some(Self {
            segment,
            direction: segment.direction()?,
            length_m: segment.length_m(),
            owner,
            index,
        })
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
    /// By side, whether it is an end of its polyline: [`STARTS`], [`ENDS`].
    ends: Vec<u8>,
    /// By side, how it bends into the sides before and behind it; none in a grid of dense sides.
    bends: Vec<Bends>,
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

    /// Takes the sides of a polyline in, in the place of those it had; sides of no length are left out.
    pub fn insert(&mut self, owner: u32, vertices: impl IntoIterator<Item = Point>) {
        self.insert_dense(owner, vertices);
        self.bend(owner);
    }

    /// The same for sides so short that their directions are all noise: nobody asks for the curve along them. Costs as much as is
    /// different.
    pub fn insert_dense(&mut self, owner: u32, vertices: impl IntoIterator<Item = Point>) {
        if self.of_owner.len() <= owner as usize {
            self.of_owner.resize(owner as usize + 1, Vec::new());
        }
        let mut ids = std::mem::take(&mut self.of_owner[owner as usize]);
        for end in [ids.first(), ids.last()].into_iter().flatten() {
            self.ends[*end as usize] = 0;
        }
        let vertices: Vec<Point> = vertices.into_iter().collect();
        let (head, tail) = self.unchanged(&ids, &vertices);
        let pairs = vertices.len().saturating_sub(1);
        for (index, &id) in (pairs - tail..).zip(&ids[ids.len() - tail..]) {
            self.sides[id as usize].index = index as u32;
        }
        let gone = head..ids.len() - tail;
        let mut old = ids[gone.clone()].iter();
        let mut new = Vec::with_capacity(pairs - tail - head);
        for index in head..pairs - tail {
            let Some(side) = Side::between(vertices[index], vertices[index + 1], owner, index as u32) else {
                continue;
            };
            new.push(match old.next() {
                Some(&id) => self.replace(id, side),
                None => self.add(side),
            });
        }
        for &id in old {
            self.take_out(id);
        }
        ids.splice(gone, new);
        if let (Some(&first), Some(&last)) = (ids.first(), ids.last()) {
            self.ends[first as usize] |= STARTS;
            self.ends[last as usize] |= ENDS;
        }
        self.of_owner[owner as usize] = ids;
    }

    /// How many sides a polyline has that are as they were: from its start, and from its end.
    fn unchanged(&self, ids: &[u32], vertices: &[Point]) -> (usize, usize) {
        let is_between = |id: u32, pair: &[Point]| self.side(id).segment == Segment::new(pair[0], pair[1]);
        let head = ids
            .iter()
            .zip(vertices.windows(2))
            .zip(0_u32..)
            .take_while(|&((&id, pair), index)| self.side(id).index == index && is_between(id, pair))
            .count();
        let rest = ids.len().min(vertices.len().saturating_sub(1)) - head;
        let tail = ids
            .iter()
            .rev()
            .zip(vertices.windows(2).rev())
            .take(rest)
            .take_while(|&(&id, pair)| is_between(id, pair))
            .count();
        (head, tail)
    }

    /// Finds out how the sides of a polyline bend into each other.
    fn bend(&mut self, owner: u32) {
        self.bends.resize(self.sides.len(), Bends::default());
        let ids = &self.of_owner[owner as usize];
        for &id in ids {
            self.bends[id as usize] = Bends::default();
        }
        for pair in ids.windows(2) {
            let (before, behind) = (pair[0] as usize, pair[1] as usize);
            let (from, to) = (&self.sides[before], &self.sides[behind]);
            let (mut start, mut end) = (self.bends[before], self.bends[behind]);
            Bends::join(
                (&mut start, from.direction, from.length_m),
                (&mut end, to.direction, to.length_m),
            );
            (self.bends[before], self.bends[behind]) = (start, end);
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
        self.ends[id as usize] = 0;
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
            self.ends.push(0);
            (self.sides.len() - 1) as u32
        });
        self.sides[id as usize] = side;
        self.ends[id as usize] = 0;
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

    /// Whether `along_m` from the start of a side lies before the first or behind the last vertex of its polyline.
    fn is_beyond_end(&self, side: u32, along_m: f64) -> bool {
        let ends = self.ends[side as usize];
        (along_m < 0.0 && ends & STARTS != 0) || (along_m > self.side(side).length_m && ends & ENDS != 0)
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

    /// Unit vector along the curve that a side may be part of, at a share 0..=1 of the side.
    pub fn along(&self, side: u32, share: f64) -> Point {
        let Side {
            direction, length_m, ..
        } = *self.side(side);
        self.bends(side).along(direction, length_m, share)
    }

    /// How much wall tells the direction of a side, metres.
    pub fn told_by_m(&self, side: u32) -> f64 {
        self.bends(side).told_by_m(self.side(side).length_m)
    }

    /// A dense side bends nowhere.
    fn bends(&self, side: u32) -> Bends {
        self.grid.bends.get(side as usize).copied().unwrap_or_default()
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
        let columns = (cell_of(p.x - best.reach_m), cell_of(p.x + best.reach_m));
        let (y0, y1) = (cell_of(p.y - best.reach_m), cell_of(p.y + best.reach_m));
        for y in y0..=y1 {
            self.cells.in_row(y, columns, |cell, list| {
                if cell != own && best.reaches(cell) {
                    best.look(list, &allowed);
                }
            });
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
            if !self.near.beyond_ends && self.grid.is_beyond_end(id, along_m) {
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
