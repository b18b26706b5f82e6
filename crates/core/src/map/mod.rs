//! The polygonal map: what a build leaves behind.

mod axes;

use crate::geometry::{Point, Polyline};

pub use axes::dominant_direction_rad;

/// A vertex of the map and what it rests on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapVertex {
    /// Place in the map frame, metres.
    pub point: Point,
    /// How many observations were averaged into it.
    pub observations: u32,
    /// Standard deviation of its place across the wall, metres.
    pub sigma_m: f64,
}

/// A polyline of the map: a wall or an object, free space on its left.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPolyline {
    /// Name that stays with the polyline while the map grows.
    pub id: u64,
    /// Two vertices or more, in order.
    pub vertices: Vec<MapVertex>,
}

impl MapPolyline {
    /// Its shape alone; `None` for a polyline with fewer than two finite vertices.
    #[must_use]
    pub fn polyline(&self) -> Option<Polyline> {
        Polyline::new(self.vertices.iter().map(|v| v.point).collect()).ok()
    }
}

/// A box around something without a stable shape (plants, nets; paper section 4). Sides parallel to the map axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EraserBox {
    /// Corner with the smaller coordinates, metres.
    pub min: Point,
    /// Corner with the larger coordinates, metres.
    pub max: Point,
}

impl EraserBox {
    /// Whether the point lies in the box.
    #[must_use]
    pub fn contains(&self, p: Point) -> bool {
        (self.min.x..=self.max.x).contains(&p.x) && (self.min.y..=self.max.y).contains(&p.y)
    }

    /// Whether the boxes have a point in common.
    #[must_use]
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.x <= other.max.x
            && other.min.x <= self.max.x
            && self.min.y <= other.max.y
            && other.min.y <= self.max.y
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn joined(&self, other: &Self) -> Self {
        Self {
            min: Point::new(self.min.x.min(other.min.x), self.min.y.min(other.min.y)),
            max: Point::new(self.max.x.max(other.max.x), self.max.y.max(other.max.y)),
        }
    }
}

/// Walls and objects as polylines, and boxes around what has no stable shape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// Walls and objects.
    pub polylines: Vec<MapPolyline>,
    /// Where the shape changes from scan to scan; disjoint.
    pub eraser_boxes: Vec<EraserBox>,
}
