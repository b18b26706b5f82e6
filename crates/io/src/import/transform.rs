//! Affine maps of the plane, as SVG's `transform` attribute writes them (SVG 1.1, section 7.6).

use polymapper_core::geometry::Point;

/// (x, y) ↦ (a x + c y + e, b x + d y + f).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
    f: f64,
}

impl Transform {
    pub const IDENTITY: Self = Self::new([1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);

    pub const fn new([a, b, c, d, e, f]: [f64; 6]) -> Self {
        Self { a, b, c, d, e, f }
    }

    /// The map that takes `origin` to (0, 0), `x` to (1, 0) and `y` to (0, 1); `None` where they lie on a line.
    pub fn to_frame(origin: Point, x: Point, y: Point) -> Option<Self> {
        let (u, v) = (x - origin, y - origin);
        let area = u.x * v.y - u.y * v.x;
        if !(area.is_finite() && area.abs() > 1e-12 * u.norm() * v.norm()) {
            return None;
        }
        let linear = Self::new([v.y / area, -u.y / area, -v.x / area, u.x / area, 0.0, 0.0]);
        let shift = linear.of(origin);
        Some(Self {
            e: -shift.x,
            f: -shift.y,
            ..linear
        })
    }

    pub fn of(self, p: Point) -> Point {
        Point::new(
            self.a * p.x + self.c * p.y + self.e,
            self.b * p.x + self.d * p.y + self.f,
        )
    }

    /// First `inner`, then this.
    pub fn after(self, inner: Self) -> Self {
        let shift = self.of(Point::new(inner.e, inner.f));
        Self {
            a: self.a * inner.a + self.c * inner.b,
            b: self.b * inner.a + self.d * inner.b,
            c: self.a * inner.c + self.c * inner.d,
            d: self.b * inner.c + self.d * inner.d,
            e: shift.x,
            f: shift.y,
        }
    }

    /// How much longer the longest vector can get.
    pub fn stretch(self) -> f64 {
        self.a.hypot(self.b).max(self.c.hypot(self.d))
    }

    /// Reads a list such as `translate(3 4) rotate(30)`.
    ///
    /// # Errors
    /// A function that is not known, numbers that are none or too few.
    pub fn parse(text: &str) -> Result<Self, String> {
        let fault = || {
            format!(
                "transform \"{}\" is not understood",
                text.chars().take(60).collect::<String>()
            )
        };
        let mut whole = Self::IDENTITY;
        let mut rest = text.trim_start_matches([',', ' ', '\t', '\r', '\n']);
        while !rest.is_empty() {
            let (name, tail) = rest.split_once('(').ok_or_else(fault)?;
            let (numbers, tail) = tail.split_once(')').ok_or_else(fault)?;
            let numbers: Result<Vec<f64>, _> = numbers
                .split([',', ' ', '\t', '\r', '\n'])
                .filter(|n| !n.is_empty())
                .map(str::parse)
                .collect();
            let numbers = numbers.map_err(|_| fault())?;
            whole = whole.after(Self::function(name.trim(), &numbers).ok_or_else(fault)?);
            rest = tail.trim_start_matches([',', ' ', '\t', '\r', '\n']);
        }
        Ok(whole)
    }

    fn function(name: &str, numbers: &[f64]) -> Option<Self> {
        let turn = |angle_deg: f64| {
            let (sin, cos) = angle_deg.to_radians().sin_cos();
            Self::new([cos, sin, -sin, cos, 0.0, 0.0])
        };
        let shift = |x, y| Self::new([1.0, 0.0, 0.0, 1.0, x, y]);
        Some(match (name, numbers) {
            ("matrix", &[a, b, c, d, e, f]) => Self::new([a, b, c, d, e, f]),
            ("translate", &[x]) => shift(x, 0.0),
            ("translate", &[x, y]) => shift(x, y),
            ("scale", &[k]) => Self::new([k, 0.0, 0.0, k, 0.0, 0.0]),
            ("scale", &[x, y]) => Self::new([x, 0.0, 0.0, y, 0.0, 0.0]),
            ("rotate", &[angle]) => turn(angle),
            ("rotate", &[angle, x, y]) => shift(x, y).after(turn(angle)).after(shift(-x, -y)),
            ("skewX", &[angle]) => Self::new([1.0, 0.0, angle.to_radians().tan(), 1.0, 0.0, 0.0]),
            ("skewY", &[angle]) => Self::new([1.0, angle.to_radians().tan(), 0.0, 1.0, 0.0, 0.0]),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_apply_from_the_right() {
        let t = Transform::parse("translate(10, 0) rotate(90) scale(2)").unwrap();
        assert!(t.of(Point::new(1.0, 0.0)).distance(Point::new(10.0, 2.0)) < 1e-12);
        let about = Transform::parse("rotate(180 5 5)").unwrap();
        assert!(about.of(Point::new(4.0, 5.0)).distance(Point::new(6.0, 5.0)) < 1e-12);
    }

    #[test]
    fn a_frame_is_found_wherever_it_was_moved() {
        let moved = Transform::parse("matrix(0.5 0.1 0.3 -2 7 -9)").unwrap();
        let at = |x, y| moved.of(Point::new(x, y));
        let back = Transform::to_frame(at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0)).unwrap();
        assert!(back.of(at(-3.0, 40.0)).distance(Point::new(-3.0, 40.0)) < 1e-9);
        assert_eq!(
            Transform::to_frame(at(0.0, 0.0), at(1.0, 0.0), at(2.0, 0.0)),
            None
        );
    }

    #[test]
    fn what_is_no_transform_is_told() {
        for wrong in [
            "turn(3)",
            "rotate(1,2)",
            "scale(x)",
            "translate(1",
            "matrix(1 2 3)",
        ] {
            assert!(Transform::parse(wrong).is_err(), "{wrong}");
        }
    }
}
