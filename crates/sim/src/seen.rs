//! Which pieces of wall were hit by beams.
//!
//! Walls are cut into pieces of about 5 cm. A piece is seen when a beam hit it, or when it lies between the hits
//! of two neighbouring beams on the same side no more than the paper's 0.20 m apart. A map can hold no more than
//! that, so recall is measured on it.

use polymapper_core::geometry::{Point, Polyline, Segment};

/// Length of the pieces, metres.
pub(crate) const PIECE_M: f64 = 0.05;
/// Neighbouring beams that hit a side this close together have seen what lies between (paper, section 2).
const GAP_M: f64 = 0.20;

/// Walls cut into pieces, and which of them were seen.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenWalls {
    sides: Vec<Segment>,
    /// Pieces of side k: `seen[starts[k]..starts[k + 1]]`.
    starts: Vec<usize>,
    seen: Vec<bool>,
}

/// The middle of a piece of wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPiece {
    /// Its middle, world frame.
    pub middle: Point,
    /// Its length, metres; pieces of one side are equally long.
    pub length_m: f64,
}

impl SeenWalls {
    /// Nothing seen of these walls.
    #[must_use]
    pub fn nothing(walls: &[Polyline]) -> Self {
        let sides: Vec<Segment> = walls.iter().flat_map(Polyline::sides).collect();
        let mut starts = vec![0];
        let mut count = 0;
        for side in &sides {
            count += pieces_of(*side);
            starts.push(count);
        }
        Self {
            sides,
            starts,
            seen: vec![false; count],
        }
    }

    /// Everything seen of these walls.
    #[must_use]
    pub fn everything(walls: &[Polyline]) -> Self {
        let mut all = Self::nothing(walls);
        all.seen.fill(true);
        all
    }

    /// A beam hit `side` at `share`.
    pub(crate) fn hit(&mut self, side: usize, share: f64) {
        self.hit_between(side, share, share);
    }

    /// Two neighbouring beams hit `side`.
    pub(crate) fn hit_pair(&mut self, side: usize, a: f64, b: f64) {
        if (a - b).abs() * self.sides[side].length_m() <= GAP_M {
            self.hit_between(side, a.min(b), a.max(b));
        }
    }

    fn hit_between(&mut self, side: usize, low: f64, high: f64) {
        let (start, end) = (self.starts[side], self.starts[side + 1]);
        let piece = |share: f64| ((share * (end - start) as f64) as usize).min(end - start - 1);
        self.seen[start + piece(low)..=start + piece(high)].fill(true);
    }

    /// The pieces that were seen.
    pub fn pieces(&self) -> impl Iterator<Item = WallPiece> + '_ {
        self.sides.iter().enumerate().flat_map(move |(k, side)| {
            let (start, end) = (self.starts[k], self.starts[k + 1]);
            let count = (end - start) as f64;
            let length_m = side.length_m() / count;
            (start..end).filter(|&i| self.seen[i]).map(move |i| WallPiece {
                middle: side.at(((i - start) as f64 + 0.5) / count),
                length_m,
            })
        })
    }

    /// Length of wall that was seen, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.pieces().map(|piece| piece.length_m).sum()
    }

    /// The seen stretches of every side, free space on their left.
    #[must_use]
    pub fn stretches(&self) -> Vec<Segment> {
        let mut out = Vec::new();
        for (k, side) in self.sides.iter().enumerate() {
            let seen = &self.seen[self.starts[k]..self.starts[k + 1]];
            let share = |i: usize| i as f64 / seen.len() as f64;
            let mut from = 0;
            for run in seen.chunk_by(|a, b| a == b) {
                let to = from + run.len();
                if run[0] {
                    out.push(Segment::new(side.at(share(from)), side.at(share(to))));
                }
                from = to;
            }
        }
        out
    }
}

fn pieces_of(side: Segment) -> usize {
    ((side.length_m() / PIECE_M).round() as usize).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall() -> Vec<Polyline> {
        vec![
            Polyline::new(vec![
                Point::new(0.0, 0.0),
                Point::new(1.0, 0.0),
                Point::new(1.0, 1.0),
            ])
            .unwrap(),
        ]
    }

    #[test]
    fn close_neighbours_see_what_lies_between() {
        let mut seen = SeenWalls::nothing(&wall());
        seen.hit_pair(0, 0.31, 0.49);
        assert!((seen.length_m() - 0.2).abs() < 1e-9);
        seen.hit_pair(1, 0.1, 0.6);
        assert!(
            (seen.length_m() - 0.2).abs() < 1e-9,
            "a gap of half a metre hides"
        );
        let stretches = seen.stretches();
        assert_eq!(stretches.len(), 1);
        assert!(stretches[0].a.distance(Point::new(0.3, 0.0)) < 1e-9);
        assert!(stretches[0].b.distance(Point::new(0.5, 0.0)) < 1e-9);
    }

    #[test]
    fn a_hit_at_the_end_of_a_side_is_on_its_last_piece() {
        let mut seen = SeenWalls::nothing(&wall());
        seen.hit(1, 1.0);
        let pieces: Vec<WallPiece> = seen.pieces().collect();
        assert_eq!(pieces.len(), 1);
        assert!(pieces[0].middle.distance(Point::new(1.0, 0.975)) < 1e-9);
        assert!((SeenWalls::everything(&wall()).length_m() - 2.0).abs() < 1e-9);
    }
}
