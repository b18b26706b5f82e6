//! Marks of a layer turned into items: placed, cut at the frame, thinned.

use super::label::{self, Obstacles};
use super::view::View;
use super::{cloud, ink, pen_of};
use crate::clip;
use crate::colour::palette;
use crate::plate::{Ink, Item, Pen, Px, PxBox};
use crate::scene::{Dash, Fill, Label, Layer, Mark, Radius, Stroke};

/// Neighbouring points of a line closer than this are one on the page.
const FINEST_PX: f64 = 0.4;

/// Draws the marks of one panel.
pub(super) struct Marks<'a> {
    view: &'a View,
    unit: f64,
    obstacles: Obstacles,
}

impl<'a> Marks<'a> {
    pub fn new(view: &'a View, unit: f64) -> Self {
        Self {
            view,
            unit,
            obstacles: Obstacles::default(),
        }
    }

    /// Everything of a layer but its labels.
    pub fn layer(&mut self, layer: &Layer) -> Vec<Item> {
        let mut items = Vec::new();
        for mark in &layer.marks {
            for item in self.mark(mark) {
                append(&mut items, item);
            }
        }
        items
    }

    /// The labels of a layer; to be asked for when all layers are drawn, so that they keep off what is there.
    pub fn labels(&mut self, layer: &Layer, text_size: f64) -> Vec<Item> {
        let labels = layer.marks.iter().filter_map(|mark| match mark {
            Mark::Label(label) => Some(label),
            _ => None,
        });
        labels.flat_map(|label| self.label(label, text_size)).collect()
    }

    fn label(&mut self, label: &Label, text_size: f64) -> Vec<Item> {
        let at = self.view.px(label.at);
        if !at.is_finite() || !self.view.frame.contains(at) {
            return Vec::new();
        }
        label::place(label, at, text_size, self.view.frame, &mut self.obstacles)
    }

    fn mark(&mut self, mark: &Mark) -> Vec<Item> {
        match mark {
            Mark::Line { points, stroke } => {
                let points: Vec<Px> = points.iter().map(|p| self.view.px(*p)).collect();
                self.line(&points, stroke)
            }
            Mark::Polygon { corners, colour } => {
                let corners: Vec<Px> = corners.iter().map(|p| self.view.px(*p)).collect();
                match clip::polygon(&corners, self.view.frame) {
                    corners if corners.len() < 3 => Vec::new(),
                    corners => vec![Item::Area {
                        corners,
                        fill: Some(ink(*colour, 1.0)),
                        pen: None,
                    }],
                }
            }
            Mark::Dots {
                points,
                radius_px,
                colour,
            } => {
                let places: Vec<Px> = points.iter().map(|p| self.view.px(*p)).collect();
                let radius = (radius_px * self.unit).clamp(0.3, 100.0);
                // Cells a little smaller than a dot, so that the dots of a wall run together.
                cloud::thin(&places, self.view.frame, 1.5 * radius)
                    .into_iter()
                    .filter(|(_, centres)| !centres.is_empty())
                    .map(|(strength, centres)| Item::Dots {
                        centres,
                        radius,
                        colour: colour.tint(strength),
                    })
                    .collect()
            }
            Mark::Circle {
                centre,
                radius,
                fill,
                stroke,
            } => self.circle(self.view.px(*centre), *radius, fill.as_ref(), stroke.as_ref()),
            Mark::Rectangle { bounds, fill, stroke } => {
                let (a, b) = (self.view.px(bounds.min), self.view.px(bounds.max));
                let area = PxBox {
                    left: a.x,
                    top: b.y,
                    width: b.x - a.x,
                    height: a.y - b.y,
                };
                rectangle(area, fill.as_ref(), stroke.as_ref(), self.view.frame, self.unit)
            }
            Mark::Label(_) => Vec::new(),
        }
    }

    fn line(&mut self, points: &[Px], stroke: &Stroke) -> Vec<Item> {
        let lines: Vec<Vec<Px>> = clip::line(points, self.view.frame)
            .into_iter()
            .map(thinned)
            .collect();
        for line in &lines {
            self.obstacles.add_line(line);
        }
        let head = stroke
            .arrow
            .then(|| arrow_head(points, stroke, self.unit))
            .flatten();
        let inside = |head: &Item| matches!(head, Item::Area { corners, .. } if corners.iter().all(|c| self.view.frame.contains(*c)));
        let head = head.filter(inside);
        let line = (!lines.is_empty()).then(|| Item::Lines {
            lines,
            pen: pen_of(stroke, self.unit),
        });
        line.into_iter().chain(head).collect()
    }

    fn circle(
        &mut self,
        centre: Px,
        radius: Radius,
        fill: Option<&Fill>,
        stroke: Option<&Stroke>,
    ) -> Vec<Item> {
        let radius = match radius {
            Radius::Px(r) => r.abs() * self.unit,
            Radius::Metres(r) => r.abs() / self.view.metres_per_px,
        };
        if !centre.is_finite() || !radius.is_finite() {
            return Vec::new();
        }
        let frame = self.view.frame;
        let reach = PxBox {
            left: centre.x,
            top: centre.y,
            width: 0.0,
            height: 0.0,
        }
        .grown(radius);
        let whole = frame.contains(Px::new(reach.left, reach.top))
            && frame.contains(Px::new(reach.right(), reach.bottom()));
        if whole {
            self.obstacles.add_marker(centre, radius);
            return vec![disc(centre, radius, fill, stroke, self.unit)];
        }
        let rim: Vec<Px> = (0..=180)
            .map(|k| centre + Px::from_polar(radius, f64::from(k) * std::f64::consts::TAU / 180.0))
            .collect();
        stroke.map_or_else(Vec::new, |stroke| self.line(&rim, stroke))
    }
}

