//! Merging an aligned scan into the map (paper section 4).
//!
//! In: the polylines of a scan, its pose, the map. Out: the map with the scan averaged into it. In order: simulated
//! scan points (`simulate`), their closest points on the map (`link`), new points joined into ordered polylines
//! (`splice`, with the vertex rule of Fig. 4), sharp angles taken out (`sharp`), and what the scan looked
//! through cleared (`sight`).

pub(crate) mod eraser;
pub(crate) mod finish;
pub(crate) mod growing_map;
mod link;
pub(crate) mod moving;
mod on_sides;
mod overlap;
pub(crate) mod refit;
mod retrace;
mod sharp;
mod sight;
mod simulate;
mod splice;
mod stubs;
#[cfg(test)]
mod tests;

pub use eraser::EraserSettings;
use growing_map::GrowingMap;
pub use moving::MovingSettings;
use simulate::ScanPoint;

use crate::keyframe::Keyframe;
use crate::map::EraserBox;

/// How scans are merged.
#[derive(Clone, Copy, Debug)]
pub struct MergeSettings {
    /// Distance within which a scan point and a map point are the same, metres (paper: 0.20 m for grouping, no
    /// number here).
    pub gate_m: f64,
    /// Distance between vertices of the growing map below which no new ones are added, metres.
    pub spacing_m: f64,
    /// Weight that a vertex of the map has at most, in observations: the map can follow slow change.
    pub most_hits: u32,
    /// Inner angles below this are no shape but noise or disorder, radians (paper: 20°).
    pub sharp_angle_rad: f64,
    /// How far before its return a beam must pass a side to have looked through it, metres.
    pub sight_margin_m: f64,
    /// Sine of the smallest angle between beam and side that counts.
    pub sight_min_sine: f64,
    /// Looks through a vertex before it may be taken out.
    pub sight_min_looks: u32,
    /// Share of looks through, among all scans that saw or looked through a side, from which the side is not there.
    pub sight_share: f64,
    /// How far the skeleton may stray from the vertices before it gets another side, metres (one standard deviation).
    pub skeleton_sigma_m: f64,
}

impl Default for MergeSettings {
    fn default() -> Self {
        Self {
            gate_m: 0.15,
            spacing_m: 0.04,
            most_hits: 50,
            sharp_angle_rad: 20_f64.to_radians(),
            sight_margin_m: 0.3,
            sight_min_sine: 0.2,
            sight_min_looks: 3,
            sight_share: 0.3,
            skeleton_sigma_m: 0.01,
        }
    }
}

/// What a merge did.
#[derive(Clone, Debug, Default)]
pub struct MergeReport {
    /// Polylines of the map that scan points fell on, by slot; ascending.
    pub(crate) into: Vec<u32>,
    /// Scan points that fell on a polyline of the map.
    pub known_points: usize,
    /// Scan points that were new.
    pub new_points: usize,
    /// Vertices of the map that were taken out because scans looked through them.
    pub seen_through: usize,
}

/// Merges keyframes, given with their numbers, one after the other, and brings the skeletons up to date. Returns the
/// report of the last.
pub(crate) fn merge_all<'a>(
    map: &mut GrowingMap,
    keyframes: impl IntoIterator<Item = (u32, &'a Keyframe)>,
    erased: &[EraserBox],
    settings: &MergeSettings,
) -> MergeReport {
    let mut report = MergeReport::default();
    for (number, keyframe) in keyframes {
        report = merge_vertices(map, keyframe, erased, number, settings);
    }
    map.refresh_skeletons(settings.skeleton_sigma_m);
    report
}

/// Merges the polylines of a keyframe, but for what lies in `erased` boxes; `number` tells the merges apart.
fn merge_vertices(
    map: &mut GrowingMap,
    keyframe: &Keyframe,
    erased: &[EraserBox],
    number: u32,
    settings: &MergeSettings,
) -> MergeReport {
    let (scan, map_from_scan) = (&keyframe.scan, keyframe.map_from_scan);
    let mut report = MergeReport::default();
    for polyline in keyframe.standing_polylines() {
        let points = simulate::scan_points(
            polyline,
            scan.geometry(),
            map_from_scan,
            number,
            settings.spacing_m,
        );
        for stretch in points.split(|p| erased.iter().any(|b| b.contains(p.vertex.point))) {
            thread(map, stretch, number, settings, &mut report);
        }
    }
    report.into.sort_unstable();
    report.into.dedup();
    report.seen_through = sight::clear_sight(map, scan, map_from_scan, number, settings);
    report
}

/// Threads the points of one polyline, seen by scan number `number`, through the map.
fn thread(
    map: &mut GrowingMap,
    mut points: &[ScanPoint],
    number: u32,
    settings: &MergeSettings,
    report: &mut MergeReport,
) {
    while !points.is_empty() {
        let runs = link::runs(map, points, settings.gate_m);
        let done = splice::splice(map, &runs, number, settings).max(1);
        for run in &runs[..done.min(runs.len())] {
            let count = if run.slot.is_some() {
                &mut report.known_points
            } else {
                &mut report.new_points
            };
            *count += run.points.len();
            report.into.extend(run.slot);
        }
        points = &points[runs.get(done).map_or(points.len(), |r| r.first)..];
    }
}
