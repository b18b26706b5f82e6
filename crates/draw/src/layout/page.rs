//! The page: how large the panels are, where they stand, and what is written round them.

use polymapper_core::geometry::Point;

use super::furniture::{self, Cell, Strip};
use super::marks::Marks;
use super::view::View;
use crate::bounds::Bounds;
use crate::colour::{Colour, palette};
use crate::font;
use crate::plate::{Anchor, Item, Plate, PlateLayer, PlatePanel, PxBox, Text};
use crate::scene::{Face, Layer, Panel, ScaleRule, Scene};

/// Sizes in px of a page of [`Scene::PAGE_PX`].
const MARGIN: f64 = 44.0;
const GAP: f64 = 44.0;
const TEXT: f64 = 30.0;
const TITLE: f64 = 38.0;
const LINE: f64 = 1.38;
const LEAST_PAGE_WIDTH: f64 = 1040.0;
const LEAST_PANEL_WIDTH: f64 = 430.0;
const LEAST_PANEL_HEIGHT: f64 = 90.0;
const MOST_CAPTION_LINES: usize = 12;

/// Lays a scene out.
pub(crate) fn plate(scene: &Scene) -> Plate {
    let page = Page::new(scene);
    let most_columns = scene.panels.len().clamp(1, 12);
    let best = (1..=most_columns)
        .map(|columns| page.arrange(columns))
        .reduce(|best, next| {
            if page.worth(&next) > 1.02 * page.worth(&best) {
                next
            } else {
                best
            }
        });
    best.map_or_else(|| page.empty(), |arrangement| page.draw(&arrangement))
}

struct Page<'a> {
    scene: &'a Scene,
    longest: f64,
    unit: f64,
    /// What each panel shows; `None` where there is nothing.
    views: Vec<Option<Bounds>>,
    /// Height of a plot over its width.
    aspect: f64,
    one_scale: bool,
}

/// Sizes for one number of columns.
struct Arrangement {
    columns: usize,
    panel_width: f64,
    panel_height: f64,
    page_width: f64,
}

impl<'a> Page<'a> {
    fn new(scene: &'a Scene) -> Self {
        let asked = scene.longest_side_px;
        let longest = if asked.is_finite() {
            asked.clamp(400.0, 2400.0)
        } else {
            Scene::PAGE_PX
        };
        let (views, one_scale) = views(scene);
        Self {
            scene,
            longest,
            unit: longest / Scene::PAGE_PX,
            aspect: aspect(&views),
            views,
            one_scale,
        }
    }

    fn empty(&self) -> Plate {
        Plate {
            width: self.longest,
            height: self.longest,
            title: self.scene.title.clone(),
            panels: Vec::new(),
            page: Vec::new(),
        }
    }

    fn text_size(&self) -> f64 {
        TEXT * self.unit
    }

    fn rows(&self, columns: usize) -> usize {
        self.scene.panels.len().div_ceil(columns)
    }

    /// Area of a panel, times the share of the cells of the page that hold one: a page with holes is a poor page.
    fn worth(&self, arrangement: &Arrangement) -> f64 {
        let columns = arrangement.columns;
        let filled = self.scene.panels.len() as f64 / (columns * self.rows(columns)).max(1) as f64;
        arrangement.panel_width * arrangement.panel_height * filled
    }

    /// The largest panels in `columns` columns that keep the page within its longest side. Text needs more
    /// rows in narrower panels, so the height is found by going down a few times.
    fn arrange(&self, columns: usize) -> Arrangement {
        let unit = self.unit;
        let inner = self.longest - 2.0 * MARGIN * unit;
        let mut panel_width = (inner - (columns - 1) as f64 * GAP * unit) / columns as f64;
        let mut panel_height = panel_width * self.aspect;
        let mut page_width = self.longest;
        for _ in 0..4 {
            let room = self.longest - self.fixed_height(columns, panel_width, page_width);
            let most = (room / self.rows(columns).max(1) as f64).max(LEAST_PANEL_HEIGHT * unit);
            panel_height = panel_height.min(most);
            panel_width = panel_width.min((panel_height / self.aspect).max(LEAST_PANEL_WIDTH * unit));
            let used = columns as f64 * panel_width + ((columns - 1) as f64 * GAP + 2.0 * MARGIN) * unit;
            page_width = used.max(LEAST_PAGE_WIDTH * unit);
        }
        Arrangement {
            columns,
            panel_width,
            panel_height,
            page_width,
        }
    }

