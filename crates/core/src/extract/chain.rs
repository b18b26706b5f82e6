//! A chain of weighted points → a few vertices: the final pass over a map (paper section 4, last paragraph).
//!
//! The same division into sides and the same least-squares fit as for scans, with perpendicular residuals, because a
//! map has no viewpoint. End points are kept.

use super::divide::divide;
use super::fit::Sums;
use super::sides::join;
use crate::geometry::Point;

/// The vertices of the polyline that explains a chain of points best.
///
/// `weights` are inverse variances of the points across the wall, 1/m² (missing ones count as 1); a side is added when
/// it saves more than `side_penalty` in Σ weight · distance² (see [`super::ExtractSettings::side_penalty`]). The first and
/// the last vertex are the first and the last point. Chains of fewer than three points come back as they are.
#[must_use]
pub fn simplify_chain(points: &[Point], weights: &[f64], side_penalty: f64) -> Vec<Point> {
    let n = points.len();
    if n < 3 {
        return points.to_vec();
    }
    let origin = points[0];
    let local: Vec<Point> = points.iter().map(|&p| p - origin).collect();
    let weight = |k: usize| weights.get(k).copied().unwrap_or(1.0);
    let sums = Sums::new(local.iter().enumerate().map(|(k, &p)| (p, weight(k))));
    let sides = divide(n, side_penalty, |run| sums.perpendicular_cost(run));
    let mut vertices = join(
        &local,
        &sides,
        |run| sums.perpendicular_line(run),
        |line, p| line.foot(p),
    );
    if let (Some(first), Some(last)) = (local.first(), local.last()) {
        let end = vertices.len() - 1;
        vertices[0] = *first;
        vertices[end] = *last;
    }
    vertices.into_iter().map(|p| p + origin).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_noisy_corner_far_from_the_origin_has_three_vertices() {
        let wobble = |k: i32| 0.004 * f64::from((k * 7) % 5 - 2);
        let mut points: Vec<Point> = (0..40)
            .map(|k| Point::new(f64::from(k) * 0.05, wobble(k)))
            .collect();
        points.extend((1..40).map(|k| Point::new(1.95 + wobble(k), f64::from(k) * 0.05)));
        let far = Point::new(500.0, -300.0);
        let points: Vec<Point> = points.into_iter().map(|p| p + far).collect();
        let vertices = simplify_chain(&points, &vec![1.0 / (0.005 * 0.005); points.len()], 16.0);
        assert_eq!(vertices.len(), 3, "{vertices:?}");
        assert!(
            vertices[1].distance(far + Point::new(1.95, 0.0)) < 0.01,
            "{vertices:?}"
        );
        assert_eq!((vertices[0], vertices[2]), (points[0], points[points.len() - 1]));
    }
}
