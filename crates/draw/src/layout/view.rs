use polymapper_core::geometry::Point;

use crate::bounds::Bounds;
use crate::plate::{Px, PxBox};

/// How a rectangle of the world lies on the plate.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// What is seen in the frame, metres.
    pub world: Bounds,
    /// Where it is seen.
    pub frame: PxBox,
    pub metres_per_px: f64,
}

impl View {
    /// Shows `content` as large as `frame` allows, in its middle.
    pub fn fit(content: Bounds, frame: PxBox) -> Self {
        let metres_per_px = (content.width_m() / frame.width).max(content.height_m() / frame.height);
        let half = Point::new(frame.width, frame.height) * (0.5 * metres_per_px);
        let centre = content.centre();
        Self {
            world: Bounds {
                min: centre - half,
                max: centre + half,
            },
            frame,
            metres_per_px,
        }
    }

    /// The pixel of a point of the world.
    pub fn px(&self, p: Point) -> Px {
        Px::new(
            self.frame.left + (p.x - self.world.min.x) / self.metres_per_px,
            self.frame.top + (self.world.max.y - p.y) / self.metres_per_px,
        )
    }

    /// The point of the world at pixel (0, 0).
    pub fn origin(&self) -> Point {
        Point::new(
            self.world.min.x - self.frame.left * self.metres_per_px,
            self.world.max.y + self.frame.top * self.metres_per_px,
        )
    }
}
