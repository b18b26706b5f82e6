//! The picture of a built map: `map.svg` and `map.png`.
//!
//! In: the map and the trajectory. Out: a scene with walls dark, a pale band on their side that is not free
//! (polylines have free space on their left), the way of the scanner thin and blue, broad and orange where its place is
//! uncertain, eraser boxes hatched on
//! top (paper section 4: they are drawn over the finished map), and the numbers of the map in the caption.

use polymapper_core::geometry::{Point, Pose};
use polymapper_core::map::Map;

use crate::bounds::Bounds;
use crate::colour::palette;
use crate::round::{count, counted, spoken};
use crate::scene::{Dash, Extent, Face, Fill, Grid, Label, Layer, Mark, Panel, Sample, Scene, Stroke};
use crate::shade::shade;

/// Where a scan was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint {
    /// Pose of the laser in the map; not looked at when the scan was not placed.
    pub map_from_scan: Pose,
    /// Whether the scan has a place in the map.
    pub placed: bool,
    /// Whether that place is uncertain.
    pub is_uncertain: bool,
}

/// The picture of a map with the way of the scanner; the caption counts what is seen.
///
/// The way is broken where scans were not placed; the gap is bridged by dots. Where the place is uncertain it is drawn broad and orange.
#[must_use]
pub fn map_picture(map: &Map, trajectory: &[TrajectoryPoint], title: &str) -> Scene {
    let mut panel = map_panel(map, trajectory, Scene::PAGE_PX);
    let (caption, hidden) = caption(map, trajectory, panel.bounds());
    if hidden == 0 {
        panel.extent = Extent::All;
    }
    panel.when_empty = "the map is empty".to_owned();
    Scene::of(panel).with_title(title).with_caption(caption)
}

/// The plot of [`map_picture`], for a panel some `width_px` wide.
pub(crate) fn map_panel(map: &Map, trajectory: &[TrajectoryPoint], width_px: f64) -> Panel {
    let points: Vec<Point> = map
        .polylines
        .iter()
        .flat_map(|p| &p.vertices)
        .map(|v| v.point)
        .collect();
    let size_m = Bounds::robust(&points)
        .map_or(10.0, |b| b.width_m().max(b.height_m()))
        .max(1e-3);
    let metres_per_px = size_m / width_px;
    let wall = wall_stroke(metres_per_px, width_px);
    let mut panel = Panel::new("")
        .with(shade(map, wall.width_px, metres_per_px))
        .with(walls(map, wall));
    let placed = trajectory.iter().any(|t| t.placed);
    if placed {
        panel.layers.push(way(trajectory, wall.width_px));
    }
    panel.layers.push(eraser_boxes(map));
    panel.grid = Grid::Auto;
    panel = panel.with_legend(Sample::Line(wall), "wall, pale on the side that is not free");
    if placed {
        panel = panel.with_legend(Sample::Line(way_stroke(wall.width_px)), "way of the scanner");
    }
    if trajectory.iter().any(is_doubtful) {
        let stroke = doubtful_stroke(wall.width_px);
        panel = panel.with_legend(Sample::Line(stroke), "way where the place is uncertain");
    }
    if !map.eraser_boxes.is_empty() {
        panel = panel.with_legend(
            Sample::Area(Some(Fill::Hatched(palette::ORANGE)), Some(box_stroke())),
            "no stable shape (eraser box)",
        );
    }
    panel
}

/// Walls as wide as 4 cm, but not below or above what reads well: a house has bold walls, a campus thin ones.
fn wall_stroke(metres_per_px: f64, width_px: f64) -> Stroke {
    let boldest_px = 5.0 * (width_px / Scene::PAGE_PX).sqrt();
    Stroke::new(palette::INK, (0.04 / metres_per_px).clamp(2.0, boldest_px))
}

fn way_stroke(wall_px: f64) -> Stroke {
    Stroke::new(palette::BLUE, (0.6 * wall_px).clamp(1.5, 2.6))
}

/// Broader than the way, so that it stands out in prints without colour, too.
fn doubtful_stroke(wall_px: f64) -> Stroke {
    Stroke::new(palette::VERMILION, 2.0 * way_stroke(wall_px).width_px)
}

fn is_doubtful(point: &TrajectoryPoint) -> bool {
    point.placed && point.is_uncertain
}

fn box_stroke() -> Stroke {
    Stroke::new(palette::ORANGE, 2.0)
}

fn walls(map: &Map, stroke: Stroke) -> Layer {
    let mut layer = Layer::new("walls");
    for polyline in &map.polylines {
        layer.line(polyline.vertices.iter().map(|v| v.point), stroke);
    }
    layer
}

