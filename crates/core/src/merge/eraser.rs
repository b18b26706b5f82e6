//! Eraser boxes (paper section 4): where things have no stable shape, such as plants.
//!
//! In: the keyframes. Out: boxes, in the map, whose content is not merged. The returns from a plant jump to and fro from
//! beam to beam; three in a row that span an angle below 20° cannot come from a surface. A box bounds a run of such
//! returns; overlapping boxes are joined.
//!
//! Where we differ: the paper lets one scan erase an area for ever. Here a box stands when several keyframes, and a
//! fair share of those that saw the place, found it disordered. Angles are taken where both legs are longer than the
//! noise explains, because near walls the noise of the ranges alone makes sharp angles.

use crate::geometry::{Point, Pose};
use crate::keyframe::Keyframe;
use crate::map::EraserBox;
use crate::scan::Scan;

/// When an area is erased.
#[derive(Clone, Copy, Debug)]
pub struct EraserSettings {
    /// Inner angles below this are no surface, radians (paper: 20°).
    pub sharp_angle_rad: f64,
    /// Sharp angles in a row, at the least.
    pub least_run: usize,
    /// Keyframes that must have found disorder.
    pub least_keyframes: usize,
    /// Share of the keyframes that saw the place.
    pub least_share: f64,
    /// Edge of a box at the most, metres: a hedge gets several.
    pub most_edge_m: f64,
}

impl Default for EraserSettings {
    fn default() -> Self {
        Self {
            sharp_angle_rad: 20_f64.to_radians(),
            least_run: 4,
            least_keyframes: 3,
            least_share: 0.3,
            most_edge_m: 2.5,
        }
    }
}

/// Legs shorter than this many standard deviations of the range say nothing about the angle between them.
const LEG_SIGMAS: f64 = 5.0;
/// Legs longer than this lead to another object, metres.
const LONGEST_LEG_M: f64 = 1.0;
/// Returns in a box by which a keyframe counts as having seen it.
const SEEN_RETURNS: usize = 5;
/// Added on every side of a box, metres.
const RIM_M: f64 = 0.05;

/// Runs of returns that span sharp angles, laser frame.
pub(crate) fn disordered_runs(scan: &Scan, noise_m: f64, settings: &EraserSettings) -> Vec<Vec<Point>> {
    let points: Vec<Option<Point>> = (0..scan.geometry().beams())
        .map(|beam| scan.point(beam))
        .collect();
    let mut runs = Vec::new();
    let mut run: Vec<Point> = Vec::new();
    for three in points.windows(3) {
        let sharp = match three {
            [Some(u), Some(v), Some(w)] => is_disordered(*u, *v, *w, noise_m, settings).then_some(*v),
            _ => None,
        };
        match sharp {
            Some(v) => run.push(v),
            None if run.len() >= settings.least_run => runs.push(std::mem::take(&mut run)),
            None => run.clear(),
        }
    }
    if run.len() >= settings.least_run {
        runs.push(run);
    }
    runs
}

fn is_disordered(u: Point, v: Point, w: Point, noise_m: f64, settings: &EraserSettings) -> bool {
    let (a, b) = (u - v, w - v);
    let legs = [a.norm(), b.norm()];
    let inner_rad = a.cross(b).atan2(a.dot(b)).abs();
    inner_rad < settings.sharp_angle_rad
        && legs
            .iter()
            .all(|l| (LEG_SIGMAS * noise_m..LONGEST_LEG_M).contains(l))
}

/// The boxes that stand, map frame, disjoint, in order of their corners.
pub(crate) fn boxes(keyframes: &[Keyframe], settings: &EraserSettings) -> Vec<EraserBox> {
    let mut found: Vec<Found> = Vec::new();
    for (number, keyframe) in keyframes.iter().enumerate() {
        for run in keyframe.disordered_runs.iter() {
            found.push(Found {
                area: around(run, keyframe.map_from_scan),
                keyframes: vec![number],
            });
        }
    }
    let joined = join_overlapping(found, settings);
    let mut standing: Vec<Found> = joined
        .into_iter()
        .filter(|f| stands(f, keyframes, settings))
        .collect();
    // Joined boxes of different founding may still touch at the size limit; the paper wants one box there.
    standing = join_overlapping(
        standing,
        &EraserSettings {
            most_edge_m: f64::INFINITY,
            ..*settings
        },
    );
    let mut boxes: Vec<EraserBox> = standing.into_iter().map(|f| f.area).collect();
    boxes.sort_by(|a, b| a.min.x.total_cmp(&b.min.x).then(a.min.y.total_cmp(&b.min.y)));
    boxes
}

