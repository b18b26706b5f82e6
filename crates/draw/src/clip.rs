//! Lines cut to a rectangle, in pixels.

use crate::plate::{Px, PxBox};

/// The pieces of the line through `points` that lie in `frame`. A point that is not finite ends a piece.
pub(crate) fn line(points: &[Px], frame: PxBox) -> Vec<Vec<Px>> {
    let mut pieces = Vec::new();
    let mut piece: Vec<Px> = Vec::new();
    for side in points.windows(2) {
        let Some((a, b)) = segment(side[0], side[1], frame) else {
            finish(&mut piece, &mut pieces);
            continue;
        };
        if piece.last().is_none_or(|last| last.distance(a) > 1e-6) {
            finish(&mut piece, &mut pieces);
            piece.push(a);
        }
        piece.push(b);
        if b.distance(side[1]) > 1e-6 {
            finish(&mut piece, &mut pieces);
        }
    }
    finish(&mut piece, &mut pieces);
    pieces
}

fn finish(piece: &mut Vec<Px>, pieces: &mut Vec<Vec<Px>>) {
    if piece.len() > 1 {
        pieces.push(std::mem::take(piece));
    }
    piece.clear();
}

/// The part of a–b inside `frame` (Liang and Barsky 1984).
pub(crate) fn segment(a: Px, b: Px, frame: PxBox) -> Option<(Px, Px)> {
    if !a.is_finite() || !b.is_finite() {
        return None;
    }
    let d = b - a;
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    let edges = [
        (-d.x, a.x - frame.left),
        (d.x, frame.right() - a.x),
        (-d.y, a.y - frame.top),
        (d.y, frame.bottom() - a.y),
    ];
    for (speed, room) in edges {
        if speed.abs() < 1e-300 {
            if room < 0.0 {
                return None;
            }
        } else if speed < 0.0 {
            enter = enter.max(room / speed);
        } else {
            leave = leave.min(room / speed);
        }
    }
    // Ends inside are kept as they are, not recomputed, so that consecutive sides stay joined.
    let start = if enter > 0.0 { a + d * enter } else { a };
    let end = if leave < 1.0 { a + d * leave } else { b };
    (enter <= leave && start.is_finite() && end.is_finite()).then_some((start, end))
}

/// The part of a closed line inside `frame` (Sutherland and Hodgman 1974); empty when a corner is not finite.
pub(crate) fn polygon(corners: &[Px], frame: PxBox) -> Vec<Px> {
    if !corners.iter().all(|c| c.is_finite()) {
        return Vec::new();
    }
    let depths: [&dyn Fn(Px) -> f64; 4] = [
        &|p| p.x - frame.left,
        &|p| frame.right() - p.x,
        &|p| p.y - frame.top,
        &|p| frame.bottom() - p.y,
    ];
    depths
        .iter()
        .fold(corners.to_vec(), |left, depth| half(&left, depth))
}

/// The part of a closed line where `depth`, linear in the plane, is not negative.
fn half(corners: &[Px], depth: &dyn Fn(Px) -> f64) -> Vec<Px> {
    let mut kept = Vec::with_capacity(corners.len() + 2);
    for (k, &corner) in corners.iter().enumerate() {
        let next = corners[(k + 1) % corners.len()];
        let (here, there) = (depth(corner), depth(next));
        if here >= 0.0 {
            kept.push(corner);
        }
        if (here >= 0.0) != (there >= 0.0) {
            kept.push(corner.lerp(next, here / (here - there)));
        }
    }
    kept.retain(|c| c.is_finite());
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: PxBox = PxBox {
        left: 0.0,
        top: 0.0,
        width: 10.0,
        height: 10.0,
    };

    #[test]
    fn a_line_that_leaves_and_comes_back_is_two_pieces() {
        let points = [(5.0, 5.0), (15.0, 5.0), (15.0, 7.0), (5.0, 7.0)].map(|(x, y)| Px::new(x, y));
        let pieces = line(&points, FRAME);
        assert_eq!(
            pieces,
            [
                vec![Px::new(5.0, 5.0), Px::new(10.0, 5.0)],
                vec![Px::new(10.0, 7.0), Px::new(5.0, 7.0)],
            ]
        );
    }

    #[test]
    fn a_point_that_is_no_number_breaks_the_line() {
        let points = [
            (1.0, 1.0),
            (2.0, 1.0),
            (f64::NAN, 1.0),
            (4.0, 1.0),
            (5.0, 1.0),
            (6.0, 2.0),
        ];
        let pieces = line(&points.map(|(x, y)| Px::new(x, y)), FRAME);
        assert_eq!(pieces.iter().map(Vec::len).collect::<Vec<_>>(), [2, 3]);
    }

    #[test]
    fn a_line_across_everything_is_cut_at_both_edges() {
        let (a, b) = segment(Px::new(-1e9, 5.0), Px::new(1e9, 5.0), FRAME).unwrap();
        assert!(a.distance(Px::new(0.0, 5.0)) < 1e-5 && b.distance(Px::new(10.0, 5.0)) < 1e-5);
        assert_eq!(segment(Px::new(-1.0, 11.0), Px::new(20.0, 12.0), FRAME), None);
    }

    #[test]
    fn a_polygon_is_cut_at_the_corner_of_the_frame() {
        let corners = [(5.0, 5.0), (20.0, 5.0), (20.0, 20.0), (5.0, 20.0)].map(|(x, y)| Px::new(x, y));
        let kept = polygon(&corners, FRAME);
        let wanted = [(5.0, 5.0), (10.0, 5.0), (10.0, 10.0), (5.0, 10.0)].map(|(x, y)| Px::new(x, y));
        assert!(
            kept.len() == 4 && wanted.iter().all(|w| kept.iter().any(|k| k.distance(*w) < 1e-9)),
            "{kept:?}"
        );
    }
}
