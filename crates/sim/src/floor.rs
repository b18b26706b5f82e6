//! A floor painted in layers, and the walls that remain of it.
//!
//! In: shapes (any simple polygon), painted over each other as free floor or as solid; what nothing is painted
//! on is solid. Out: the border between free and solid as closed polylines with free space on their left.
//!
//! Every edge is cut where another edge meets it; a piece is wall when the floor is free on one side of it
//! and solid on the other. So no wall is hidden in another one, and rooms, doors and furniture need not fit
//! each other to the millimetre.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use polymapper_core::geometry::{Point, Polyline, Segment};

use crate::dice::direction;

/// Distance from an edge at which free and solid are told apart; pieces shorter than that are dropped, and
/// points closer than that are one.
const HAIR_M: f64 = 1e-7;

/// What a shape is painted as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Paint {
    Free,
    Solid,
}

struct Layer {
    outline: Vec<Point>,
    min: Point,
    max: Point,
    paint: Paint,
}

/// Layers in the order of painting; the last one that covers a point decides.
#[derive(Default)]
pub(crate) struct Floor {
    layers: Vec<Layer>,
}

impl Floor {
    /// Paints a polygon (closed by itself; the first vertex is not repeated).
    pub(crate) fn paint(&mut self, paint: Paint, outline: Vec<Point>) {
        let (min, max) = bounds(&outline);
        self.layers.push(Layer {
            outline,
            min,
            max,
            paint,
        });
    }

    /// Whether nothing solid covers `p`.
    pub(crate) fn is_free(&self, p: Point) -> bool {
        let top = self.layers.iter().rev().find(|layer| layer.covers(p));
        top.is_some_and(|layer| layer.paint == Paint::Free)
    }

    /// The border between free and solid: closed polylines (the last vertex repeats the first), free on the left.
    pub(crate) fn walls(&self) -> Vec<Polyline> {
        let edges: Vec<Segment> = self.layers.iter().flat_map(Layer::edges).collect();
        let mut pieces = Pieces::default();
        for (k, &edge) in edges.iter().enumerate() {
            let cuts = cuts(k, &edges);
            for pair in cuts.windows(2) {
                if (pair[1] - pair[0]) * edge.length_m() < HAIR_M {
                    continue;
                }
                self.keep_if_wall(Segment::new(edge.at(pair[0]), edge.at(pair[1])), &mut pieces);
            }
        }
        pieces.chained()
    }

    fn keep_if_wall(&self, piece: Segment, pieces: &mut Pieces) {
        let Some(along) = piece.direction() else { return };
        let middle = piece.at(0.5);
        let left_free = self.is_free(middle + along.left() * HAIR_M);
        let right_free = self.is_free(middle - along.left() * HAIR_M);
        match (left_free, right_free) {
            (true, false) => pieces.insert(piece.a, piece.b),
            (false, true) => pieces.insert(piece.b, piece.a),
            _ => {}
        }
    }
}

impl Layer {
    fn edges(&self) -> impl Iterator<Item = Segment> + '_ {
        let n = self.outline.len();
        (0..n).map(move |k| Segment::new(self.outline[k], self.outline[(k + 1) % n]))
    }

    fn covers(&self, p: Point) -> bool {
        let boxed = p.x >= self.min.x && p.x <= self.max.x && p.y >= self.min.y && p.y <= self.max.y;
        boxed && self.edges().filter(|edge| crossed_rightwards(*edge, p)).count() % 2 == 1
    }
}

/// Whether a ray from `p` along +x crosses the edge (half open, so that a vertex counts once).
fn crossed_rightwards(edge: Segment, p: Point) -> bool {
    let Segment { a, b } = edge;
    (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
}

/// Shares of edge `k` at which another edge meets it, with both ends, ascending.
fn cuts(k: usize, edges: &[Segment]) -> Vec<f64> {
    let edge = edges[k];
    let (min, max) = bounds(&[edge.a, edge.b]);
    let mut cuts = vec![0.0, 1.0];
    for (other_k, other) in edges.iter().enumerate() {
        let (low, high) = bounds(&[other.a, other.b]);
        let apart = low.x > max.x + HAIR_M
            || low.y > max.y + HAIR_M
            || high.x < min.x - HAIR_M
            || high.y < min.y - HAIR_M;
        if other_k == k || apart {
            continue;
        }
        // Ends lying on the edge: needed where edges run along each other.
        for end in [other.a, other.b] {
            let share = edge.closest_share(end);
            if edge.at(share).distance(end) < HAIR_M {
                cuts.push(share);
            }
        }
        if let Some((share, _)) = other.meet_ray(edge.a, edge.b - edge.a)
            && share < 1.0
        {
            cuts.push(share);
        }
    }
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|b, a| (*b - *a) * edge.length_m() < HAIR_M);
    cuts
}