    fn fixed_height(&self, columns: usize, panel_width: f64, page_width: f64) -> f64 {
        let rows = (0..self.rows(columns)).map(|row| {
            self.heading_height(row, columns, panel_width)
                + self.strip_height(row, columns, panel_width)
                + GAP * self.unit
        });
        2.0 * MARGIN * self.unit + self.title_height() + self.caption_height(page_width) + rows.sum::<f64>()
            - GAP * self.unit
    }

    fn title_height(&self) -> f64 {
        if self.scene.title.is_empty() {
            0.0
        } else {
            1.5 * TITLE * self.unit
        }
    }

    fn caption_lines(&self, page_width: f64) -> Vec<String> {
        let width_em = (page_width - 2.0 * MARGIN * self.unit) / self.text_size();
        font::wrap(&self.scene.caption, Face::Regular, width_em, MOST_CAPTION_LINES)
    }

    fn caption_height(&self, page_width: f64) -> f64 {
        let lines = self.caption_lines(page_width).len() as f64;
        if lines > 0.0 {
            (lines * LINE + 0.5) * self.text_size()
        } else {
            0.0
        }
    }

    fn panels_of_row(&self, row: usize, columns: usize) -> impl Iterator<Item = (usize, &'a Panel)> {
        self.scene
            .panels
            .iter()
            .enumerate()
            .skip(row * columns)
            .take(columns)
    }

    /// The letter of a panel and the lines of its title.
    fn heading(&self, k: usize, panel: &Panel, panel_width: f64) -> (String, Vec<String>) {
        let letter = if self.scene.panels.len() > 1 {
            letter(k)
        } else {
            String::new()
        };
        let text = if letter.is_empty() {
            panel.title.clone()
        } else {
            format!("{letter} {}", panel.title)
        };
        // A little narrower, for the bold letter is wider than the one that is measured.
        let width_em = panel_width / self.text_size() - 0.6;
        (letter, font::wrap(&text, Face::Regular, width_em, 3))
    }

    fn heading_height(&self, row: usize, columns: usize, panel_width: f64) -> f64 {
        let lines = self
            .panels_of_row(row, columns)
            .map(|(k, p)| self.heading(k, p, panel_width).1.len());
        let lines = lines.max().unwrap_or(0) as f64;
        if lines > 0.0 {
            (lines * LINE + 0.1) * self.text_size()
        } else {
            0.0
        }
    }

    fn strip(&self, panel_width: f64) -> Strip {
        Strip {
            unit: self.unit,
            text_size: 0.93 * self.text_size(),
            width: panel_width,
        }
    }

