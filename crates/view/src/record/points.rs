//! Lists of points as whole millimetres: the first point, then differences. Small as text, smaller packed.

use polymapper_core::geometry::{Point, Polyline};

/// `[x, y, dx, dy, ..]`, millimetres.
pub type Chain = Vec<i64>;

/// Points, rounded to millimetres; the sum of differences is the rounded point, so that errors do not add up.
pub fn chain(points: impl IntoIterator<Item = Point>) -> Chain {
    let mut out = Vec::new();
    let mut last = (0, 0);
    for point in points {
        let now = (millimetres(point.x), millimetres(point.y));
        out.extend([now.0 - last.0, now.1 - last.1]);
        last = now;
    }
    out
}

/// The polyline of a chain; `None` for one with fewer than two points.
#[must_use]
pub fn polyline(chain: &[i64]) -> Option<Polyline> {
    let mut at = (0_i64, 0_i64);
    let points = chain.chunks_exact(2).map(|d| {
        at = (at.0.saturating_add(d[0]), at.1.saturating_add(d[1]));
        Point::new(at.0 as f64 / 1e3, at.1 as f64 / 1e3)
    });
    Polyline::new(points.collect()).ok()
}

/// Saturates at the ends of the number range; not a number is 0.
pub(super) fn millimetres(metres: f64) -> i64 {
    (metres * 1e3).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_errors_do_not_add_up() {
        let points: Vec<Point> = (0..1000)
            .map(|k| Point::new(0.0014 * f64::from(k), -1.0))
            .collect();
        let back = polyline(&chain(points.iter().copied())).unwrap();
        for (a, b) in points.iter().zip(back.vertices()) {
            assert!(a.distance(*b) < 0.0008);
        }
    }

    #[test]
    fn no_numbers_make_a_chain_panic() {
        assert!(polyline(&[i64::MAX, i64::MIN, i64::MAX, i64::MIN]).is_some());
        assert_eq!(polyline(&[1, 2]), None);
        assert_eq!(chain([Point::new(f64::NAN, f64::INFINITY)]), [0, i64::MAX]);
    }
}
