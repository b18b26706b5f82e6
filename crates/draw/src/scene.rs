//! What is to be drawn: panels of layers of marks, in metres, y up.
//!
//! Lengths called `_px` (line widths, dots, text) are pixels of a page whose longest side is
//! [`Scene::PAGE_PX`]; they shrink and grow with [`Scene::longest_side_px`], so that a picture looks the same
//! at every size.

use polymapper_core::geometry::Point;

use crate::bounds::Bounds;
use crate::colour::Colour;

/// A picture: panels side by side, a title above and a caption below.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Above everything; empty for none.
    pub title: String,
    /// Below everything, broken into lines; empty for none.
    pub caption: String,
    /// Drawn in reading order.
    pub panels: Vec<Panel>,
    /// Width or height of the picture, whichever is larger, pixels; held within 400..=2400.
    pub longest_side_px: f64,
    /// Whether the panels have one scale.
    pub scale: ScaleRule,
}

/// How the scales of several panels go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScaleRule {
    /// All panels show the same rectangle of the world.
    SameView,
    /// All panels have the same scale, each centred on its content, as long as the largest content is at most
    /// 1.6 times the smallest; otherwise each has its own.
    SameScaleIfAlike,
    /// Each panel is filled by its content.
    Own,
}

/// One plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Above the plot; empty for none. Panels of a scene with several get (a), (b), … in front.
    pub title: String,
    /// Drawn in order, the last on top.
    pub layers: Vec<Layer>,
    /// Which part of the world is shown.
    pub extent: Extent,
    /// Lines behind everything.
    pub grid: Grid,
    /// What the marks mean, below the plot.
    pub legend: Vec<LegendEntry>,
    /// Said in the middle of a plot in which there is nothing to draw.
    pub when_empty: String,
    /// Whether a thin frame goes round the plot.
    pub frame: bool,
}

/// Which part of the world a panel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// All marks.
    All,
    /// All marks but a few that lie far away from all others ([`Bounds::robust`]).
    Robust,
    /// This rectangle; marks are cut at its edge.
    Fixed(Bounds),
}

/// Grid of a panel; always on whole multiples of its distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Grid {
    /// None.
    None,
    /// A round distance that gives some ten lines.
    Auto,
    /// Lines this many metres apart; a round multiple when they would lie closer than 12 px.
    Every(f64),
}

/// Marks under one name; a layer of its own in Inkscape.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layer {
    /// Its name.
    pub name: String,
    /// Drawn in order.
    pub marks: Vec<Mark>,
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

/// A line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// What is shown.
    pub sample: Sample,
    /// What it means.
    pub text: String,
}

/// The picture in front of a legend's text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sample {
    /// A short line.
    Line(Stroke),
    /// A small rectangle.
    Area(Option<Fill>, Option<Stroke>),
    /// A circle of this radius in px.
    Circle(f64, Option<Fill>, Option<Stroke>),
}

impl Scene {
    /// Longest side of the page that all `_px` lengths refer to.
    pub const PAGE_PX: f64 = 2000.0;

    /// A scene of one panel.
    #[must_use]
    pub fn of(panel: Panel) -> Self {
        Self::of_panels(vec![panel])
    }

    /// A scene of several panels that show the same rectangle of the world.
    #[must_use]
    pub fn of_panels(panels: Vec<Panel>) -> Self {
        Self {
            title: String::new(),
            caption: String::new(),
            panels,
            longest_side_px: Self::PAGE_PX,
            scale: ScaleRule::SameView,
        }
    }

    /// The same with a title.
    #[must_use]
    pub fn with_title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The same with a caption.
    #[must_use]
    pub fn with_caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// The same with another rule for scales.
    #[must_use]
    pub fn with_scale(mut self, scale: ScaleRule) -> Self {
        self.scale = scale;
        self
    }
}

impl Panel {
    /// An empty plot without grid, in a thin frame, that shows all but outliers.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            layers: Vec::new(),
            extent: Extent::Robust,
            grid: Grid::None,
            legend: Vec::new(),
            when_empty: "nothing to draw".to_owned(),
            frame: true,
        }
    }

    /// The same with a layer more, on top.
    #[must_use]
    pub fn with(mut self, layer: Layer) -> Self {
        self.layers.push(layer);
        self
    }

    /// The same with a grid.
    #[must_use]
    pub fn with_grid(mut self, grid: Grid) -> Self {
        self.grid = grid;
        self
    }

    /// The same with another extent.
    #[must_use]
    pub fn with_extent(mut self, extent: Extent) -> Self {
        self.extent = extent;
        self
    }

    /// The same with a line more in its legend.
    #[must_use]
    pub fn with_legend(mut self, sample: Sample, text: impl Into<String>) -> Self {
        self.legend.push(LegendEntry {
            sample,
            text: text.into(),
        });
        self
    }

    /// The rectangle of the world that its content asks for; `None` when there is nothing finite to draw.
    #[must_use]
    pub fn bounds(&self) -> Option<Bounds> {
        let points = || {
            self.layers
                .iter()
                .flat_map(|l| &l.marks)
                .flat_map(Mark::extreme_points)
        };
        match self.extent {
            Extent::All => Bounds::of(points()),
            Extent::Robust => Bounds::robust(&points().collect::<Vec<_>>()),
            Extent::Fixed(bounds) => Bounds::of([bounds.min, bounds.max]),
        }
    }
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

impl Mark {
    /// The points that the mark's extent depends on, finite or not.
    fn extreme_points(&self) -> Vec<Point> {
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
