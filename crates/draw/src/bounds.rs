use polymapper_core::geometry::Point;

/// A rectangle of the map frame, metres, sides parallel to the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Corner with the smaller coordinates.
    pub min: Point,
    /// Corner with the larger coordinates.
    pub max: Point,
}

impl Bounds {
    /// The smallest rectangle round the finite ones of `points`; `None` when there are none.
    #[must_use]
    pub fn of(points: impl IntoIterator<Item = Point>) -> Option<Self> {
        points
            .into_iter()
            .filter(|p| p.is_finite())
            .fold(None, |bounds: Option<Self>, p| {
                Some(bounds.map_or(Self { min: p, max: p }, |b| b.with(p)))
            })
    }

    /// As [`Bounds::of`], but a few points far from all others do not blow it up.
    ///
    /// The box of the middle 99 % in x and in y is grown by its half on every side; when all points together
    /// need at most twice that box, all of them are inside. So a normal scene loses nothing and a stray
    /// return at 80 m, or a polyline put at 10⁶ m, does not turn the rest into a dot.
    #[must_use]
    pub fn robust(points: &[Point]) -> Option<Self> {
        let all = Self::of(points.iter().copied())?;
        let core = Self::middle(points)?;
        let size_m = core.width_m().max(core.height_m());
        if size_m <= 0.0 {
            return Some(all);
        }
        let wide = core.grown(0.5 * size_m);
        let fits = all.width_m() <= 2.0 * wide.width_m() && all.height_m() <= 2.0 * wide.height_m();
        Some(if fits { all } else { all.common(wide) })
    }

    fn middle(points: &[Point]) -> Option<Self> {
        let (x0, x1) = middle_of(points.iter().filter(|p| p.is_finite()).map(|p| p.x).collect())?;
        let (y0, y1) = middle_of(points.iter().filter(|p| p.is_finite()).map(|p| p.y).collect())?;
        Some(Self {
            min: Point::new(x0, y0),
            max: Point::new(x1, y1),
        })
    }

    fn with(self, p: Point) -> Self {
        Self {
            min: Point::new(self.min.x.min(p.x), self.min.y.min(p.y)),
            max: Point::new(self.max.x.max(p.x), self.max.y.max(p.y)),
        }
    }

    fn common(self, other: Self) -> Self {
        Self {
            min: Point::new(self.min.x.max(other.min.x), self.min.y.max(other.min.y)),
            max: Point::new(self.max.x.min(other.max.x), self.max.y.min(other.max.y)),
        }
    }

    /// The rectangle round both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        self.with(other.min).with(other.max)
    }

    /// The rectangle with `by_m` more on each side.
    #[must_use]
    pub fn grown(self, by_m: f64) -> Self {
        let by = Point::new(by_m, by_m);
        Self {
            min: self.min - by,
            max: self.max + by,
        }
    }

    /// Whether `p` lies inside or on the edge.
    #[must_use]
    pub fn contains(self, p: Point) -> bool {
        p.x >= self.min.x && p.x <= self.max.x && p.y >= self.min.y && p.y <= self.max.y
    }

    /// Length along x, metres.
    #[must_use]
    pub fn width_m(self) -> f64 {
        self.max.x - self.min.x
    }

    /// Length along y, metres.
    #[must_use]
    pub fn height_m(self) -> f64 {
        self.max.y - self.min.y
    }

    /// The middle.
    #[must_use]
    pub fn centre(self) -> Point {
        self.min.lerp(self.max, 0.5)
    }
}

/// Smallest and largest of the values without the outermost half per cent on each side.
fn middle_of(mut values: Vec<f64>) -> Option<(f64, f64)> {
    let out = values.len() / 200;
    let last = values.len().checked_sub(1 + out)?;
    let (_, low, _) = values.select_nth_unstable_by(out, f64::total_cmp);
    let low = *low;
    let (_, high, _) = values.select_nth_unstable_by(last, f64::total_cmp);
    Some((low, *high))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn room() -> Vec<Point> {
        (0..1000)
            .map(|k| Point::new(f64::from(k % 10), f64::from(k / 10) * 0.05))
            .collect()
    }

    #[test]
    fn a_room_keeps_all_its_points() {
        let points = room();
        assert_eq!(Bounds::robust(&points), Bounds::of(points));
    }

    #[test]
    fn a_stray_point_does_not_shrink_the_room_to_a_dot() {
        let mut points = room();
        points.push(Point::new(1e6, -1e6));
        points.push(Point::new(f64::NAN, 0.0));
        let bounds = Bounds::robust(&points).unwrap();
        assert!(bounds.width_m() < 30.0 && bounds.height_m() < 30.0, "{bounds:?}");
        assert!(bounds.contains(Point::new(9.0, 4.95)));
    }

    #[test]
    fn nothing_has_no_bounds() {
        assert_eq!(Bounds::robust(&[Point::new(f64::INFINITY, 0.0)]), None);
    }
}
