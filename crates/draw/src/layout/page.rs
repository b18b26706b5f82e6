//! The page: what is written round the panels, in the sizes of a page of [`Scene::PAGE_PX`].

use super::furniture::{self, Cell, Strip};
use super::view::View;
use super::views::{aspect, views};
use crate::bounds::Bounds;
use crate::font;
use crate::plate::Plate;
use crate::scene::{Face, Panel, Scene};

/// Sizes in px of a page of [`Scene::PAGE_PX`].
pub(super) const MARGIN: f64 = 44.0;
pub(super) const GAP: f64 = 44.0;
const TEXT: f64 = 30.0;
pub(super) const TITLE: f64 = 38.0;
pub(super) const LINE: f64 = 1.38;
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

pub(super) struct Page<'a> {
    pub(super) scene: &'a Scene,
    pub(super) longest: f64,
    pub(super) unit: f64,
    /// What each panel shows; `None` where there is nothing.
    pub(super) views: Vec<Option<Bounds>>,
    /// Height of a plot over its width.
    pub(super) aspect: f64,
    pub(super) one_scale: bool,
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

    pub(super) fn text_size(&self) -> f64 {
        TEXT * self.unit
    }

    pub(super) fn rows(&self, columns: usize) -> usize {
        self.scene.panels.len().div_ceil(columns)
    }

    pub(super) fn caption_lines(&self, page_width: f64) -> Vec<String> {
        let width_em = (page_width - 2.0 * MARGIN * self.unit) / self.text_size();
        font::wrap(&self.scene.caption, Face::Regular, width_em, MOST_CAPTION_LINES)
    }

    pub(super) fn panels_of_row(
        &self,
        row: usize,
        columns: usize,
    ) -> impl Iterator<Item = (usize, &'a Panel)> {
        self.scene
            .panels
            .iter()
            .enumerate()
            .skip(row * columns)
            .take(columns)
    }

    /// The letter of a panel and the lines of its title.
    pub(super) fn heading(&self, k: usize, panel: &Panel, panel_width: f64) -> (String, Vec<String>) {
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

    pub(super) fn strip(&self, panel_width: f64) -> Strip {
        Strip {
            unit: self.unit,
            text_size: 0.93 * self.text_size(),
            width: panel_width,
        }
    }

    /// Where panels have one scale, the bar stands below the first of the last row only.
    pub(super) fn cells(&self, k: usize, columns: usize, view: Option<&View>) -> Vec<Cell<'a>> {
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
}

pub(super) fn letter(k: usize) -> String {
    u8::try_from(k).ok().filter(|k| *k < 26).map_or_else(
        || format!("({})", k + 1),
        |k| format!("({})", char::from(b'a' + k)),
    )
}
