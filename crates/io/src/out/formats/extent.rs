//! Corners and extents of what is drawn.

use polymapper_core::geometry::Point;
use polymapper_core::map::{EraserBox, Map};

/// The corners of a box, counter-clockwise from the lower left.
pub(super) fn corners(b: &EraserBox) -> [Point; 4] {
    [
        b.min,
        Point::new(b.max.x, b.min.y),
        b.max,
        Point::new(b.min.x, b.max.y),
    ]
}

/// All vertices of a map.
pub(super) fn vertices(map: &Map) -> impl Iterator<Item = Point> {
    map.polylines.iter().flat_map(|p| &p.vertices).map(|v| v.point)
}

/// All vertices of a map, and the corners of its eraser boxes that tell their extent.
pub(super) fn drawn(map: &Map) -> impl Iterator<Item = Point> {
    let boxes = map.eraser_boxes.iter().flat_map(|b| [b.min, b.max]);
    vertices(map).chain(boxes)
}

/// The least box around points: its lower left and upper right corner, once there is a point.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extent(pub Option<[Point; 2]>);

impl Extent {
    /// Of `points`.
    pub fn of(points: impl IntoIterator<Item = Point>) -> Self {
        let mut extent = Self::default();
        points.into_iter().for_each(|p| extent.take(p));
        extent
    }

    /// Takes in another point.
    pub fn take(&mut self, p: Point) {
        let [min, max] = self.0.unwrap_or([p, p]);
        self.0 = Some([
            Point::new(min.x.min(p.x), min.y.min(p.y)),
            Point::new(max.x.max(p.x), max.y.max(p.y)),
        ]);
    }
}
