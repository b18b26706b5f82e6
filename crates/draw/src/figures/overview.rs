use polymapper_core::geometry::{Point, Pose};
use polymapper_core::map::Map;

use crate::colour::palette;
use crate::map_picture::{map_numbers, map_panel};
use crate::round::{count, counted};
use crate::scene::{Layer, Panel, ScaleRule, Scene};

/// Scans laid over each other: the points of each in its own frame, and its pose.
pub type Overlay = [(Pose, Vec<Point>)];

/// What Fig. 1 is drawn from.
#[derive(Clone, Copy, Debug)]
pub struct Overview<'a> {
    /// Scans at the poses of the odometry; `None` when the log has none.
    pub odometry: Option<&'a Overlay>,
    /// The same with large errors of rotation taken out by long walls; `None` when there is no odometry.
    pub rotation_corrected: Option<&'a Overlay>,
    /// Scans at the poses of the alignment; `None` when it was not kept.
    pub aligned: Option<&'a Overlay>,
    /// The map.
    pub map: &'a Map,
}

/// Fig. 1: (a) raw odometry, (b) rotation corrected, (c) aligned scans, (d) the polygonal map.
///
/// Clouds of millions of points are thinned to the pixels; a panel without data says so.
#[must_use]
pub fn overview(input: &Overview<'_>) -> Scene {
    let no_odometry = "no odometry in this log";
    let mut map = map_panel(input.map, &[]);
    "polygonal map".clone_into(&mut map.title);
    "the map is empty".clone_into(&mut map.when_empty);
    map.legend.clear();
    map.grid = crate::scene::Grid::None;
    let panels = vec![
        overlay_panel("scans at odometry poses", input.odometry, no_odometry),
        overlay_panel(
            "rotation corrected by long walls",
            input.rotation_corrected,
            no_odometry,
        ),
        overlay_panel("aligned scans", input.aligned, "no aligned scans given"),
        map,
    ];
    Scene::of_panels(panels)
        .with_scale(ScaleRule::SameScaleIfAlike)
        .with_caption(caption(input))
}

fn overlay_panel(title: &str, overlay: Option<&Overlay>, when_missing: &str) -> Panel {
    let mut panel = Panel::new(title);
    let Some(scans) = overlay else {
        when_missing.clone_into(&mut panel.when_empty);
        return panel;
    };
    "no points in these scans".clone_into(&mut panel.when_empty);
    let mut points = Vec::with_capacity(scans.iter().map(|(_, p)| p.len()).sum());
    for (map_from_scan, scan) in scans {
        points.extend(map_from_scan.transform(scan));
    }
    let mut layer = Layer::new("scan points");
    layer.dots(points, 0.9, palette::INK);
    panel.with(layer)
}

fn caption(input: &Overview<'_>) -> String {
    let said = |letter: &str, overlay: Option<&Overlay>| {
        overlay.map(|scans| {
            let points: usize = scans.iter().map(|(_, p)| p.len()).sum();
            format!(
                "({letter}) {} with {}; ",
                counted(scans.len(), "scan"),
                counted(points, "point")
            )
        })
    };
    let all = [input.odometry, input.rotation_corrected, input.aligned];
    let parts: String = ["a", "b", "c"]
        .iter()
        .zip(all)
        .filter_map(|(l, o)| said(l, o))
        .collect();
    let vertices: usize = input.map.polylines.iter().map(|p| p.vertices.len()).sum();
    let points = all
        .into_iter()
        .flatten()
        .map(|s| s.iter().map(|(_, p)| p.len()).sum::<usize>())
        .max();
    let ratio = match points {
        Some(points) if vertices > 0 && points >= 2 * vertices => {
            format!(
                " One vertex of the map stands for {} scan points.",
                count(points / vertices)
            )
        }
        _ => String::new(),
    };
    format!("{parts}(d) {}{ratio}", map_numbers(input.map))
}
