//! Least-squares line per side, and vertices where neighbouring sides meet (paper section 3.1).
//!
//! A line n·p = d with a unit normal n. Two costs, both closed form over prefix sums, so that any run of points
//! costs O(1):
//! - range residuals, for beams from the origin: with m = n/d the beam of direction e predicts 1/(m·e), so its
//!   residual is (m·p − 1)/(m·e) ≈ r (m·p − 1), and Σ w r² (m·p − 1)² is quadratic in m;
//! - perpendicular residuals Σ w (n·p − d)², for points without a viewpoint (maps): n is the eigenvector of the
//!   smaller eigenvalue of the scatter matrix, and that eigenvalue is the cost.

use std::ops::Range;

use crate::geometry::Point;

/// The line n·p = d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    /// Unit normal n.
    pub(crate) normal: Point,
    /// Offset d along the normal, metres.
    pub(crate) offset_m: f64,
}

impl Line {
    /// Distance with sign from the line to `p`.
    pub(crate) fn distance_m(self, p: Point) -> f64 {
        self.normal.dot(p) - self.offset_m
    }

    /// The point of the line closest to `p`.
    pub(crate) fn foot(self, p: Point) -> Point {
        p - self.normal * self.distance_m(p)
    }

    /// Where the ray from the origin through `p` meets the line; `None` behind the origin or for parallels.
    pub(crate) fn on_ray_of(self, p: Point) -> Option<Point> {
        let share = self.offset_m / self.normal.dot(p);
        (share.is_finite() && share > 0.0).then(|| p * share)
    }

    /// Where two lines cross; `None` for parallels.
    pub(crate) fn cross(self, other: Self) -> Option<Point> {
        let det = self.normal.cross(other.normal);
        let p = Point::new(
            self.offset_m * other.normal.y - other.offset_m * self.normal.y,
            self.normal.x * other.offset_m - other.normal.x * self.offset_m,
        ) / det;
        (det.abs() > 1e-9 && p.is_finite()).then_some(p)
    }
}

/// Cost of a side as a function of how far the inverse ranges of its two vertices are from the measured ones (x, y):
/// at_returns + 2 (x·x + y·y) + xx·x² + 2 xy·x·y + yy·y².
#[derive(Clone, Copy, Debug)]
pub(crate) struct Side {
    /// Cost with both vertices on their returns.
    pub(crate) at_returns: f64,
    /// A lower bound of the cost.
    pub(crate) least: f64,
    /// Half the slopes.
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// Curvatures.
    pub(crate) xx: f64,
    pub(crate) xy: f64,
    pub(crate) yy: f64,
}

/// Weighted moments of a run of points.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    w: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
}

/// Prefix sums of weighted moments: a line fit to any run of points in O(1).
#[derive(Clone, Debug)]
pub(crate) struct Sums {
    prefix: Vec<Moments>,
}

impl Sums {
    /// Sums over `points` with one weight each.
    pub(crate) fn new(points: impl IntoIterator<Item = (Point, f64)>) -> Self {
        let mut total = Moments::default();
        let mut prefix = vec![total];
        for (p, w) in points {
            total.w += w;
            total.x += w * p.x;
            total.y += w * p.y;
            total.xx += w * p.x * p.x;
            total.xy += w * p.x * p.y;
            total.yy += w * p.y * p.y;
            prefix.push(total);
        }
        Self { prefix }
    }

    fn over(&self, run: &Range<usize>) -> Moments {
        let (a, b) = (self.prefix[run.start], self.prefix[run.end]);
        Moments {
            w: b.w - a.w,
            x: b.x - a.x,
            y: b.y - a.y,
            xx: b.xx - a.xx,
            xy: b.xy - a.xy,
            yy: b.yy - a.yy,
        }
    }

    /// m of the line m·p = 1 with the least Σ w (m·p − 1)², and that sum.
    fn inverse_fit(&self, run: &Range<usize>) -> Option<(Point, f64)> {
        let s = self.over(run);
        let det = s.xx * s.yy - s.xy * s.xy;
        if det <= 1e-12 * s.xx * s.yy {
            return None;
        }
        let m = Point::new(s.x * s.yy - s.y * s.xy, s.y * s.xx - s.x * s.xy) / det;
        Some((m, (s.w - m.x * s.x - m.y * s.y).max(0.0)))
    }