/// Pieces of wall by the place where they start; places are rounded, so that the same corner reached along
/// two edges is one.
#[derive(Default)]
struct Pieces {
    by_start: BTreeMap<(i64, i64), Vec<Segment>>,
}

impl Pieces {
    fn key(p: Point) -> (i64, i64) {
        let round = |v: f64| (v / (2.0 * HAIR_M)).round() as i64;
        (round(p.x), round(p.y))
    }

    /// Adds a piece, once, however many edges run along it.
    fn insert(&mut self, a: Point, b: Point) {
        let there = self.by_start.entry(Self::key(a)).or_default();
        if there.iter().all(|piece| Self::key(piece.b) != Self::key(b)) {
            there.push(Segment::new(a, b));
        }
    }

    /// Takes the piece that goes on from `last`; where two solids touch in a corner, the one that stays on the
    /// same solid, which is the one furthest to the right.
    fn take_next(&mut self, last: Segment) -> Option<Segment> {
        let key = Self::key(last.b);
        let there = self.by_start.get_mut(&key)?;
        let turn = |piece: &Segment| {
            let (d, e) = (last.b - last.a, piece.b - piece.a);
            libm::atan2(d.cross(e), d.dot(e))
        };
        let best = (0..there.len()).min_by(|&i, &j| turn(&there[i]).total_cmp(&turn(&there[j])))?;
        let piece = there.swap_remove(best);
        if there.is_empty() {
            self.by_start.remove(&key);
        }
        Some(piece)
    }

    fn chained(mut self) -> Vec<Polyline> {
        let mut walls = Vec::new();
        while let Some((&key, there)) = self.by_start.iter_mut().next() {
            let Some(first) = there.pop() else {
                self.by_start.remove(&key);
                continue;
            };
            let mut loop_of_vertices = vec![first.a];
            let mut last = first;
            while Self::key(last.b) != Self::key(first.a) {
                loop_of_vertices.push(last.b);
                match self.take_next(last) {
                    Some(piece) => last = piece,
                    None => break,
                }
            }
            walls.extend(closed_wall(loop_of_vertices));
        }
        walls
    }
}

/// A closed polyline without vertices in the middle of a straight side.
fn closed_wall(mut vertices: Vec<Point>) -> Option<Polyline> {
    let n = vertices.len();
    let is_corner = |k: usize| {
        let (a, b, c) = (vertices[(k + n - 1) % n], vertices[k], vertices[(k + 1) % n]);
        Segment::new(a, c).distance(b) > HAIR_M
    };
    let corners: Vec<Point> = (0..n).filter(|&k| is_corner(k)).map(|k| vertices[k]).collect();
    vertices = corners;
    let first = *vertices.first()?;
    vertices.push(first);
    (vertices.len() > 3)
        .then(|| Polyline::new(vertices).ok())
        .flatten()
}

/// Corners of the smallest box around points; infinite for no points.
pub(crate) fn bounds(points: &[Point]) -> (Point, Point) {
    let start = (
        Point::new(f64::INFINITY, f64::INFINITY),
        Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY),
    );
    points.iter().fold(start, |(low, high), p| {
        (
            Point::new(low.x.min(p.x), low.y.min(p.y)),
            Point::new(high.x.max(p.x), high.y.max(p.y)),
        )
    })
}

/// The box between two corners, with sides along the axes.
pub(crate) fn rectangle(x0: f64, y0: f64, x1: f64, y1: f64) -> Vec<Point> {
    vec![
        Point::new(x0, y0),
        Point::new(x1, y0),
        Point::new(x1, y1),
        Point::new(x0, y1),
    ]
}

