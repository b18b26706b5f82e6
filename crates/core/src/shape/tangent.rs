//! Tangent space: direction of a polyline as a step function of arc length, and the arc measure S_a.
//!
//! `S_a(C, D) = (1 + (l_C − l_D)²) · min_Θ ∫₀¹ (T_C(s) − T_D(s) + Θ)² ds`, arc lengths scaled to 0..1.
//! The best Θ is minus the mean of T_C − T_D, so the minimum is its variance over arc length and needs no
//! search. Lengths are metres: 1 + Δl² depends on the unit, and at a metre of difference the cost doubles.

use std::f64::consts::PI;

use super::Part;
use crate::geometry::{Point, Polyline, wrap_rad};

/// Direction over arc length. Directions are unwrapped: each differs from the one before by the turn at the
/// vertex between them, in (−π, π], so that no jump of a full turn occurs however far a polyline winds.
#[derive(Clone, Debug, PartialEq)]
pub struct TangentFunction {
    ends_m: Vec<f64>,
    directions_rad: Vec<f64>,
}

impl TangentFunction {
    /// The tangent function of a polyline; `None` if it has no length.
    #[must_use]
    pub fn new(polyline: &Polyline) -> Option<Self> {
        Self::of_vertices(polyline.vertices())
    }

    pub(super) fn of_vertices(vertices: &[Point]) -> Option<Self> {
        let mut ends_m = Vec::with_capacity(vertices.len());
        let mut directions_rad: Vec<f64> = Vec::with_capacity(vertices.len());
        let mut end_m = 0.0;
        for w in vertices.windows(2) {
            let side = w[1] - w[0];
            if side.unit().is_none() {
                continue;
            }
            end_m += side.norm();
            let bearing_rad = side.bearing_rad();
            let unwrapped_rad = match directions_rad.last() {
                Some(&last_rad) => last_rad + wrap_rad(bearing_rad - last_rad),
                None => bearing_rad,
            };
            ends_m.push(end_m);
            directions_rad.push(unwrapped_rad);
        }
        (!ends_m.is_empty()).then_some(Self {
            ends_m,
            directions_rad,
        })
    }

    /// Arc length, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.ends_m.last().copied().unwrap_or(0.0)
    }

    /// Number of sides that have a length.
    #[must_use]
    pub fn sides(&self) -> usize {
        self.ends_m.len()
    }

    /// Stretch of arc length that side `side` covers.
    #[must_use]
    pub fn side(&self, side: usize) -> Option<Part> {
        let to_m = *self.ends_m.get(side)?;
        Some(Part::new(self.vertex_m(side), to_m))
    }

    /// Arc length at vertex `vertex`, metres (vertices of sides without length are not counted).
    #[must_use]
    pub fn vertex_m(&self, vertex: usize) -> f64 {
        match vertex.checked_sub(1) {
            Some(side) => self.ends_m.get(side).copied().unwrap_or_else(|| self.length_m()),
            None => 0.0,
        }
    }

    /// Unwrapped direction of side `side`, radians.
    #[must_use]
    pub fn direction_rad(&self, side: usize) -> f64 {
        self.directions_rad[side.min(self.directions_rad.len() - 1)]
    }

    /// Turn at vertex `vertex` between side `vertex − 1` and side `vertex`, in (−π, π], left positive.
    #[must_use]
    pub fn turn_rad(&self, vertex: usize) -> f64 {
        if vertex == 0 || vertex >= self.sides() {
            return 0.0;
        }
        self.directions_rad[vertex] - self.directions_rad[vertex - 1]
    }

    /// The side on which the arc length `s_m` lies (the later one at a vertex).
    #[must_use]
    pub fn side_at(&self, s_m: f64) -> usize {
        self.ends_m
            .partition_point(|&end| end <= s_m)
            .min(self.sides() - 1)
    }
}

/// A stretch on which both parts are straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonStretch {
    /// Share of either part, 0..1, where it starts.
    pub from: f64,
    /// Share where it ends.
    pub to: f64,
    /// Side of the first shape.
    pub c_side: usize,
    /// Side of the second shape.
    pub d_side: usize,
}

/// Walks two parts side by side, both scaled to 0..1, and gives every stretch on which both are straight.
pub fn common_stretches(
    c: &TangentFunction,
    c_part: Part,
    d: &TangentFunction,
    d_part: Part,
    mut visit: impl FnMut(CommonStretch),
) {
    let (lc_m, ld_m) = (c_part.length_m(), d_part.length_m());
    if lc_m <= 0.0 || ld_m <= 0.0 {
        return;
    }
    let (mut c_side, mut d_side) = (c.side_at(c_part.from_m), d.side_at(d_part.from_m));
    let mut from = 0.0;
    while from < 1.0 {
        let c_end = ends_at_share(c, c_side, c_part, lc_m);
        let d_end = ends_at_share(d, d_side, d_part, ld_m);
        let to = c_end.min(d_end);
        if to > from {
            visit(CommonStretch {
                from,
                to,
                c_side,
                d_side,
            });
        }
        if to >= 1.0 {
            return;
        }
        if c_end <= to {
            c_side += 1;
        }
        if d_end <= to {
            d_side += 1;
        }
        from = from.max(to);
    }
}

/// Share of the part at which a side ends; 1 on the part's last side, whatever rounding says.
fn ends_at_share(t: &TangentFunction, side: usize, part: Part, length_m: f64) -> f64 {
    if side + 1 >= t.sides() || t.ends_m[side] >= part.to_m {
        1.0
    } else {
        (t.ends_m[side] - part.from_m) / length_m
    }
}

