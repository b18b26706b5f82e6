//! What goes with a plot: grid, scale bar, legend.

use super::view::View;
use super::{ink, pen_of};
use crate::colour::palette;
use crate::font;
use crate::plate::{Anchor, Item, Pen, Px, PxBox, Text};
use crate::round;
use crate::scene::{Face, Grid, LegendEntry, Sample, Scene};

/// Distance of the grid lines of a view, metres; `None` for no grid.
pub(super) fn grid_step_m(grid: Grid, view: &View, unit: f64) -> Option<f64> {
    let least_m = 12.0 * unit * view.metres_per_px;
    match grid {
        Grid::None => None,
        Grid::Auto => Some(round::at_least_m(100.0 * unit * view.metres_per_px)),
        Grid::Every(step_m) if step_m > 0.0 && step_m.is_finite() => Some(if step_m >= least_m {
            step_m
        } else {
            step_m * round::at_least_m(least_m / step_m)
        }),
        Grid::Every(_) => None,
    }
}

/// Grid lines at whole multiples of `step_m`.
pub(super) fn grid(step_m: f64, view: &View, unit: f64) -> Item {
    let frame = view.frame;
    let multiples = |from_m: f64, to_m: f64| {
        let first = (from_m / step_m).ceil();
        let lines = ((to_m / step_m).floor() - first).clamp(-1.0, 500.0) as i32;
        (0..=lines).map(move |k| (first + f64::from(k)) * step_m)
    };
    let upright = multiples(view.world.min.x, view.world.max.x).map(|x_m| {
        let x = view.px(Px::new(x_m, 0.0)).x;
        vec![Px::new(x, frame.top), Px::new(x, frame.bottom())]
    });
    let level = multiples(view.world.min.y, view.world.max.y).map(|y_m| {
        let y = view.px(Px::new(0.0, y_m)).y;
        vec![Px::new(frame.left, y), Px::new(frame.right(), y)]
    });
    let lines = upright
        .chain(level)
        .filter(|line| line.iter().all(|p| p.is_finite()))
        .collect();
    Item::Raster {
        lines,
        pen: hairline(palette::GRID, 1.6 * unit),
    }
}

/// The frame round a plot.
pub(super) fn frame(frame: PxBox, unit: f64) -> Item {
    let corners = vec![
        Px::new(frame.left, frame.top),
        Px::new(frame.right(), frame.top),
        Px::new(frame.right(), frame.bottom()),
        Px::new(frame.left, frame.bottom()),
    ];
    Item::Area {
        corners,
        fill: None,
        pen: Some(hairline(palette::PALE, 1.5 * unit)),
    }
}

fn hairline(colour: crate::colour::Colour, width: f64) -> Pen {
    Pen {
        colour,
        width,
        dashes: Vec::new(),
        opacity: 1.0,
        butt: true,
    }
}

/// One thing in the strip below a plot.
pub(super) enum Cell<'a> {
    /// Scale bar and grid distance.
    Scale { metres_per_px: f64, grid_m: Option<f64> },
    /// A legend entry.
    Entry(&'a LegendEntry),
}

const GAP: f64 = 44.0;
const SAMPLE_WIDTH: f64 = 54.0;
const TEXT_GAP: f64 = 12.0;

/// Sizes of the strip: everything in px of the page times `unit`.
pub(super) struct Strip {
    pub unit: f64,
    pub text_size: f64,
    pub width: f64,
}

impl Strip {
    pub fn row_height(&self) -> f64 {
        1.55 * self.text_size
    }