    /// Where panels have one scale, the bar stands below the first of the last row only.
    fn cells(&self, k: usize, columns: usize, view: Option<&View>) -> Vec<Cell<'a>> {
        let panel = &self.scene.panels[k];
        let first_of_last_row = (self.rows(columns) - 1) * columns;
        let bar_carrier = self
            .views
            .iter()
            .skip(first_of_last_row)
            .position(Option::is_some);
        let wanted = !self.one_scale || bar_carrier.is_none_or(|n| k == first_of_last_row + n);
        let scale = view.filter(|_| wanted).map(|view| Cell::Scale {
            metres_per_px: view.metres_per_px,
            grid_m: furniture::grid_step_m(panel.grid, view, self.unit),
        });
        scale
            .into_iter()
            .chain(panel.legend.iter().map(Cell::Entry))
            .collect()
    }

    fn strip_height(&self, row: usize, columns: usize, panel_width: f64) -> f64 {
        let frame = PxBox {
            left: 0.0,
            top: 0.0,
            width: panel_width,
            height: panel_width * self.aspect,
        };
        let strip = self.strip(panel_width);
        let heights = self.panels_of_row(row, columns).map(|(k, _)| {
            let view = self.views[k].map(|content| View::fit(content, frame));
            strip.height(&self.cells(k, columns, view.as_ref()))
        });
        let height = heights.fold(0.0, f64::max);
        if height > 0.0 {
            height + 0.5 * self.text_size()
        } else {
            0.0
        }
    }

    fn draw(&self, arrangement: &Arrangement) -> Plate {
        let Arrangement {
            columns,
            panel_width,
            panel_height,
            page_width,
        } = *arrangement;
        let (unit, margin) = (self.unit, MARGIN * self.unit);
        let mut page = Vec::new();
        let mut top = margin;
        if !self.scene.title.is_empty() {
            page.push(text(
                &self.scene.title,
                Face::Bold,
                TITLE * unit,
                margin,
                top + TITLE * unit,
            ));
            top += self.title_height();
        }
        let used = columns as f64 * panel_width + (columns - 1) as f64 * GAP * unit;
        let left = 0.5 * (page_width - used);
        let mut panels = Vec::new();
        for row in 0..self.rows(columns) {
            let plot_top = top + self.heading_height(row, columns, panel_width);
            for (k, panel) in self.panels_of_row(row, columns) {
                let column = (k - row * columns) as f64;
                let frame = PxBox {
                    left: left + column * (panel_width + GAP * unit),
                    top: plot_top,
                    width: panel_width,
                    height: panel_height,
                };
                panels.push(self.panel(k, panel, columns, frame, top));
            }
            top = plot_top + panel_height + self.strip_height(row, columns, panel_width) + GAP * unit;
        }
        top -= GAP * unit;
        let size = self.text_size();
        for (k, line) in self.caption_lines(page_width).iter().enumerate() {
            page.push(text(
                line,
                Face::Regular,
                size,
                margin,
                top + (0.5 + k as f64 * LINE + 1.0) * size,
            ));
        }
        let height = top + self.caption_height(page_width) + margin;
        Plate {
            width: page_width.ceil(),
            height: height.ceil(),
            title: self.scene.title.clone(),
            panels,
            page,
        }
    }

    fn panel(&self, k: usize, panel: &Panel, columns: usize, frame: PxBox, top: f64) -> PlatePanel {
        let view = self.views[k].map(|content| View::fit(content, frame));
        let mut layers = view
            .as_ref()
            .map_or_else(Vec::new, |view| self.layers(panel, view));
        if panel.frame {
            layers.push(PlateLayer {
                name: "frame".to_owned(),
                items: vec![furniture::frame(frame, self.unit)],
            });
        }
        let mut words = self.heading_items(k, panel, frame, top);
        if view.is_none() {
            words.push(self.note(&panel.when_empty, frame));
        }
        let strip_top = frame.bottom() + 0.4 * self.text_size();
        let cells = self.cells(k, columns, view.as_ref());
        words.extend(self.strip(frame.width).draw(&cells, frame.left, strip_top));
        layers.push(PlateLayer {
            name: "scale and legend".to_owned(),
            items: words,
        });
        let origin = view.map_or(Point::default(), |v| v.origin());
        PlatePanel {
            name: self.name(k, panel),
            metres_per_px: view.map_or(0.0, |v| v.metres_per_px),
            x0_m: origin.x,
            y0_m: origin.y,
            layers,
        }
    }

    fn name(&self, k: usize, panel: &Panel) -> String {
        match (self.scene.panels.len(), panel.title.as_str()) {
            (1, "") => "plot".to_owned(),
            (1, title) => title.to_owned(),
            (_, title) => format!("{} {title}", letter(k)),
        }
    }

    fn layers(&self, panel: &Panel, view: &View) -> Vec<PlateLayer> {
        let mut marks = Marks::new(view, self.unit);
        let mut layers = Vec::new();
        if let Some(step_m) = furniture::grid_step_m(panel.grid, view, self.unit) {
            let grid = furniture::grid(step_m, view, self.unit);
            layers.push(PlateLayer {
                name: "grid".to_owned(),
                items: vec![grid],
            });
        }
        layers.extend(panel.layers.iter().map(|layer| PlateLayer {
            name: layer.name.clone(),
            items: marks.layer(layer),
        }));
        let mut labels = |layer: &Layer| marks.labels(layer, 1.1 * self.text_size());
        let labels: Vec<Item> = panel.layers.iter().flat_map(&mut labels).collect();
        if !labels.is_empty() {
            layers.push(PlateLayer {
                name: "labels".to_owned(),
                items: labels,
            });
        }
        layers
    }

    fn heading_items(&self, k: usize, panel: &Panel, frame: PxBox, top: f64) -> Vec<Item> {
        let size = self.text_size();
        let (letter, lines) = self.heading(k, panel, frame.width);
        let mut items = Vec::new();
        for (row, line) in lines.iter().enumerate() {
            let y = top + (row as f64 * LINE + 0.95) * size;
            match line
                .strip_prefix(letter.as_str())
                .filter(|_| row == 0 && !letter.is_empty())
            {
                Some(rest) => {
                    let after = frame.left
                        + size * (font::width(&letter, Face::Bold) + font::width(" ", Face::Regular));
                    items.push(text(&letter, Face::Bold, size, frame.left, y));
                    items.push(text(rest.trim_start(), Face::Regular, size, after, y));
                }
                None => items.push(text(line, Face::Regular, size, frame.left, y)),
            }
        }
        items
    }

    fn note(&self, note: &str, frame: PxBox) -> Item {
        let size = self.text_size();
        Item::Text(Text {
            anchor: Anchor::Middle,
            ..words(
                note,
                Face::Italic,
                size,
                frame.left + 0.5 * frame.width,
                frame.top + 0.5 * frame.height,
                palette::GREY,
            )
        })
    }
}

