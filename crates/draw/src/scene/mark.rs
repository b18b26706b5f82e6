//! Marks, in layers: lines, areas, dots, circles, rectangles, labels, and how they are drawn.

use polymapper_core::geometry::Point;

use crate::bounds::Bounds;
use crate::colour::Colour;

/// Marks under one name; a layer of its own in Inkscape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// Drawn in order.
    pub marks: Vec<Mark>,
}

impl Layer {
    /// An empty layer.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            marks: Vec::new(),
        }
    }

    /// Adds a line through `points`.
    pub fn line(&mut self, points: impl IntoIterator<Item = Point>, stroke: Stroke) {
        self.marks.push(Mark::Line {
            points: points.into_iter().collect(),
            stroke,
        });
    }

    /// Adds dots.
    pub fn dots(&mut self, points: impl IntoIterator<Item = Point>, radius_px: f64, colour: Colour) {
        self.marks.push(Mark::Dots {
            points: points.into_iter().collect(),
            radius_px,
            colour,
        });
    }

    /// Adds a disc of `radius_px` with a rim.
    pub fn marker(&mut self, centre: Point, radius_px: f64, fill: Colour, stroke: Stroke) {
        self.marks.push(Mark::Circle {
            centre,
            radius: Radius::Px(radius_px),
            fill: Some(Fill::Flat(fill, 1.0)),
            stroke: Some(stroke),
        });
    }
}

/// Something drawn. Points that are not finite are left out; a line breaks there.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// An open line through points.
    Line {
        /// In order.
        points: Vec<Point>,
        /// How it is drawn.
        stroke: Stroke,
    },
    /// The inside of a closed line, filled; nothing when a corner is not finite.
    Polygon {
        /// In order, the first not repeated.
        corners: Vec<Point>,
        /// Colour of the inside.
        colour: Colour,
    },
    /// A cloud of points, thinned to what a pixel can show.
    Dots {
        /// In any order.
        points: Vec<Point>,
        /// Radius of a dot, px.
        radius_px: f64,
        /// Colour of a dot.
        colour: Colour,
    },
    /// A circle or disc.
    Circle {
        /// Its centre.
        centre: Point,
        /// Its size.
        radius: Radius,
        /// Its inside, if any.
        fill: Option<Fill>,
        /// Its rim, if any.
        stroke: Option<Stroke>,
    },
    /// A rectangle with sides parallel to the axes.
    Rectangle {
        /// Its corners.
        bounds: Bounds,
        /// Its inside, if any.
        fill: Option<Fill>,
        /// Its rim, if any.
        stroke: Option<Stroke>,
    },
    /// Text.
    Label(Label),
}

impl Mark {
    /// The points that the mark's extent depends on, finite or not.
    pub(super) fn extreme_points(&self) -> Vec<Point> {
        match self {
            Self::Line { points, .. } | Self::Dots { points, .. } | Self::Polygon { corners: points, .. } => {
                points.clone()
            }
            Self::Circle {
                centre,
                radius: Radius::Px(_),
                ..
            } => vec![*centre],
            Self::Circle {
                centre,
                radius: Radius::Metres(r),
                ..
            } => {
                let reach = Point::new(r.abs(), r.abs());
                vec![*centre - reach, *centre + reach]
            }
            Self::Rectangle { bounds, .. } => vec![bounds.min, bounds.max],
            Self::Label(label) => vec![label.at],
        }
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width, px.
    pub width_px: f64,
    /// Solid or broken.
    pub dash: Dash,
    /// 0 (unseen) to 1.
    pub opacity: f64,
    /// Whether its end carries an arrow head.
    pub arrow: bool,
    /// Whether its ends are cut off flat instead of round.
    pub flat: bool,
}

impl Stroke {
    /// A solid line.
    #[must_use]
    pub const fn new(colour: Colour, width_px: f64) -> Self {
        Self {
            colour,
            width_px,
            dash: Dash::Solid,
            opacity: 1.0,
            arrow: false,
            flat: false,
        }
    }

    /// The same, broken.
    #[must_use]
    pub const fn dash(mut self, dash: Dash) -> Self {
        self.dash = dash;
        self
    }

    /// The same with ends cut off flat.
    #[must_use]
    pub const fn with_flat_ends(mut self) -> Self {
        self.flat = true;
        self
    }

    /// The same with an arrow head at its end.
    #[must_use]
    pub const fn with_arrow(mut self) -> Self {
        self.arrow = true;
        self
    }
}

/// How a line is broken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dash {
    /// Not at all.
    #[default]
    Solid,
    /// Dashes of four widths.
    Dashed,
    /// Round dots.
    Dotted,
}

/// What fills a rectangle or circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fill {
    /// A flat colour with an opacity of 0 to 1.
    Flat(Colour, f64),
    /// Oblique lines in this colour over a veil of white.
    Hatched(Colour),
}

/// Radius of a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// Pixels of the page: a marker.
    Px(f64),
    /// Metres: a thing in the world.
    Metres(f64),
}

/// Text at a place of the world. It moves aside for other labels and lines, and stays near.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// What it names.
    pub at: Point,
    /// The text.
    pub text: String,
    /// Set after the text, lower and smaller; empty for none.
    pub subscript: String,
    /// Its colour.
    pub colour: Colour,
    /// Upright, bold or italic.
    pub face: Face,
    /// Where it should stand as seen from `at` (any length); above when `None`.
    pub side: Option<Point>,
}

/// Cut of the letters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Face {
    /// Upright.
    #[default]
    Regular,
    /// Heavy.
    Bold,
    /// Slanted; for variables.
    Italic,
}