    /// Height of the cells flowed into rows.
    pub fn height(&self, cells: &[Cell<'_>]) -> f64 {
        self.rows(cells)
            .last()
            .map_or(0.0, |(row, _)| f64::from(row + 1) * self.row_height())
    }

    /// Row and left edge of each cell.
    fn rows(&self, cells: &[Cell<'_>]) -> Vec<(u32, f64)> {
        let (mut row, mut left) = (0, 0.0);
        let mut places = Vec::with_capacity(cells.len());
        for cell in cells {
            let width = self.cell_width(cell);
            if left > 0.0 && left + width > self.width {
                (row, left) = (row + 1, 0.0);
            }
            places.push((row, left));
            left += width + GAP * self.unit;
        }
        places
    }

    fn text_width(&self, text: &str) -> f64 {
        self.text_size * font::width(text, Face::Regular)
    }

    fn cell_width(&self, cell: &Cell<'_>) -> f64 {
        match cell {
            Cell::Scale {
                metres_per_px,
                grid_m,
            } => {
                let (bar_m, said) = self.bar(*metres_per_px, *grid_m);
                bar_m / metres_per_px + TEXT_GAP * self.unit + self.text_width(&said)
            }
            Cell::Entry(entry) => (SAMPLE_WIDTH + TEXT_GAP) * self.unit + self.text_width(&entry.text),
        }
    }

    /// Length of the scale bar, about a fifth of the plot, and what stands beside it.
    fn bar(&self, metres_per_px: f64, grid_m: Option<f64>) -> (f64, String) {
        let room_px = (0.28 * self.width).min(0.22 * Scene::PAGE_PX * self.unit);
        let bar_m = round::at_most_m(room_px * metres_per_px);
        let grid = grid_m.map_or(String::new(), |step| format!(" · grid {}", round::spoken(step)));
        (bar_m, round::spoken(bar_m) + &grid)
    }

    /// Draws the cells with the strip's upper left corner at (x, y).
    pub fn draw(&self, cells: &[Cell<'_>], x: f64, y: f64) -> Vec<Item> {
        let mut items = Vec::new();
        for (cell, (row, left)) in cells.iter().zip(self.rows(cells)) {
            let at = Px::new(x + left, y + f64::from(row) * self.row_height());
            match cell {
                Cell::Scale {
                    metres_per_px,
                    grid_m,
                } => {
                    let (bar_m, said) = self.bar(*metres_per_px, *grid_m);
                    let length = bar_m / metres_per_px;
                    items.extend(self.scale_bar(bar_m, length, at));
                    items.push(self.text(said, at.x + length + TEXT_GAP * self.unit, at.y));
                }
                Cell::Entry(entry) => {
                    items.extend(self.sample(&entry.sample, at));
                    let left = at.x + (SAMPLE_WIDTH + TEXT_GAP) * self.unit;
                    items.push(self.text(entry.text.clone(), left, at.y));
                }
            }
        }
        items
    }

    fn text(&self, text: String, x: f64, top: f64) -> Item {
        Item::Text(Text {
            x,
            y: top + self.text_size,
            size: self.text_size,
            anchor: Anchor::Start,
            colour: palette::INK,
            face: Face::Regular,
            text,
            subscript: String::new(),
            halo: false,
        })
    }

    /// Middle of the small letters of a row.
    fn middle(&self, top: f64) -> f64 {
        top + 0.66 * self.text_size
    }

    /// Black and white blocks, as on printed maps: four for 2, 20, …; five for 1, 5, 10, ….
    fn scale_bar(&self, bar_m: f64, length: f64, at: Px) -> Vec<Item> {
        let leading = (bar_m / 10f64.powf((bar_m.log10() + 1e-9).floor())).round();
        let blocks = if (leading - 2.0).abs() < 0.1 { 4 } else { 5 };
        let (block, height) = (length / f64::from(blocks), 8.0 * self.unit);
        let top = self.middle(at.y) - 0.5 * height;
        let rectangle = |from: f64, to: f64| {
            vec![
                Px::new(at.x + from, top),
                Px::new(at.x + to, top),
                Px::new(at.x + to, top + height),
                Px::new(at.x + from, top + height),
            ]
        };
        let mut items = vec![Item::Area {
            corners: rectangle(0.0, length),
            fill: Some(ink(palette::WHITE, 1.0)),
            pen: Some(hairline(palette::INK, 1.5 * self.unit)),
        }];
        items.extend((0..blocks).step_by(2).map(|k| Item::Area {
            corners: rectangle(f64::from(k) * block, f64::from(k + 1) * block),
            fill: Some(ink(palette::INK, 1.0)),
            pen: None,
        }));
        items
    }

    fn sample(&self, sample: &Sample, at: Px) -> Vec<Item> {
        let width = SAMPLE_WIDTH * self.unit;
        let middle = self.middle(at.y);
        match sample {
            Sample::Line(stroke) => vec![Item::Lines {
                lines: vec![vec![Px::new(at.x, middle), Px::new(at.x + width, middle)]],
                pen: pen_of(stroke, self.unit),
            }],
            Sample::Area(fill, stroke) => {
                let height = 0.8 * self.text_size;
                let patch = PxBox {
                    left: at.x,
                    top: middle - 0.5 * height,
                    width,
                    height,
                };
                super::marks::rectangle(patch, fill.as_ref(), stroke.as_ref(), patch, self.unit)
            }
            Sample::Circle(radius, fill, stroke) => {
                let centre = Px::new(at.x + width - radius * self.unit, middle);
                vec![super::marks::disc(
                    centre,
                    radius * self.unit,
                    fill.as_ref(),
                    stroke.as_ref(),
                    self.unit,
                )]
            }
        }
    }
}
