//! What is to be drawn: panels of layers of marks, in metres, y up.
//!
//! Lengths called `_px` (line widths, dots, text) are pixels of a page whose longest side is
//! [`Scene::PAGE_PX`]; they shrink and grow with [`Scene::longest_side_px`], so that a picture looks the same
//! at every size.

mod mark;

use crate::bounds::Bounds;

pub use mark::{Dash, Face, Fill, Label, Layer, Mark, Radius, Stroke};

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
