use polymapper_core::geometry::{Point, Polyline};

use super::{polylines, scanner};
use crate::colour::palette;
use crate::round::counted;
use crate::scene::{Grid, Layer, Panel, Scene, Stroke};

/// A scan at one level of simplification.
#[derive(Clone, Debug)]
pub struct Stage {
    /// "grouped", "DCE level 5", …; the counts are added.
    pub title: String,
    /// Laser frame, metres.
    pub polylines: Vec<Polyline>,
}

/// Fig. 2: one scan raw, grouped to polylines, and at several levels of simplification; the grid is 1 m.
///
/// `points` are the returns of the scan, laser frame; the scanner is marked at the origin.
#[must_use]
pub fn levels(points: &[Point], stages: &[Stage]) -> Scene {
    let mut raw = Layer::new("returns");
    raw.dots(points.iter().copied(), 2.4, palette::INK);
    let title = format!("raw: {}", counted(points.len(), "point"));
    let mut panels = vec![finished(Panel::new(title).with(raw))];
    panels.extend(stages.iter().map(|stage| {
        let layer = polylines(
            "polylines",
            &stage.polylines,
            Stroke::new(palette::INK, 2.0),
            palette::VERMILION,
        );
        let title = format!("{}: {}", stage.title, counted(vertices(stage), "vertex"));
        finished(Panel::new(title).with(layer))
    }));
    Scene::of_panels(panels).with_caption(caption(points, stages))
}

fn finished(panel: Panel) -> Panel {
    panel.with(scanner(Point::default())).with_grid(Grid::Every(1.0))
}

fn vertices(stage: &Stage) -> usize {
    stage.polylines.iter().map(|p| p.vertices().len()).sum()
}

fn caption(points: &[Point], stages: &[Stage]) -> String {
    let and_polylines = match stages {
        [first, others @ ..] if others.iter().all(|s| s.polylines.len() == first.polylines.len()) => {
            format!(", {}", counted(first.polylines.len(), "polyline"))
        }
        _ => String::new(),
    };
    let start = format!(
        "One scan from its returns to polylines. {}{and_polylines}",
        counted(points.len(), "return")
    );
    let chain: String = stages
        .iter()
        .map(|stage| {
            format!(
                ", {}: {}",
                stage.title.replace(' ', "\u{a0}"),
                counted(vertices(stage), "vertex")
            )
        })
        .collect();
    let length_m = |stage: &Stage| stage.polylines.iter().map(Polyline::length_m).sum::<f64>();
    let kept = match (stages.first(), stages.last()) {
        (Some(first), Some(last)) if stages.len() > 1 && length_m(first) > 0.0 => {
            let share = 100.0 * length_m(last) / length_m(first);
            format!(" The last level has {share:.0} % of the length of the first.")
        }
        _ => String::new(),
    };
    format!("{start}{chain}.{kept} Ring: scanner.")
}