/// `min_Θ ∫₀¹ (T_C − T_D + Θ)² ds` of two parts, rad²: the variance of the difference of directions.
///
/// 0 for parts without length.
#[must_use]
pub fn turning_variance_rad2(c: &TangentFunction, c_part: Part, d: &TangentFunction, d_part: Part) -> f64 {
    let on_one_side = |t: &TangentFunction, p: Part| t.ends_m[t.side_at(p.from_m)] >= p.to_m;
    if on_one_side(c, c_part) && on_one_side(d, d_part) {
        return 0.0;
    }
    let mut first_rad = None;
    let (mut mean, mut square) = (0.0, 0.0);
    common_stretches(c, c_part, d, d_part, |s| {
        let difference_rad = c.direction_rad(s.c_side) - d.direction_rad(s.d_side);
        // Counted from the first one, so that the subtraction below loses no digits.
        let x = difference_rad - *first_rad.get_or_insert(difference_rad);
        mean += (s.to - s.from) * x;
        square += (s.to - s.from) * x * x;
    });
    (square - mean * mean).clamp(0.0, (4.0 * PI) * (4.0 * PI))
}

/// S_a of two parts with the length weight: mean length · (1 + Δl²) · variance, in m·rad².
#[must_use]
pub fn arc_dissimilarity(c: &TangentFunction, c_part: Part, d: &TangentFunction, d_part: Part) -> f64 {
    let (lc_m, ld_m) = (c_part.length_m(), d_part.length_m());
    let longer_m = lc_m - ld_m;
    0.5 * (lc_m + ld_m) * (1.0 + longer_m * longer_m) * turning_variance_rad2(c, c_part, d, d_part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tangent(points: &[(f64, f64)]) -> TangentFunction {
        TangentFunction::of_vertices(&points.iter().map(|&(x, y)| Point::new(x, y)).collect::<Vec<_>>())
            .unwrap()
    }

    fn whole(t: &TangentFunction) -> Part {
        Part::new(0.0, t.length_m())
    }

    /// The definition taken literally: midpoints, and a search for Θ.
    fn naive_variance(c: &TangentFunction, cp: Part, d: &TangentFunction, dp: Part) -> f64 {
        let n = 20_000;
        let difference = |k: i32| {
            let s = (f64::from(k) + 0.5) / f64::from(n);
            let at = |t: &TangentFunction, p: Part| t.direction_rad(t.side_at(p.from_m + s * p.length_m()));
            at(c, cp) - at(d, dp)
        };
        let differences: Vec<f64> = (0..n).map(difference).collect();
        let integral =
            |theta: f64| differences.iter().map(|x| (x + theta).powi(2)).sum::<f64>() / f64::from(n);
        let (mut low, mut high) = (-20.0, 20.0);
        for _ in 0..200 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if integral(a) < integral(b) {
                high = b;
            } else {
                low = a;
            }
        }
        integral(0.5 * (low + high))
    }

    #[test]
    fn the_closed_form_is_the_definition() {
        let step = tangent(&[(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (2.0, 0.9)]);
        let corner = tangent(&[(0.0, 0.0), (0.3, 1.0), (-1.0, 1.2)]);
        let spiral = tangent(&[
            (0., 0.),
            (3., 0.),
            (3., 3.),
            (0., 3.),
            (0., 1.),
            (2., 1.),
            (2., 2.),
            (1., 2.),
        ]);
        for (c, d) in [(&step, &corner), (&corner, &spiral), (&spiral, &step)] {
            for (cp, dp) in [
                (whole(c), whole(d)),
                (Part::new(0.2, c.length_m() - 0.3), Part::new(0.1, 1.3)),
            ] {
                let (closed, naive) = (turning_variance_rad2(c, cp, d, dp), naive_variance(c, cp, d, dp));
                assert!((closed - naive).abs() < 2e-3 * (1.0 + naive), "{closed} {naive}");
            }
        }
    }

    #[test]
    fn the_same_shape_elsewhere_costs_nothing() {
        let corner = Polyline::new(vec![
            Point::new(0.0, 0.0),
            Point::new(2.0, 0.1),
            Point::new(2.1, 3.0),
        ])
        .unwrap();
        for k in 0..8 {
            // Some of these turn a side across ±180°, where a bearing jumps.
            let pose = crate::geometry::Pose::new(1.0, -2.0, f64::from(k) * 0.8);
            let (a, b) = (
                TangentFunction::new(&corner).unwrap(),
                TangentFunction::new(&corner.transformed(pose)).unwrap(),
            );
            assert!(arc_dissimilarity(&a, whole(&a), &b, whole(&b)) < 1e-12);
        }
    }

    #[test]
    fn a_corner_against_a_wall_costs_a_quarter_of_its_turn_squared() {
        let corner = tangent(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)]);
        let wall = tangent(&[(0.0, 0.0), (2.0, 0.0)]);
        let cost = arc_dissimilarity(&corner, whole(&corner), &wall, whole(&wall));
        // Two metres, a difference of 0 on one half and of 90° on the other.
        assert!((cost - 2.0 * (PI / 4.0).powi(2)).abs() < 1e-12, "{cost}");
        let longer = tangent(&[(0.0, 0.0), (3.0, 0.0)]);
        let dearer = arc_dissimilarity(&corner, whole(&corner), &longer, whole(&longer));
        assert!(
            (dearer - 2.5 * 2.0 * (PI / 4.0).powi(2)).abs() < 1e-12,
            "{dearer}"
        );
    }
}
