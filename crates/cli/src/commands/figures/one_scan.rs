//! Fig. 2: one scan from its returns to simplified polylines.

use polymapper_core::extract::{ExtractSettings, extract, extract_by_relevance};
use polymapper_core::geometry::Point;
use polymapper_core::scan::Scan;
use polymapper_draw::figures::{Stage, levels};
use polymapper_draw::{Bounds, Extent, Scene};

use super::survey::Survey;

/// Scans that are looked at for one with much to show.
const LOOKED_AT: usize = 100;
/// Share of the returns that lies within what is called the near part of a scan.
const NEAR_SHARE: f64 = 0.9;
/// Levels of the paper's figure: least relevance K of a vertex, metres.
const LEVELS_MM: [u32; 4] = [1, 5, 10, 15];

/// Draws the chosen scan, or the one with most to show among some that are evenly spread over the log.
pub fn draw(survey: &Survey, chosen: Option<usize>) -> Scene {
    let number = chosen.unwrap_or_else(|| richest(survey));
    let surveyed = &survey.scans[number];
    let points: Vec<Point> = surveyed.scan.points().map(|(_, point)| point).collect();
    let grouped = stage("grouped".to_owned(), &surveyed.scan, 0.0);
    let simplified = LEVELS_MM.map(|mm| stage(format!("DCE {mm} mm"), &surveyed.scan, 0.001 * f64::from(mm)));
    let stages: Vec<Stage> = std::iter::once(grouped).chain(simplified).collect();
    let mut scene = levels(&points, &stages);
    let shown = view(&points);
    for panel in &mut scene.panels {
        panel.extent = shown.map_or(Extent::All, Extent::Fixed);
    }
    let outside = match shown.map_or(0, |view| points.iter().filter(|p| !view.contains(**p)).count()) {
        0 => "",
        1 => " One return lies outside the picture.",
        n => &format!(" {n} returns lie outside the picture."),
    };
    scene.caption = format!(
        "{}, scan\u{a0}{}. {}{outside}",
        survey.name, surveyed.index, scene.caption
    );
    scene
}

/// The near part of a scan and a fifth more, with the scanner: a few returns from the far end of a corridor would make the rest tiny.
fn view(points: &[Point]) -> Option<Bounds> {
    let reach_m = 1.2 * near_m(points)?;
    let near = points.iter().copied().filter(|p| p.norm() <= reach_m);
    let bounds = Bounds::of(near.chain([Point::default()]))?;
    Some(bounds.grown(0.05 * bounds.width_m().max(bounds.height_m())))
}

/// Range within which most returns lie.
fn near_m(points: &[Point]) -> Option<f64> {
    let mut ranges_m: Vec<f64> = points.iter().map(|p| p.norm()).collect();
    ranges_m.sort_by(f64::total_cmp);
    let at = (NEAR_SHARE * ranges_m.len() as f64) as usize;
    ranges_m.get(at).copied()
}

fn richest(survey: &Survey) -> usize {
    let count = survey.scans.len();
    (0..count)
        .step_by(count.div_ceil(LOOKED_AT).max(1))
        .max_by(|a, b| richness(&survey.scans[*a].scan).total_cmp(&richness(&survey.scans[*b].scan)))
        .unwrap_or(0)
}

/// Many vertices on little paper.
fn richness(scan: &Scan) -> f64 {
    let points: Vec<Point> = scan.points().map(|(_, point)| point).collect();
    let Some(near_m) = near_m(&points) else { return 0.0 };
    let vertices = extract(scan, &ExtractSettings::default()).vertices() as f64;
    vertices * vertices / near_m.max(1.0)
}

fn stage(title: String, scan: &Scan, level_m: f64) -> Stage {
    let extraction = extract_by_relevance(scan, level_m, &ExtractSettings::default());
    Stage {
        title,
        polylines: extraction.polylines.into_iter().map(|p| p.polyline).collect(),
    }
}