    /// Cost of one line through a run, for weights that hold r² (range residuals); 0 below three points.
    pub(crate) fn range_cost(&self, run: &Range<usize>) -> f64 {
        if run.len() < 3 {
            return 0.0;
        }
        self.inverse_fit(run).map_or(f64::INFINITY, |(_, cost)| cost)
    }

    /// The line of least range residuals; `None` for fewer than two points or points on one ray.
    pub(crate) fn range_line(&self, run: &Range<usize>) -> Option<Line> {
        if run.len() < 2 {
            return None;
        }
        let (m, _) = self.inverse_fit(run)?;
        let norm = m.norm();
        (norm > 1e-12).then(|| Line {
            normal: m / norm,
            offset_m: 1.0 / norm,
        })
    }

    /// Squared range residuals of a run on the line through `a` and `b`, for weights that hold r².
    pub(crate) fn chord_cost(&self, a: Point, b: Point, run: &Range<usize>) -> f64 {
        let det = a.cross(b);
        if run.is_empty() {
            return 0.0;
        }
        if det <= 1e-9 * a.norm() * b.norm() {
            return f64::INFINITY;
        }
        let m = (a - b).left() / det;
        let s = self.over(run);
        let quadratic = s.xx * m.x * m.x + 2.0 * s.xy * m.x * m.y + s.yy * m.y * m.y;
        (s.w - 2.0 * (s.x * m.x + s.y * m.y) + quadratic).max(0.0)
    }

    /// The quadratic form of a side with vertices on the rays of returns `first` and `last`, for weights that hold r².
    pub(crate) fn side(&self, first: Point, last: Point, run: &Range<usize>) -> Option<Side> {
        let (a, b) = (first.unit()?, last.unit()?);
        let sine = a.cross(b);
        if sine <= 1e-9 {
            return None;
        }
        // m = x · by_x + y · by_y for inverse ranges x, y of the two vertices.
        let (by_x, by_y) = (-b.left() / sine, a.left() / sine);
        let m = by_x / first.norm() + by_y / last.norm();
        let s = self.over(run);
        let times = |v: Point| Point::new(s.xx * v.x + s.xy * v.y, s.xy * v.x + s.yy * v.y);
        let (am, ax, ay) = (times(m), times(by_x), times(by_y));
        let sum = Point::new(s.x, s.y);
        Some(Side {
            at_returns: (s.w - 2.0 * sum.dot(m) + m.dot(am)).max(0.0),
            least: 0.0,
            x: by_x.dot(am - sum),
            y: by_y.dot(am - sum),
            xx: by_x.dot(ax),
            xy: by_x.dot(ay),
            yy: by_y.dot(ay),
        })
    }

    /// Cost of one line through a run by perpendicular residuals; 0 below three points.
    pub(crate) fn perpendicular_cost(&self, run: &Range<usize>) -> f64 {
        if run.len() < 3 {
            return 0.0;
        }
        let (_, a, b, c) = self.scatter(run);
        let half = 0.5 * (a - c);
        (0.5 * (a + c) - (half * half + b * b).sqrt()).max(0.0)
    }

    /// The line of least perpendicular residuals; `None` when all points are one.
    pub(crate) fn perpendicular_line(&self, run: &Range<usize>) -> Option<Line> {
        let (mean, a, b, c) = self.scatter(run);
        if run.len() < 2 || a + c <= 1e-12 * self.over(run).w {
            return None;
        }
        let theta_rad = 0.5 * (2.0 * b).atan2(a - c);
        let normal = Point::from_polar(1.0, theta_rad).left();
        Some(Line {
            normal,
            offset_m: normal.dot(mean),
        })
    }

    /// Mean and scatter matrix (xx, xy, yy) of a run.
    fn scatter(&self, run: &Range<usize>) -> (Point, f64, f64, f64) {
        let s = self.over(run);
        let mean = Point::new(s.x, s.y) / s.w.max(f64::MIN_POSITIVE);
        (
            mean,
            s.xx - s.x * mean.x,
            s.xy - s.x * mean.y,
            s.yy - s.y * mean.y,
        )
    }
}