fn way(trajectory: &[TrajectoryPoint], wall_px: f64) -> Layer {
    let stroke = way_stroke(wall_px);
    let mut layer = Layer::new("way of the scanner");
    let runs = trajectory.split(|t| !t.placed).filter(|run| !run.is_empty());
    let runs: Vec<Vec<Point>> = runs
        .map(|run| run.iter().map(|t| t.map_from_scan.translation()).collect())
        .collect();
    for pair in runs.windows(2) {
        let bridge = [pair[0].last(), pair[1].first()].into_iter().flatten().copied();
        layer.line(bridge, stroke.dash(Dash::Dotted));
    }
    for run in &runs {
        layer.line(run.iter().copied(), stroke);
    }
    let doubtful = doubtful_stroke(wall_px);
    for run in trajectory.split(|t| !is_doubtful(t)) {
        let line = run.iter().map(|t| t.map_from_scan.translation());
        // A scan or two make no line to be seen on a map of a hundred metres.
        if let Some(first) = line.clone().next() {
            let rim = Stroke::new(doubtful.colour, 1.0);
            layer.marker(first, 0.7 * doubtful.width_px, doubtful.colour, rim);
            layer.line(line, doubtful);
        }
    }
    let places = || runs.iter().flatten().filter(|p| p.is_finite());
    if let (Some(&start), Some(&end)) = (places().next(), places().next_back()) {
        let rim = Stroke::new(palette::BLUE, 3.0);
        layer.marker(start, 9.0, palette::WHITE, rim);
        layer.marker(end, 7.0, palette::BLUE, rim);
        layer.marks.push(name(start, "start"));
        layer.marks.push(name(end, "end"));
    }
    layer
}

fn name(at: Point, text: &str) -> Mark {
    Mark::Label(Label {
        at,
        text: text.to_owned(),
        subscript: String::new(),
        colour: palette::BLUE,
        face: Face::Regular,
        side: None,
    })
}

fn eraser_boxes(map: &Map) -> Layer {
    let mut layer = Layer::new("eraser boxes");
    for b in &map.eraser_boxes {
        layer.marks.push(Mark::Rectangle {
            bounds: Bounds {
                min: b.min,
                max: b.max,
            },
            fill: Some(Fill::Hatched(palette::ORANGE)),
            stroke: Some(box_stroke()),
        });
    }
    layer
}

/// What the picture shows, in numbers, and how many polylines lie beyond its edge.
fn caption(map: &Map, trajectory: &[TrajectoryPoint], shown: Option<Bounds>) -> (String, usize) {
    let inside = |p: &Point| shown.is_some_and(|b| b.contains(*p));
    let hidden = map
        .polylines
        .iter()
        .filter(|p| {
            p.vertices
                .iter()
                .any(|v| v.point.is_finite() && !inside(&v.point))
        })
        .count();
    let mut text = map_numbers(map);
    if !trajectory.is_empty() {
        let placed = trajectory.iter().filter(|t| t.placed).count();
        let share = if placed == trajectory.len() {
            "All".to_owned()
        } else {
            format!("{} of", count(placed))
        };
        text += &format!(" {share} {} placed", counted(trajectory.len(), "scan"));
        text += &match way_length_m(trajectory) {
            l if l > 0.0 => format!(", along a way of {}.", long_length(l)),
            _ => ".".to_owned(),
        };
    }
    if hidden > 0 {
        text += &format!(
            " {} beyond the edge, far from everything else.",
            counted(hidden, "polyline")
        );
    }
    if let Some(b) = shown {
        text += &format!(
            " Extent {} by {}.",
            long_length(b.width_m()),
            long_length(b.height_m())
        );
    }
    (text, hidden)
}

/// The map in one sentence of numbers.
pub(crate) fn map_numbers(map: &Map) -> String {
    let vertices: usize = map.polylines.iter().map(|p| p.vertices.len()).sum();
    let length_m: f64 = map
        .polylines
        .iter()
        .filter_map(|p| p.polyline())
        .map(|p| p.length_m())
        .sum();
    let boxes = match map.eraser_boxes.len() {
        0 => String::new(),
        n => format!(", {}", counted(n, "eraser box")),
    };
    format!(
        "{} with {}, {} of wall{boxes}.",
        counted(map.polylines.len(), "polyline"),
        counted(vertices, "vertex"),
        long_length(length_m)
    )
}

fn way_length_m(trajectory: &[TrajectoryPoint]) -> f64 {
    let steps = trajectory.windows(2).filter(|w| w[0].placed && w[1].placed);
    let lengths = steps.map(|w| w[0].map_from_scan.distance(w[1].map_from_scan));
    lengths.filter(|l| l.is_finite()).sum()
}

/// A length in metres with three digits or so.
fn long_length(length_m: f64) -> String {
    match length_m {
        l if (100.0..1e15).contains(&l) => format!("{}\u{a0}m", count(l.round() as usize)),
        l if l >= 1.0 => format!("{l:.1}\u{a0}m"),
        l => spoken(l),
    }
}
