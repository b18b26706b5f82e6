//! How large the panels are: for each number of columns, the largest that leave room for what is written.

use super::page::{GAP, LINE, MARGIN, Page, TITLE};
use super::view::View;
use crate::plate::PxBox;

const LEAST_PAGE_WIDTH: f64 = 1040.0;
const LEAST_PANEL_WIDTH: f64 = 430.0;
const LEAST_PANEL_HEIGHT: f64 = 90.0;

/// Sizes for one number of columns.
pub(super) struct Arrangement {
    pub(super) columns: usize,
    pub(super) panel_width: f64,
    pub(super) panel_height: f64,
    pub(super) page_width: f64,
}

impl Page<'_> {
    /// Area of a panel, times the share of the cells of the page that hold one: a page with holes is a poor page.
    pub(super) fn worth(&self, arrangement: &Arrangement) -> f64 {
        let columns = arrangement.columns;
        let filled = self.scene.panels.len() as f64 / (columns * self.rows(columns)).max(1) as f64;
        arrangement.panel_width * arrangement.panel_height * filled
    }

    /// The largest panels in `columns` columns that keep the page within its longest side. Text needs more
    /// rows in narrower panels, so the height is found by going down a few times.
    pub(super) fn arrange(&self, columns: usize) -> Arrangement {
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

    pub(super) fn title_height(&self) -> f64 {
        if self.scene.title.is_empty() {
            0.0
        } else {
            1.5 * TITLE * self.unit
        }
    }

    pub(super) fn caption_height(&self, page_width: f64) -> f64 {
        let lines = self.caption_lines(page_width).len() as f64;
        if lines > 0.0 {
            (lines * LINE + 0.5) * self.text_size()
        } else {
            0.0
        }
    }

    pub(super) fn heading_height(&self, row: usize, columns: usize, panel_width: f64) -> f64 {
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

    pub(super) fn strip_height(&self, row: usize, columns: usize, panel_width: f64) -> f64 {
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
}
