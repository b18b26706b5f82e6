//! Scan → polylines (paper sections 2 and 3.1).
//!
//! In: a scan. Out: its polylines, counter-clockwise, free space on their left. [`extract`]:
//!
//! 1. The range noise σ of the scanner, unless given ([`estimate_noise_m`]).
//! 2. Returns → groups on one surface ([`GroupSettings`]).
//! 3. Each group is divided into sides: the exact minimum over all divisions of Σ (range residual)² / variance + penalty · sides.
//!    The paper removes vertices by K(u,v,w) up to a fixed K instead ([`evolve`], kept for its figure 2): K knows nothing of noise
//!    and range, and wants a level per scanner.
//! 4. A least-squares line per side, vertices where neighbouring sides meet, end points on their rays.
//!
//! [`extract_with_budget`] plans the vertices of the whole scan at once, with a price for returns that are in no polyline.
//! Its polylines may run on behind things that stand in front of them.

mod budget;
mod chain;
mod divide;
mod ends;
mod evolve;
mod finish;
mod fit;
mod front;
mod group;
mod noise;
mod plan;
mod refine;
mod sides;

use crate::geometry::Polyline;
use crate::scan::Scan;

pub use chain::simplify_chain;
pub use evolve::{Stop, evolve, evolve_by, relevance_m};
pub(crate) use fit::Sums;
pub use group::GroupSettings;
pub use noise::{NOISE_DEFAULT_M, NOISE_FLOOR_M, RunningNoise, estimate_noise_m};

/// A polyline of a scan and the beams it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanPolyline {
    /// Laser frame, metres; runs counter-clockwise round the scanner, so that free space is on the left.
    pub polyline: Polyline,
    /// First beam of its group.
    pub first_beam: usize,
    /// Last beam of its group; smaller than `first_beam` when the group runs over the end of a full circle.
    pub last_beam: usize,
}

/// How a scan is turned into polylines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtractSettings {
    /// Standard deviation of the ranges, metres; `None`: estimated from every scan by itself.
    pub noise_m: Option<f64>,
    /// How returns are grouped.
    pub grouping: GroupSettings,
    /// What a side must save in squared residuals, in units of σ². A side has two parameters and a place where it
    /// starts; ln of 180..361 beams for each (Bayesian information criterion) makes 3 · 5.5.
    pub side_penalty: f64,
}

impl Default for ExtractSettings {
    fn default() -> Self {
        Self {
            noise_m: None,
            grouping: GroupSettings::default(),
            side_penalty: 16.0,
        }
    }
}

/// The polylines of a scan, and what is in none.
#[derive(Clone, Debug, Default)]
pub struct Extraction {
    /// The polylines, counter-clockwise.
    pub polylines: Vec<ScanPolyline>,
    /// Range noise that was used, metres.
    pub noise_m: f64,
    /// Beams that returned.
    pub returns: usize,
    /// Returns that are in no polyline: alone, without a neighbour on the same surface.
    pub returns_unused: usize,
}

impl Extraction {
    /// Vertices of all polylines together.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.polylines.iter().map(|p| p.polyline.vertices().len()).sum()
    }
}

/// The polylines of a scan, as fine as the noise of the scanner supports.
#[must_use]
pub fn extract(scan: &Scan, settings: &ExtractSettings) -> Extraction {
    let noise_m = noise_m(scan, settings);
    let groups = group::group(scan, &settings.grouping, noise_m);
    sides::extract(
        &groups,
        scan.geometry().step_rad(),
        noise_m,
        settings.side_penalty,
    )
}

/// The polylines of a scan with at most `vertices` vertices all together.
#[must_use]
pub fn extract_with_budget(scan: &Scan, vertices: usize, settings: &ExtractSettings) -> Extraction {
    let noise_m = noise_m(scan, settings);
    let groups = group::group(scan, &settings.grouping, noise_m);
    budget::extract(groups, scan.geometry(), noise_m, vertices)
}

/// The paper's own simplification (section 3.1): groups evolved until every vertex has a relevance K of `level_m` metres or
/// more, vertices on returns, no line fit. Its figure 2 shows levels 0.001, 0.005, 0.010 and 0.015; level 0 keeps every return.
#[must_use]
pub fn extract_by_relevance(scan: &Scan, level_m: f64, settings: &ExtractSettings) -> Extraction {
    let noise_m = noise_m(scan, settings);
    let groups = group::group(scan, &settings.grouping, noise_m);
    let mut out = Extraction {
        noise_m,
        returns: groups.points.len(),
        ..Extraction::default()
    };
    for group in &groups.groups {
        let points = &groups.points[group.clone()];
        let vertices = evolve(points, Stop::AtCost(level_m))
            .into_iter()
            .map(|k| points[k])
            .collect();
        match Polyline::new(vertices) {
            Ok(polyline) => out.polylines.push(ScanPolyline {
                polyline,
                first_beam: groups.beams[group.start],
                last_beam: groups.beams[group.end - 1],
            }),
            Err(_) => out.returns_unused += group.len(),
        }
    }
    out
}

/// The noise to work with.
fn noise_m(scan: &Scan, settings: &ExtractSettings) -> f64 {
    settings
        .noise_m
        .or_else(|| estimate_noise_m(scan))
        .unwrap_or(NOISE_DEFAULT_M)
        .max(NOISE_FLOOR_M)
}

#[cfg(test)]
mod tests;
