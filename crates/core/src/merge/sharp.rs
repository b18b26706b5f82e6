//! Proper order (paper section 4): vertices with a sharp inner angle are taken out.

use super::growing_map::Vertex;
use crate::geometry::Point;

/// Whether the inner angle at `v` between its neighbours is below the one whose tangent is `tan`.
fn is_sharp(u: Point, v: Point, w: Point, tan: f64) -> bool {
    let (a, b) = (u - v, w - v);
    // The same as |atan2(a × b, a · b)| < angle for angles below 90°, without the arc tangent.
    a.cross(b).abs() < tan * a.dot(b)
}

/// Removes vertices with an inner angle below `angle_rad` until none is left: the polyline then runs in one
/// direction along what it stands for. One pass with a look back does what the paper's recursion does.
pub(crate) fn without_sharp_vertices(vertices: Vec<Vertex>, angle_rad: f64) -> Vec<Vertex> {
    let tan = angle_rad.tan();
    let mut out: Vec<Vertex> = Vec::with_capacity(vertices.len());
    for vertex in vertices {
        while out.len() >= 2
            && is_sharp(
                out[out.len() - 2].point,
                out[out.len() - 1].point,
                vertex.point,
                tan,
            )
        {
            out.pop();
        }
        if out
            .last()
            .is_none_or(|last| last.point.distance(vertex.point) > 1e-6)
        {
            out.push(vertex);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_goes_and_a_corner_stays() {
        let points = [
            (0.0, 0.0),
            (1.0, 0.0),
            (1.0, 2.0),
            (1.01, 0.0),
            (2.0, 0.0),
            (2.0, 1.0),
        ];
        let vertices = points
            .iter()
            .map(|&(x, y)| Vertex::new(Point::new(x, y), 0))
            .collect();
        let left: Vec<(f64, f64)> = without_sharp_vertices(vertices, 20_f64.to_radians())
            .iter()
            .map(|v| (v.point.x, v.point.y))
            .collect();
        assert_eq!(
            left,
            [(0.0, 0.0), (1.0, 0.0), (1.01, 0.0), (2.0, 0.0), (2.0, 1.0)]
        );
    }

    #[test]
    fn a_polyline_that_doubles_back_is_cut_to_one_direction() {
        let points = [(0.0, 0.0), (1.0, 0.0), (0.9, 0.01), (0.8, 0.0), (2.0, 0.0)];
        let vertices = points
            .iter()
            .map(|&(x, y)| Vertex::new(Point::new(x, y), 0))
            .collect();
        let left = without_sharp_vertices(vertices, 20_f64.to_radians());
        assert!(left.windows(2).all(|w| w[1].point.x > w[0].point.x), "{left:?}");
    }
}