/// Puts an item behind the others; lines of one pen become one item.
fn append(items: &mut Vec<Item>, item: Item) {
    match (items.last_mut(), item) {
        (
            Some(Item::Lines { lines, pen }),
            Item::Lines {
                lines: more,
                pen: same,
            },
        ) if *pen == same => {
            lines.extend(more);
        }
        (_, item) => items.push(item),
    }
}

fn thinned(line: Vec<Px>) -> Vec<Px> {
    let Some((&last, body)) = line.split_last() else {
        return line;
    };
    let mut kept: Vec<Px> = Vec::with_capacity(line.len());
    for p in body {
        if kept.last().is_none_or(|k| k.distance(*p) > FINEST_PX) {
            kept.push(*p);
        }
    }
    kept.push(last);
    kept
}

fn arrow_head(points: &[Px], stroke: &Stroke, unit: f64) -> Option<Item> {
    let [.., from, tip] = points else { return None };
    let along = (*tip - *from).unit()?;
    let length = (4.0 * stroke.width_px + 8.0) * unit;
    let (back, side) = (*tip - along * length, along.left() * (0.36 * length));
    let corners = vec![*tip, back + side, back - side];
    Some(Item::Area {
        corners,
        fill: Some(ink(stroke.colour, stroke.opacity)),
        pen: None,
    })
}

/// A disc or circle.
pub(super) fn disc(centre: Px, radius: f64, fill: Option<&Fill>, stroke: Option<&Stroke>, unit: f64) -> Item {
    let fill = fill.map(|fill| match fill {
        Fill::Flat(colour, opacity) => ink(*colour, *opacity),
        Fill::Hatched(colour) => ink(*colour, 0.3),
    });
    Item::Circle {
        centre,
        radius,
        fill,
        pen: stroke.map(|s| pen_of(s, unit)),
    }
}

/// A rectangle cut at `frame`; the hatching runs on from box to box.
pub(super) fn rectangle(
    area: PxBox,
    fill: Option<&Fill>,
    stroke: Option<&Stroke>,
    frame: PxBox,
    unit: f64,
) -> Vec<Item> {
    let finite =
        area.left.is_finite() && area.top.is_finite() && area.width.is_finite() && area.height.is_finite();
    let seen = common(area, frame);
    if !finite || seen.width <= 0.0 || seen.height <= 0.0 {
        return Vec::new();
    }
    let mut items = Vec::new();
    match fill {
        Some(Fill::Flat(colour, opacity)) => items.push(flat(seen, ink(*colour, *opacity))),
        Some(Fill::Hatched(colour)) => {
            items.push(flat(seen, ink(palette::WHITE, 0.72)));
            items.push(hatching(seen, Stroke::new(*colour, 1.6), unit));
        }
        None => {}
    }
    if let Some(stroke) = stroke {
        let mut rim = corners(area);
        rim.push(rim[0]);
        rim.push(rim[1]);
        let lines = clip::line(&rim, frame);
        items.push(Item::Lines {
            lines,
            pen: pen_of(stroke, unit),
        });
    }
    items
}

fn common(a: PxBox, b: PxBox) -> PxBox {
    let (left, top) = (a.left.max(b.left), a.top.max(b.top));
    PxBox {
        left,
        top,
        width: a.right().min(b.right()) - left,
        height: a.bottom().min(b.bottom()) - top,
    }
}

fn corners(area: PxBox) -> Vec<Px> {
    vec![
        Px::new(area.left, area.top),
        Px::new(area.right(), area.top),
        Px::new(area.right(), area.bottom()),
        Px::new(area.left, area.bottom()),
    ]
}

fn flat(area: PxBox, fill: Ink) -> Item {
    Item::Area {
        corners: corners(area),
        fill: Some(fill),
        pen: None,
    }
}

/// Lines x + y = k · spacing, so that neighbouring boxes share them.
fn hatching(area: PxBox, stroke: Stroke, unit: f64) -> Item {
    let spacing = 11.0 * unit;
    let (low, high) = (area.left + area.top, area.right() + area.bottom());
    let first = (low / spacing).ceil();
    let count = ((high / spacing).floor() - first).clamp(-1.0, 2000.0) as i32;
    let lines = (0..=count).filter_map(|k| {
        let sum = (first + f64::from(k)) * spacing;
        let (a, b) = (
            Px::new(sum - area.top, area.top),
            Px::new(sum - area.bottom(), area.bottom()),
        );
        clip::segment(a, b, area).map(|(a, b)| vec![a, b])
    });
    let pen = Pen {
        butt: true,
        ..pen_of(&stroke, unit)
    };
    Item::Raster {
        lines: lines.collect(),
        pen,
    }
}

/// Dash and gap lengths of a line of `width` pixels; the round ends of a dash take a width off the gap.
pub(super) fn dashes(dash: Dash, width: f64, unit: f64) -> Vec<f64> {
    match dash {
        Dash::Solid => Vec::new(),
        Dash::Dashed => vec![4.0 * width + 3.0 * unit, 3.0 * width + 3.0 * unit],
        Dash::Dotted => vec![0.05, 2.4 * width + unit],
    }
}