struct Found {
    area: EraserBox,
    /// Ascending.
    keyframes: Vec<usize>,
}

fn around(run: &[Point], map_from_scan: Pose) -> EraserBox {
    let (mut min, mut max) = (Point::new(f64::MAX, f64::MAX), Point::new(f64::MIN, f64::MIN));
    for p in map_from_scan.transform(run) {
        min = Point::new(min.x.min(p.x - RIM_M), min.y.min(p.y - RIM_M));
        max = Point::new(max.x.max(p.x + RIM_M), max.y.max(p.y + RIM_M));
    }
    EraserBox { min, max }
}

fn join_overlapping(found: Vec<Found>, settings: &EraserSettings) -> Vec<Found> {
    let mut joined: Vec<Found> = Vec::new();
    for mut new in found {
        while let Some(k) = joined.iter().position(|old| {
            let both = old.area.joined(&new.area);
            let edge_m = (both.max.x - both.min.x).max(both.max.y - both.min.y);
            old.area.overlaps(&new.area) && edge_m <= settings.most_edge_m
        }) {
            let old = joined.swap_remove(k);
            new.area = old.area.joined(&new.area);
            new.keyframes.extend(old.keyframes);
            new.keyframes.sort_unstable();
            new.keyframes.dedup();
        }
        joined.push(new);
    }
    joined
}

fn stands(found: &Found, keyframes: &[Keyframe], settings: &EraserSettings) -> bool {
    if found.keyframes.len() < settings.least_keyframes {
        return false;
    }
    // Counted no farther than is needed to tell, from where it was found on: the returns of all keyframes are many megabytes.
    let count = found.keyframes.len() as f64;
    let too_many = (count / settings.least_share + 2.0) as usize;
    let (before, since) = keyframes.split_at(found.keyframes[0]);
    let seeing = since.iter().chain(before).filter(|k| sees(k, &found.area));
    let seen = seeing.take(too_many).count();
    count >= settings.least_share * seen as f64
}

fn sees(keyframe: &Keyframe, area: &EraserBox) -> bool {
    let points = keyframe.points.iter().map(|p| &p.point);
    let places = keyframe.map_from_scan.transform(points);
    places
        .filter(|&p| area.contains(p))
        .nth(SEEN_RETURNS - 1)
        .is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scan::ScanGeometry;

    fn scan(ranges_m: impl Fn(usize) -> f64) -> Scan {
        let geometry = ScanGeometry::new(-0.5, 0.0175, 60).unwrap();
        Scan::new(geometry, (0..60).map(ranges_m).collect()).unwrap()
    }

    #[test]
    fn a_plant_before_a_wall_is_disordered_and_the_wall_is_not() {
        let settings = EraserSettings::default();
        let plant = scan(|k| {
            if (20..30).contains(&k) {
                2.0 + 0.25 * (k % 2) as f64
            } else {
                3.0
            }
        });
        let runs = disordered_runs(&plant, 0.01, &settings);
        assert_eq!(runs.len(), 1);
        assert!((8..=10).contains(&runs[0].len()), "{}", runs[0].len());
        let noisy_wall = scan(|k| 1.0 + 0.01 * ((k * 7) % 5) as f64);
        assert!(
            disordered_runs(&noisy_wall, 0.012, &settings).is_empty(),
            "noise is no plant"
        );
    }

    #[test]
    fn overlapping_boxes_become_one() {
        let at = |x: f64| Found {
            area: EraserBox {
                min: Point::new(x, 0.0),
                max: Point::new(x + 0.5, 0.5),
            },
            keyframes: vec![(x * 10.0) as usize],
        };
        let joined = join_overlapping(vec![at(0.0), at(2.0), at(0.4)], &EraserSettings::default());
        assert_eq!(joined.len(), 2);
        assert!(
            joined
                .iter()
                .any(|f| f.keyframes == [0, 4] && (f.area.max.x - 0.9).abs() < 1e-12)
        );
    }
}
