//! Places for labels: near what they name, off other labels, and off lines where there is room.
//!
//! Greedy, in the order given: of 16 directions and six distances the cheapest place is taken. Covering
//! another label costs most, then leaving the plot, then covering lines, then distance and turning away from
//! the wanted side. A label that had to move away gets a thin leader.

use crate::colour::palette;
use crate::font::{self, SUBSCRIPT_DROP};
use crate::plate::{Anchor, Item, Pen, Px, PxBox, Text};
use crate::scene::Label;

const DISTANCES: [f64; 6] = [9.0, 15.0, 22.0, 32.0, 46.0, 66.0];
const DIRECTIONS: u32 = 16;
/// Spacing of the samples that stand for lines, px.
const SAMPLE_PX: f64 = 5.0;
/// More samples than this would not make places better, only slower.
const MOST_SAMPLES: usize = 40_000;

/// What labels keep off.
#[derive(Default)]
pub(super) struct Obstacles {
    samples: Vec<Px>,
    taken: Vec<PxBox>,
}

impl Obstacles {
    pub fn add_line(&mut self, line: &[Px]) {
        for side in line.windows(2) {
            let steps = (side[0].distance(side[1]) / SAMPLE_PX).ceil().clamp(1.0, 1000.0) as u32;
            for k in 0..=steps {
                self.add_point(side[0].lerp(side[1], f64::from(k) / f64::from(steps)));
            }
        }
    }

    pub fn add_point(&mut self, p: Px) {
        if self.samples.len() < MOST_SAMPLES {
            self.samples.push(p);
        }
    }

    pub fn add_marker(&mut self, centre: Px, radius: f64) {
        self.taken.push(
            PxBox {
                left: centre.x,
                top: centre.y,
                width: 0.0,
                height: 0.0,
            }
            .grown(radius),
        );
    }
}

/// Places `label`, whose anchor is at `at`, and remembers its place.
pub(super) fn place(label: &Label, at: Px, size: f64, frame: PxBox, obstacles: &mut Obstacles) -> Vec<Item> {
    let width = size * font::width_with_subscript(&label.text, &label.subscript, label.face);
    let below = size
        * if label.subscript.is_empty() {
            0.2
        } else {
            SUBSCRIPT_DROP + 0.15
        };
    let height = 0.76 * size + below;
    let wanted = label
        .side
        .map(|s| Px::new(s.x, -s.y))
        .and_then(Px::unit)
        .unwrap_or(Px::new(0.0, -1.0));
    let unit = size / 26.0;
    let mut best: Option<(f64, PxBox, f64)> = None;
    for distance in DISTANCES.map(|d| d * unit) {
        for k in 0..DIRECTIONS {
            let angle_rad =
                f64::from(k) * std::f64::consts::TAU / f64::from(DIRECTIONS) + wanted.bearing_rad();
            let towards = Px::from_polar(1.0, angle_rad);
            let reach = distance + 0.5 * (towards.x.abs() * width + towards.y.abs() * height);
            let centre = at + towards * reach;
            let place = PxBox {
                left: centre.x - 0.5 * width,
                top: centre.y - 0.5 * height,
                width,
                height,
            };
            let cost = cost_of(place, frame, obstacles)
                + 0.5 * (1.0 - towards.dot(wanted))
                + 0.025 * distance / unit;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, place, distance));
            }
        }
    }
    let Some((_, place, distance)) = best else {
        return Vec::new();
    };
    obstacles.taken.push(place);
    let mut items = Vec::new();
    if distance > 30.0 * unit {
        items.push(leader(at, place, unit));
    }
    items.push(Item::Text(Text {
        x: place.left,
        y: place.bottom() - below,
        size,
        anchor: Anchor::Start,
        colour: label.colour,
        face: label.face,
        text: label.text.clone(),
        subscript: label.subscript.clone(),
        halo: true,
    }));
    items
}

fn cost_of(place: PxBox, frame: PxBox, obstacles: &Obstacles) -> f64 {
    let area = (place.width * place.height).max(1.0);
    let roomy = place.grown(3.0);
    let covered: f64 = obstacles.taken.iter().map(|t| t.overlap(roomy)).sum();
    let crossed = obstacles.samples.iter().filter(|p| roomy.contains(**p)).count() as f64;
    let outside = 1.0 - place.overlap(frame) / area;
    12.0 * covered / area + 20.0 * outside + 3.0 * crossed * SAMPLE_PX / (place.width + place.height).max(1.0)
}

fn leader(at: Px, place: PxBox, unit: f64) -> Item {
    let nearest = Px::new(
        at.x.clamp(place.left, place.right()),
        at.y.clamp(place.top, place.bottom()),
    );
    let start = at.lerp(nearest, (10.0 * unit / at.distance(nearest).max(1e-9)).min(0.5));
    Item::Lines {
        lines: vec![vec![start, nearest]],
        pen: Pen {
            colour: palette::GREY,
            width: 1.5 * unit,
            dashes: Vec::new(),
            opacity: 1.0,
            butt: false,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Face;

    const FRAME: PxBox = PxBox {
        left: 0.0,
        top: 0.0,
        width: 400.0,
        height: 400.0,
    };

    fn label() -> Label {
        Label {
            at: Px::default(),
            text: "p".to_owned(),
            subscript: "s1".to_owned(),
            colour: palette::INK,
            face: Face::Italic,
            side: None,
        }
    }

    fn place_of(items: &[Item]) -> (f64, f64) {
        let Some(Item::Text(text)) = items.last() else {
            panic!("no text in {items:?}")
        };
        (text.x, text.y)
    }

    #[test]
    fn labels_of_one_point_stand_apart() {
        let mut obstacles = Obstacles::default();
        for _ in 0..6 {
            place(&label(), Px::new(200.0, 200.0), 26.0, FRAME, &mut obstacles);
        }
        for (k, a) in obstacles.taken.iter().enumerate() {
            assert!(
                obstacles.taken[k + 1..].iter().all(|b| a.overlap(*b) < 1e-9),
                "label {k} is covered"
            );
        }
    }

    #[test]
    fn a_label_stays_in_the_plot() {
        let (_, y) = place_of(&place(
            &label(),
            Px::new(200.0, 2.0),
            26.0,
            FRAME,
            &mut Obstacles::default(),
        ));
        assert!(y > 20.0, "the base line is at {y}");
    }

    #[test]
    fn a_label_leaves_a_line_free() {
        let mut obstacles = Obstacles::default();
        obstacles.add_line(&[Px::new(0.0, 185.0), Px::new(400.0, 185.0)]);
        place(&label(), Px::new(200.0, 200.0), 26.0, FRAME, &mut obstacles);
        let place = obstacles.taken[0];
        assert!(
            place.bottom() < 185.0 || place.top > 185.0,
            "{place:?} covers the line"
        );
    }
}
