//! Maximal convex arcs of a polyline (paper section 3.2).
//!
//! In: a polyline. Out: stretches on which it bends one way only, in order and without overlap.
//! Where the bend changes its sign, the side between the two vertices belongs half to either arc: so each
//! turn is inside exactly one arc, and a polyline has the same arcs read forwards and backwards.

use std::ops::Range;

use super::{Part, TangentFunction};
use crate::geometry::Polyline;

/// Turns below this are read as straight: 2° is about three standard deviations of the turn between two fitted
/// sides of a metre (1 cm noise, 20 points a side: 0.45° a side, 0.63° the turn).
pub const STRAIGHT_TURN_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// Which way an arc bends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bend {
    /// No turn above [`STRAIGHT_TURN_RAD`]: a wall.
    Straight,
    /// To the left, towards the free space: a corner of a room.
    Left,
    /// To the right: a corner of an object.
    Right,
}

/// A maximal convex arc.
#[derive(Clone, Debug, PartialEq)]
pub struct Arc {
    /// Which way it bends.
    pub bend: Bend,
    /// The vertices from its first to its last turn; empty for a straight polyline.
    pub turns: Range<usize>,
    /// The stretch of the polyline it covers.
    pub part: Part,
}

/// The maximal convex arcs of a polyline, in order; none if it has no length.
///
/// Vertex numbers do not count vertices that repeat their predecessor.
#[must_use]
pub fn convex_arcs(polyline: &Polyline) -> Vec<Arc> {
    TangentFunction::new(polyline).map_or_else(Vec::new, |t| arcs_of(&t))
}

pub(super) fn arcs_of(tangent: &TangentFunction) -> Vec<Arc> {
    let mut arcs: Vec<Arc> = Vec::new();
    for vertex in 1..tangent.sides() {
        let turn_rad = tangent.turn_rad(vertex);
        let bend = match turn_rad {
            t if t.abs() < STRAIGHT_TURN_RAD => continue,
            t if t > 0.0 => Bend::Left,
            _ => Bend::Right,
        };
        match arcs.last_mut() {
            Some(arc) if arc.bend == bend => arc.turns.end = vertex + 1,
            Some(arc) => {
                let last_m = tangent.vertex_m(arc.turns.end - 1);
                let split_m = 0.5 * (last_m + tangent.vertex_m(vertex));
                arc.part.to_m = split_m;
                arcs.push(Arc {
                    bend,
                    turns: vertex..vertex + 1,
                    part: Part::new(split_m, 0.0),
                });
            }
            None => arcs.push(Arc {
                bend,
                turns: vertex..vertex + 1,
                part: Part::new(0.0, 0.0),
            }),
        }
    }
    if arcs.is_empty() {
        arcs.push(Arc {
            bend: Bend::Straight,
            turns: 0..0,
            part: Part::new(0.0, 0.0),
        });
    }
    if let Some(arc) = arcs.last_mut() {
        arc.part.to_m = tangent.length_m();
    }
    arcs
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;

    fn arcs(points: &[(f64, f64)]) -> Vec<Arc> {
        convex_arcs(&Polyline::new(points.iter().map(|&(x, y)| Point::new(x, y)).collect()).unwrap())
    }

    #[test]
    fn a_wall_is_one_arc_even_if_noise_bends_it() {
        let wall = arcs(&[(0.0, 0.0), (1.0, 0.01), (2.0, 0.0), (3.0, 0.01)]);
        assert_eq!(wall.len(), 1);
        assert_eq!(wall[0].bend, Bend::Straight);
        assert!((wall[0].part.length_m() - 3.0).abs() < 1e-3);
    }

    #[test]
    fn a_room_is_one_arc_and_a_niche_makes_more() {
        let room = arcs(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]);
        assert_eq!(room.len(), 1);
        assert_eq!((room[0].bend, room[0].turns.clone()), (Bend::Left, 1..3));

        // A wall with a pilaster: in, out, out, in.
        let pilaster = arcs(&[(0., 0.), (2., 0.), (2., 0.5), (3., 0.5), (3., 0.), (5., 0.)]);
        let bends: Vec<Bend> = pilaster.iter().map(|a| a.bend).collect();
        assert_eq!(bends, [Bend::Left, Bend::Right, Bend::Left]);
        assert_eq!(pilaster[1].turns, 2..4);
        assert!(
            (pilaster[1].part.from_m - 2.25).abs() < 1e-12,
            "the side is shared"
        );
        assert!((pilaster[2].part.to_m - 6.0).abs() < 1e-12);
    }

    #[test]
    fn reading_backwards_gives_the_same_arcs() {
        let mut points = vec![
            (0., 0.),
            (2., 0.),
            (2.3, 0.5),
            (3., 0.2),
            (3.5, 1.5),
            (5., 1.),
            (6., 0.5),
        ];
        let forwards = arcs(&points);
        points.reverse();
        let backwards = arcs(&points);
        let length_m = forwards.last().unwrap().part.to_m;
        assert_eq!(forwards.len(), backwards.len());
        for (f, b) in forwards.iter().zip(backwards.iter().rev()) {
            assert!((f.part.from_m - (length_m - b.part.to_m)).abs() < 1e-9);
        }
    }
}
