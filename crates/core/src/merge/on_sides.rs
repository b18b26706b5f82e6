//! Where the returns of all scans lie on the sides of the map.
//!
//! In: the map, the keyframes with their poses. Out, for every piece of some centimetres of every side of the skeletons: how
//! far off the side the returns lie, and whether returns cover it.

use std::borrow::Borrow;

use super::growing_map::GrowingMap;
use crate::geometry::{Near, Point};
use crate::keyframe::Keyframe;

/// A return may differ from its side by 37° in direction.
pub(crate) const MIN_COS: f64 = 0.8;
/// Fewer returns do not move a piece.
const LEAST_RETURNS: usize = 3;
/// Returns that a piece, or a stretch of pieces, should have by chance before it means something that they are missing:
/// none of four come by chance in one of 55 places.
const ENOUGH: f64 = 4.0;
/// A piece is covered by this share of the returns that it should have. (0.15 to 0.4 make no difference in the simulator.)
const COVERING: f64 = 0.25;
/// A return stands for no more of a wall than this, metres.
const WIDEST_SPREAD_M: f64 = 0.5;

/// How much of a wall a return stands for: the distance to the next beam on it, metres.
pub(crate) fn spread_m(keyframe: &Keyframe, point: Point, direction: Point) -> f64 {
    let step_rad = keyframe.scan.geometry().step_rad();
    let across_m = direction.cross(point).abs();
    (point.dot(point) * step_rad / across_m.max(1e-9)).min(WIDEST_SPREAD_M)
}

/// Returns on the pieces of the skeleton's sides.
pub(crate) struct OnSides {
    /// Number of the first piece of every side, and of the one after the last.
    first: Vec<usize>,
    /// By piece.
    pieces: Vec<Piece>,
}

/// What lies on a piece of a side.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Piece {
    /// The middle offset of the returns on it along the side's normal, metres.
    pub off_m: f64,
    /// Whether as many returns lie on it as should. A side between two returns of a scan may lead over what nobody saw; then
    /// the scans that stood elsewhere have no return on it either.
    pub is_covered: bool,
}

impl OnSides {
    /// `gate_m`: how far from its side a return may lie; `spacing_m`: length of a piece.
    pub fn of(map: &GrowingMap, keyframes: &[impl Borrow<Keyframe>], gate_m: f64, spacing_m: f64) -> Self {
        let mut first = vec![0];
        for side in map.skeleton.numbered() {
            let pieces = (side.length_m / spacing_m).round().max(1.0) as usize;
            first.push(first[first.len() - 1] + pieces);
        }
        let mut returns: Vec<Vec<f64>> = vec![Vec::new(); first[first.len() - 1]];
        let mut due: Vec<f64> = vec![0.0; returns.len()];
        let mut reader = map.skeleton.reader();
        for keyframe in keyframes.iter().map(Borrow::borrow) {
            let map_from_scan = keyframe.map_from_scan.isometry();
            for p in keyframe.standing_points() {
                let place = map_from_scan * p.point;
                let near = Near {
                    direction: map_from_scan.rotate(p.direction),
                    min_cos: MIN_COS,
                    max_distance_m: gate_m,
                    beyond_ends: false,
                };
                let Some(foot) = reader.nearest(place, &near, |_| true) else {
                    continue;
                };
                let side = map.skeleton.side(foot.side);
                let number = foot.side as usize;
                let pieces = first[number + 1] - first[number];
                let piece_at =
                    |share: f64| first[number] + ((share * pieces as f64) as usize).min(pieces - 1);
                returns[piece_at(foot.share)].push(side.normal().dot(place - side.segment.a));
                // One return is due on what it stands for, wherever on it.
                let half = 0.5 * spread_m(keyframe, p.point, p.direction) / side.length_m;
                let stretch = piece_at(foot.share - half)..=piece_at(foot.share + half);
                let share = 1.0 / stretch.clone().count() as f64;
                due[stretch].iter_mut().for_each(|due| *due += share);
            }
        }
        Self {
            first,
            pieces: pieces(returns, &due),
        }
    }

    /// Those of a side, in order.
    pub fn on_side(&self, number: u32) -> &[Piece] {
        &self.pieces[self.first[number as usize]..self.first[number as usize + 1]]
    }
}

/// From the offsets of the returns on each piece, and how many are due there.
fn pieces(returns: Vec<Vec<f64>>, due: &[f64]) -> Vec<Piece> {
    let is_covered = |(on_it, &due): (&Vec<f64>, &f64)| {
        if due < ENOUGH {
            !on_it.is_empty()
        } else {
            on_it.len() as f64 >= COVERING * due
        }
    };
    let mut covered: Vec<bool> = returns.iter().zip(due).map(is_covered).collect();
    let mut from = 0;
    while from < covered.len() {
        let to = from
            + covered[from..]
                .iter()
                .take_while(|&&c| c == covered[from])
                .count();
        let stretch = &due[from..to];
        if !covered[from] && stretch.iter().sum::<f64>() < ENOUGH && stretch.iter().all(|&due| due > 0.0) {
            covered[from..to].fill(true);
        }
        from = to;
    }
    returns
        .into_iter()
        .zip(covered)
        .map(|(on_it, is_covered)| Piece {
            off_m: middle_of(on_it),
            is_covered,
        })
        .collect()
}

/// The median; 0 for a few.
fn middle_of(mut offsets_m: Vec<f64>) -> f64 {
    if offsets_m.len() < LEAST_RETURNS {
        return 0.0;
    }
    let half = offsets_m.len() / 2;
    *offsets_m.select_nth_unstable_by(half, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_few_scans_could_have_hit_is_covered_and_what_many_should_have_hit_is_not() {
        let none = Vec::new;
        let some = || vec![0.01; 6];
        let is_covered = |returns: Vec<Vec<f64>>, due: &[f64]| -> Vec<bool> {
            pieces(returns, due).iter().map(|p| p.is_covered).collect()
        };
        assert_eq!(
            is_covered(vec![some(), none(), none(), some()], &[6.0, 1.5, 1.5, 6.0]),
            [true; 4],
            "far off, between two beams"
        );
        assert_eq!(
            is_covered(vec![some(), none(), none(), some()], &[6.0, 3.0, 3.0, 6.0]),
            [true, false, false, true]
        );
        assert_eq!(
            is_covered(vec![some(), vec![0.0], some()], &[6.0, 20.0, 6.0]),
            [true, false, true],
            "a stray return covers nothing"
        );
    }
}
