//! The page drawn: every panel in its place, and what is written round it.

use polymapper_core::geometry::Point;

use super::arrange::Arrangement;
use super::furniture;
use super::marks::Marks;
use super::page::{GAP, LINE, MARGIN, Page, TITLE, letter};
use super::view::View;
use crate::colour::{Colour, palette};
use crate::font;
use crate::plate::{Anchor, Item, Plate, PlateLayer, PlatePanel, PxBox, Text};
use crate::scene::{Face, Layer, Panel};

impl Page<'_> {
    pub(super) fn draw(&self, arrangement: &Arrangement) -> Plate {
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
