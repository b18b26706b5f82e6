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

/// Fig. 1: (a) the poses in the log, as a rule raw odometry, (b) rotation corrected, (c) aligned scans, (d) the polygonal map.
///
/// Clouds of millions of points are thinned to the pixels; a panel without data says so.
#[must_use]
pub fn overview(input: &Overview<'_>) -> Scene {
    let no_odometry = "no odometry in this log";
    let mut map = map_panel(input.map, &[], 0.45 * Scene::PAGE_PX);
    "polygonal map".clone_into(&mut map.title);
    "the map is empty".clone_into(&mut map.when_empty);
    map.legend.clear();
    map.grid = crate::scene::Grid::None;
    let panels = vec![
        overlay_panel("scans at the log’s poses", input.odometry, no_odometry),
        overlay_panel(
            "rotation corrected by walls",
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
    let mut cloud = Vec::with_capacity(points(scans));
    for (map_from_scan, scan) in scans {
        cloud.extend(map_from_scan.transform(scan));
    }
    let mut layer = Layer::new("scan points");
    layer.dots(cloud, 0.95, palette::INK);
    panel.with(layer)
}

/// What is laid over each other in (a) to (c), said once where it is the same, and the numbers of the map.
fn caption(input: &Overview<'_>) -> String {
    let overlays = [
        ("(a)", input.odometry),
        ("(b)", input.rotation_corrected),
        ("(c)", input.aligned),
    ];
    let mut said: Vec<(String, String)> = Vec::new();
    for (letter, overlay) in overlays {
        let Some(scans) = overlay else { continue };
        let what = format!(
            "{} with {}",
            counted(scans.len(), "scan"),
            counted(points(scans), "point")
        );
        match said.last_mut() {
            Some((letters, same)) if *same == what => *letters += &format!(", {letter}"),
            _ => said.push((letter.to_owned(), what)),
        }
    }
    let said: String = said
        .iter()
        .map(|(letters, what)| format!("{letters}: {what}; "))
        .collect();
    let vertices: usize = input.map.polylines.iter().map(|p| p.vertices.len()).sum();
    let most = overlays
        .iter()
        .filter_map(|(_, overlay)| overlay.map(points))
        .max()
        .unwrap_or(0);
    let ratio = if vertices > 0 && most >= 2 * vertices {
        format!(
            " One vertex of the map stands for {} scan points.",
            count(most / vertices)
        )
    } else {
        String::new()
    };
    format!("{said}(d): {}{ratio}", map_numbers(input.map))
}

fn points(overlay: &Overlay) -> usize {
    overlay.iter().map(|(_, points)| points.len()).sum()
}
