//! The plate: a picture in pixels, y down, ready to be written. Every coordinate is finite.

use polymapper_core::geometry::Point;

use crate::colour::Colour;
use crate::scene::Face;

/// A place on the plate, pixels, y down.
pub(crate) type Px = Point;

/// A rectangle of the plate, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PxBox {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl PxBox {
    pub fn right(self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(self) -> f64 {
        self.top + self.height
    }

    pub fn grown(self, by: f64) -> Self {
        Self {
            left: self.left - by,
            top: self.top - by,
            width: self.width + 2.0 * by,
            height: self.height + 2.0 * by,
        }
    }

    pub fn contains(self, p: Px) -> bool {
        p.x >= self.left && p.x <= self.right() && p.y >= self.top && p.y <= self.bottom()
    }

    /// Area in common, px².
    pub fn overlap(self, other: Self) -> f64 {
        let width = self.right().min(other.right()) - self.left.max(other.left);
        let height = self.bottom().min(other.bottom()) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
}

/// How a line is drawn, pixels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pen {
    pub colour: Colour,
    pub width: f64,
    /// Lengths of dash and gap in turn; empty for a solid line.
    pub dashes: Vec<f64>,
    pub opacity: f64,
    /// Flat ends instead of round ones.
    pub butt: bool,
}

/// What fills an area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ink {
    pub colour: Colour,
    pub opacity: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
}

/// One line of text; `x`, `y` is the start or middle of its base line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Text {
    pub x: f64,
    pub y: f64,
    pub size: f64,
    pub anchor: Anchor,
    pub colour: Colour,
    pub face: Face,
    pub text: String,
    /// Set after the text, lower and smaller.
    pub subscript: String,
    /// A white rim, for text over lines.
    pub halo: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Item {
    /// Open lines drawn with one pen, each a thing of its own.
    Lines {
        lines: Vec<Vec<Px>>,
        pen: Pen,
    },
    /// Open lines that are one thing: a grid, a hatching.
    Raster {
        lines: Vec<Vec<Px>>,
        pen: Pen,
    },
    /// A closed area.
    Area {
        corners: Vec<Px>,
        fill: Option<Ink>,
        pen: Option<Pen>,
    },
    /// Dots of one size.
    Dots {
        centres: Vec<Px>,
        radius: f64,
        colour: Colour,
    },
    Circle {
        centre: Px,
        radius: f64,
        fill: Option<Ink>,
        pen: Option<Pen>,
    },
    Text(Text),
}

/// A named layer of items.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlateLayer {
    pub name: String,
    pub items: Vec<Item>,
}

/// A panel: its layers, and how its pixels are metres.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlatePanel {
    pub name: String,
    /// Metres a pixel; x_m = x0_m + x · this and y_m = y0_m − y · this.
    pub metres_per_px: f64,
    /// Map x at plate x = 0, metres.
    pub x0_m: f64,
    /// Map y at plate y = 0, metres.
    pub y0_m: f64,
    pub layers: Vec<PlateLayer>,
}

/// The whole picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plate {
    pub width: f64,
    pub height: f64,
    pub title: String,
    pub panels: Vec<PlatePanel>,
    /// Title and caption of the page.
    pub page: Vec<Item>,
}
