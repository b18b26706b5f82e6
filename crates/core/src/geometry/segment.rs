use super::Point;

/// A straight side from `a` to `b`; free space lies on its left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Where the side starts.
    pub a: Point,
    /// Where it ends.
    pub b: Point,
}

impl Segment {
    /// The side from `a` to `b`.
    #[must_use]
    pub const fn new(a: Point, b: Point) -> Self {
        Self { a, b }
    }

    /// Length in metres.
    #[must_use]
    pub fn length_m(self) -> f64 {
        self.a.distance(self.b)
    }

    /// Unit vector from `a` to `b`; `None` for a side of no length.
    #[must_use]
    pub fn direction(self) -> Option<Point> {
        (self.b - self.a).unit()
    }

    /// The point at share `t` of the side.
    #[must_use]
    pub fn at(self, t: f64) -> Point {
        self.a.lerp(self.b, t)
    }

    /// Share in 0..=1 of the point of the side that is closest to `p`.
    #[must_use]
    pub fn closest_share(self, p: Point) -> f64 {
        let d = self.b - self.a;
        let l2 = d.dot(d);
        if l2 <= 0.0 {
            0.0
        } else {
            ((p - self.a).dot(d) / l2).clamp(0.0, 1.0)
        }
    }

    /// Distance from `p` to the side, metres.
    #[must_use]
    pub fn distance(self, p: Point) -> f64 {
        self.at(self.closest_share(p)).distance(p)
    }

    /// Where the ray `origin + t · direction`, t > 0, meets the side: (t, share of the side).
    ///
    /// `direction` need not have length 1; t is in units of its length. A side parallel to the ray is not met.
    #[must_use]
    pub fn meet_ray(self, origin: Point, direction: Point) -> Option<(f64, f64)> {
        let side = self.b - self.a;
        let det = direction.cross(side);
        if det.abs() < 1e-12 {
            return None;
        }
        let to_a = self.a - origin;
        // Most sides that are asked are not met: that is known without dividing.
        let along = to_a.cross(direction);
        let is_on_side = if det > 0.0 {
            (0.0..=det).contains(&along)
        } else {
            (det..=0.0).contains(&along)
        };
        if !is_on_side {
            return None;
        }
        let t = to_a.cross(side) / det;
        (t > 0.0).then(|| (t, along / det))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_the_wall_ahead_and_not_the_one_behind() {
        let wall = Segment::new(Point::new(2.0, -1.0), Point::new(2.0, 1.0));
        let (t, share) = wall.meet_ray(Point::default(), Point::new(1.0, 0.0)).unwrap();
        assert!((t - 2.0).abs() < 1e-12 && (share - 0.5).abs() < 1e-12);
        assert_eq!(wall.meet_ray(Point::default(), Point::new(-1.0, 0.0)), None);
        assert_eq!(
            wall.meet_ray(Point::default(), Point::new(0.0, 1.0)),
            None,
            "parallel"
        );
    }

    #[test]
    fn the_closest_point_stays_on_the_side() {
        let wall = Segment::new(Point::new(0.0, 0.0), Point::new(2.0, 0.0));
        assert!((wall.distance(Point::new(1.0, 0.5)) - 0.5).abs() < 1e-12);
        assert!((wall.distance(Point::new(3.0, 0.0)) - 1.0).abs() < 1e-12);
    }
}
