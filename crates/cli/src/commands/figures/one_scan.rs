//! Fig. 2: one scan from its returns to simplified polylines.

use polymapper_core::extract::{ExtractSettings, extract, extract_by_relevance};
use polymapper_core::geometry::Point;
use polymapper_core::scan::Scan;
use polymapper_draw::figures::{Stage, levels};
use polymapper_draw::{Extent, Scene};

use super::survey::Survey;

/// Scans that are looked at for the one with most vertices.
const LOOKED_AT: usize = 20;
/// Levels of the paper's figure: least relevance K of a vertex, metres.
const LEVELS_MM: [u32; 4] = [1, 5, 10, 15];

/// Draws the chosen scan, or the one with most vertices among some that are evenly spread over the log.
pub fn draw(survey: &Survey, chosen: Option<usize>) -> Scene {
    let number = chosen.unwrap_or_else(|| richest(survey));
    let surveyed = &survey.scans[number];
    let points: Vec<Point> = surveyed.scan.points().map(|(_, point)| point).collect();
    let grouped = stage("grouped".to_owned(), &surveyed.scan, 0.0);
    let simplified = LEVELS_MM.map(|mm| stage(format!("DCE {mm} mm"), &surveyed.scan, 0.001 * f64::from(mm)));
    let stages: Vec<Stage> = std::iter::once(grouped).chain(simplified).collect();
    let mut scene = levels(&points, &stages);
    for panel in &mut scene.panels {
        panel.extent = Extent::Robust;
    }
    scene.caption = format!("{}, scan\u{a0}{}. {}", survey.name, surveyed.index, scene.caption);
    scene
}

fn richest(survey: &Survey) -> usize {
    let count = survey.scans.len();
    let step = count.div_ceil(LOOKED_AT).max(1);
    let vertices = |k: &usize| extract(&survey.scans[*k].scan, &ExtractSettings::default()).vertices();
    (0..count).step_by(step).max_by_key(vertices).unwrap_or(0)
}

fn stage(title: String, scan: &Scan, level_m: f64) -> Stage {
    let extraction = extract_by_relevance(scan, level_m, &ExtractSettings::default());
    Stage {
        title,
        polylines: extraction.polylines.into_iter().map(|p| p.polyline).collect(),
    }
}
