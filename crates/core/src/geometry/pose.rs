use std::ops::Mul;

use super::{Point, wrap_rad};

/// A rigid motion of the plane, SE(2): turn by `theta_rad`, then shift by (x, y).
///
/// As `a_from_b` it gives the place of frame b in frame a, and `a_from_b * p`
/// is the point p of frame b seen in frame a.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Shift along x, metres.
    pub x: f64,
    /// Shift along y, metres.
    pub y: f64,
    /// Turn, radians, counter-clockwise.
    pub theta_rad: f64,
}

impl Pose {
    /// A share of a small motion: within 0.1 m and 0.1 rad the way is straight to 1 mm.
    #[must_use]
    pub fn scaled(self, share: f64) -> Self {
        Self::new(share * self.x, share * self.y, share * self.theta_rad)
    }

    /// The motion that moves nothing.
    pub const IDENTITY: Self = Self {
        x: 0.0,
        y: 0.0,
        theta_rad: 0.0,
    };

    /// The pose at (x, y) metres with heading `theta_rad`, wrapped into (−π, π].
    #[must_use]
    pub fn new(x: f64, y: f64, theta_rad: f64) -> Self {
        Self {
            x,
            y,
            theta_rad: wrap_rad(theta_rad),
        }
    }

    /// Where the origin goes.
    #[must_use]
    pub fn translation(self) -> Point {
        Point::new(self.x, self.y)
    }

    /// Whether another pose is nearer than `reach_m`, metres, and turned by less than `reach_rad`, radians.
    #[must_use]
    pub fn is_within(self, reach_m: f64, reach_rad: f64, other: Self) -> bool {
        self.distance(other) < reach_m && wrap_rad(self.theta_rad - other.theta_rad).abs() < reach_rad
    }

    /// The motion that undoes this one: `b_from_a` of `a_from_b`.
    #[must_use]
    pub fn inverse(self) -> Self {
        let (sin, cos) = self.theta_rad.sin_cos();
        Self::new(
            -cos * self.x - sin * self.y,
            sin * self.x - cos * self.y,
            -self.theta_rad,
        )
    }

    /// The vector `v` turned, not shifted.
    #[must_use]
    pub fn rotate(self, v: Point) -> Point {
        self.isometry().rotate(v)
    }

    /// The same motion with sine and cosine taken, for many points.
    #[must_use]
    pub fn isometry(self) -> Isometry {
        let (sin, cos) = self.theta_rad.sin_cos();
        Isometry {
            ahead: Point::new(cos, sin),
            shift: self.translation(),
        }
    }

    /// Points of frame b seen in frame a.
    pub fn transform<'a>(self, points: impl IntoIterator<Item = &'a Point>) -> impl Iterator<Item = Point> {
        let a_from_b = self.isometry();
        points.into_iter().map(move |&p| a_from_b * p)
    }

    /// Distance between the origins of two poses, metres.
    #[must_use]
    pub fn distance(self, other: Self) -> f64 {
        self.translation().distance(other.translation())
    }
}

impl Mul for Pose {
    type Output = Self;
    /// `a_from_b * b_from_c = a_from_c`.
    fn mul(self, b_from_c: Self) -> Self {
        let shift = self * b_from_c.translation();
        Self::new(shift.x, shift.y, self.theta_rad + b_from_c.theta_rad)
    }
}

impl Mul<Point> for Pose {
    type Output = Point;
    fn mul(self, p: Point) -> Point {
        self.isometry() * p
    }
}

/// A rigid motion of the plane that is asked for many points: see [`Pose::isometry`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Isometry {
    /// Unit vector along the x axis of frame b, frame a.
    ahead: Point,
    /// Origin of frame b, frame a, metres.
    shift: Point,
}

impl Isometry {
    /// The vector `v` turned, not shifted.
    #[must_use]
    pub fn rotate(&self, v: Point) -> Point {
        let Point { x: cos, y: sin } = self.ahead;
        Point::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
    }

    /// Where the origin goes.
    #[must_use]
    pub fn translation(&self) -> Point {
        self.shift
    }
}

impl Mul<Point> for Isometry {
    type Output = Point;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "a motion turns, then shifts")]
    fn mul(self, p: Point) -> Point {
        self.rotate(p) + self.shift
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Pose = Pose {
        x: 1.0,
        y: -2.0,
        theta_rad: 2.5,
    };
    const B: Pose = Pose {
        x: -0.3,
        y: 4.0,
        theta_rad: -1.9,
    };

    fn assert_same(a: Pose, b: Pose) {
        assert!(
            a.distance(b) < 1e-12 && wrap_rad(a.theta_rad - b.theta_rad).abs() < 1e-12,
            "{a:?} {b:?}"
        );
    }

    #[test]
    fn poses_form_a_group() {
        let c = Pose::new(0.2, 0.7, 3.0);
        assert_same(A * A.inverse(), Pose::IDENTITY);
        assert_same(A.inverse() * A, Pose::IDENTITY);
        assert_same((A * B) * c, A * (B * c));
        assert_same((A * B).inverse(), B.inverse() * A.inverse());
    }

    #[test]
    fn composing_poses_is_moving_points_twice() {
        let p = Point::new(0.4, -1.1);
        assert!(((A * B) * p).distance(A * (B * p)) < 1e-12);
        let all: Vec<Point> = A.transform(&[p]).collect();
        assert!(all[0].distance(A * p) < 1e-12);
    }

    #[test]
    fn a_scan_turned_left_sees_its_left_behind_the_y_axis() {
        let map_from_scan = Pose::new(2.0, 0.0, std::f64::consts::FRAC_PI_2);
        let ahead = map_from_scan * Point::new(1.0, 0.0);
        assert!(ahead.distance(Point::new(2.0, 1.0)) < 1e-12);
    }
}