/// A box of `length_m` by `width_m` round `centre`, its length in direction `bearing_rad`.
pub(crate) fn turned_rectangle(centre: Point, length_m: f64, width_m: f64, bearing_rad: f64) -> Vec<Point> {
    let along = direction(bearing_rad) * (0.5 * length_m);
    let across = direction(bearing_rad).left() * (0.5 * width_m);
    vec![
        centre - along - across,
        centre + along - across,
        centre + along + across,
        centre - along + across,
    ]
}

/// A circle as a polygon whose sides stay within 1 mm of it.
pub(crate) fn circle(centre: Point, radius_m: f64) -> Vec<Point> {
    // The sagitta of a chord over the angle a is r·(1 − cos(a/2)), about r·a²/8.
    let step_rad = (8.0 * 0.001 / radius_m).sqrt();
    let n = ((TAU / step_rad).ceil() as usize).max(8);
    (0..n)
        .map(|k| centre + direction(TAU * k as f64 / n as f64) * radius_m)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Free on the left, solid on the right, for every side.
    fn assert_faces(floor: &Floor, walls: &[Polyline]) {
        for side in walls.iter().flat_map(Polyline::sides) {
            let left = side.direction().unwrap().left() * 1e-3;
            assert!(floor.is_free(side.at(0.5) + left), "left of {side:?}");
            assert!(!floor.is_free(side.at(0.5) - left), "right of {side:?}");
        }
    }

    #[test]
    fn two_rooms_and_a_door_have_one_wall_round_them() {
        let mut floor = Floor::default();
        floor.paint(Paint::Free, rectangle(0.0, 0.0, 3.0, 3.0));
        floor.paint(Paint::Free, rectangle(3.2, 0.0, 6.0, 3.0));
        floor.paint(Paint::Free, rectangle(3.0, 1.0, 3.2, 2.0));
        let walls = floor.walls();
        assert_eq!(walls.len(), 1);
        assert_eq!(walls[0].vertices().len(), 12 + 1, "{walls:?}");
        let length_m = 12.0 + 2.0 * (2.8 + 3.0) - 2.0 + 0.4;
        assert!((walls[0].length_m() - length_m).abs() < 1e-9);
        assert_faces(&floor, &walls);
    }

    #[test]
    fn a_cupboard_at_the_wall_becomes_part_of_it() {
        let mut floor = Floor::default();
        floor.paint(Paint::Free, rectangle(0.0, 0.0, 4.0, 3.0));
        floor.paint(Paint::Solid, rectangle(1.0, 2.6, 2.0, 3.0));
        let walls = floor.walls();
        assert_eq!(walls.len(), 1);
        assert!((walls[0].length_m() - (14.0 + 0.8)).abs() < 1e-9);
        assert_faces(&floor, &walls);
    }

    #[test]
    fn round_and_turned_things_that_overlap_leave_their_common_outline() {
        let mut floor = Floor::default();
        floor.paint(Paint::Free, circle(Point::default(), 4.0));
        floor.paint(
            Paint::Solid,
            turned_rectangle(Point::new(1.0, 0.5), 1.5, 0.4, 0.6),
        );
        floor.paint(
            Paint::Solid,
            turned_rectangle(Point::new(1.0, 0.5), 1.5, 0.4, 2.0),
        );
        floor.paint(Paint::Solid, circle(Point::new(-1.0, 0.0), 0.5));
        let walls = floor.walls();
        assert_eq!(walls.len(), 3);
        assert_faces(&floor, &walls);
        let cross = walls
            .iter()
            .find(|w| w.vertices().len() == 13)
            .expect("a cross of 12 corners");
        assert!(cross.length_m() < 2.0 * 2.0 * 1.9 - 4.0 * 0.4);
    }

    #[test]
    fn blocks_that_touch_in_a_corner_stay_two_blocks() {
        let mut floor = Floor::default();
        floor.paint(Paint::Free, rectangle(0.0, 0.0, 4.0, 4.0));
        floor.paint(Paint::Solid, rectangle(1.0, 1.0, 2.0, 2.0));
        floor.paint(Paint::Solid, rectangle(2.0, 2.0, 3.0, 3.0));
        let walls = floor.walls();
        assert_eq!(
            walls.iter().map(|w| w.vertices().len()).collect::<Vec<_>>(),
            [5, 5, 5]
        );
        assert_faces(&floor, &walls);
    }
}