fn text(text: &str, face: Face, size: f64, x: f64, y: f64) -> Item {
    Item::Text(words(text, face, size, x, y, palette::INK))
}

fn words(text: &str, face: Face, size: f64, x: f64, y: f64, colour: Colour) -> Text {
    Text {
        x,
        y,
        size,
        anchor: Anchor::Start,
        colour,
        face,
        text: text.to_owned(),
        subscript: String::new(),
        halo: false,
    }
}

fn letter(k: usize) -> String {
    u8::try_from(k).ok().filter(|k| *k < 26).map_or_else(
        || format!("({})", k + 1),
        |k| format!("({})", char::from(b'a' + k)),
    )
}

/// What each panel shows, and whether all have one scale.
fn views(scene: &Scene) -> (Vec<Option<Bounds>>, bool) {
    let own: Vec<Option<Bounds>> = scene
        .panels
        .iter()
        .map(|p| p.bounds().and_then(|b| roomy(p, b)))
        .collect();
    let all = || own.iter().flatten().copied();
    match scene.scale {
        ScaleRule::SameView => {
            let union = all().reduce(Bounds::union);
            (own.iter().map(|view| view.and(union)).collect(), true)
        }
        ScaleRule::SameScaleIfAlike => {
            let sizes = || all().map(|b| b.width_m().max(b.height_m()));
            let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
            if most > 1.6 * least {
                return (own, false);
            }
            let half = Point::new(
                all().map(Bounds::width_m).fold(0.0, f64::max),
                all().map(Bounds::height_m).fold(0.0, f64::max),
            ) * 0.5;
            let same = |b: Bounds| Bounds {
                min: b.centre() - half,
                max: b.centre() + half,
            };
            (own.iter().map(|view| view.map(same)).collect(), true)
        }
        ScaleRule::Own => (own, false),
    }
}

/// Some air round the content, and a size where the content has none; `None` when it cannot be drawn at all.
fn roomy(panel: &Panel, content: Bounds) -> Option<Bounds> {
    let size_m = content.width_m().max(content.height_m());
    let air = match panel.extent {
        crate::scene::Extent::Fixed(_) => 0.0,
        _ => 0.035,
    };
    let reach_m = content.min.norm().max(content.max.norm());
    // Below a millionth of its distance from the origin a coordinate has no digits left to draw with.
    let least_m = (1e-9 * reach_m).max(1e-6);
    let by_m = if size_m > least_m {
        air * size_m
    } else {
        0.5_f64.max(1e-6 * reach_m)
    };
    (size_m.is_finite() && size_m < 1e100 && reach_m < 1e100).then(|| content.grown(by_m))
}

/// Height over width of all plots: that of the widest and highest view.
fn aspect(views: &[Option<Bounds>]) -> f64 {
    let all = || views.iter().flatten();
    let width_m = all().map(|b| b.width_m()).fold(0.0, f64::max);
    let height_m = all().map(|b| b.height_m()).fold(0.0, f64::max);
    if width_m > 0.0 && height_m > 0.0 {
        (height_m / width_m).clamp(0.08, 4.0)
    } else {
        0.6
    }
}
