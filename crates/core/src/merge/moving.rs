//! Moving objects (paper section 4): matched by shape to an object of the scan before, but somewhere else after
//! alignment.
//!
//! In: the keyframes with the newest at the end, the map before the newest is merged. Out: which polylines of which
//! keyframes belong to moving objects, the object's earlier appearances among them; the map is then made again without.
//!
//! The paper asks for shape and distance. Shape alone says little of things of the size of a leg, so we ask visibility
//! too: the new place was free in the scan before, and the old place is free now.

use super::growing_map::GrowingMap;
use crate::extract::ScanPolyline;
use crate::geometry::{Near, Point};
use crate::keyframe::Keyframe;
use crate::shape::{Shape, similarity};

/// When an object has moved.
#[derive(Clone, Copy, Debug)]
pub struct MovingSettings {
    /// Objects wider than this are not looked at, metres.
    pub widest_m: f64,
    /// Way between two keyframes at the least and at the most, metres: from where two places cannot be the same to
    /// a brisk walk of one second.
    pub least_way_m: f64,
    /// See `least_way_m`.
    pub most_way_m: f64,
    /// S(C, D) at the most, rad². The 95 % quantile of true pairs is 0.04; a walking leg turns.
    pub most_unlike_rad2: f64,
    /// Share of the object's points whose place must be seen to be free.
    pub least_free: f64,
}

impl Default for MovingSettings {
    fn default() -> Self {
        Self {
            widest_m: 1.2,
            least_way_m: 0.15,
            most_way_m: 1.5,
            most_unlike_rad2: 0.1,
            least_free: 0.6,
        }
    }
}

/// A polyline of a keyframe: numbers of both.
pub(crate) type Appearance = (usize, usize);

/// All appearances of objects that moved between the last two keyframes.
pub(crate) fn find_moving(
    keyframes: &[Keyframe],
    map: &GrowingMap,
    settings: &MovingSettings,
) -> Vec<Appearance> {
    let Some(newest) = keyframes.len().checked_sub(1).filter(|&n| n > 0) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for number in 0..keyframes[newest].extraction.polylines.len() {
        let Some(object) = Object::of(keyframes, (newest, number), settings) else {
            continue;
        };
        if is_known(&object, map, settings) {
            continue;
        }
        if let Some(before) = earlier(keyframes, &object, settings).filter(|b| !b.stands(&object, settings)) {
            found.push(object.appearance);
            trace_back(keyframes, before, settings, &mut found);
        }
    }
    found
}

/// Adds an appearance and those before it, back to the first.
fn trace_back(
    keyframes: &[Keyframe],
    object: Object,
    settings: &MovingSettings,
    found: &mut Vec<Appearance>,
) {
    let mut object = Some(object);
    while let Some(o) = object {
        let (keyframe, polyline) = o.appearance;
        if keyframes[keyframe].is_moving[polyline] || found.contains(&o.appearance) {
            return;
        }
        found.push(o.appearance);
        object = earlier(keyframes, &o, settings);
    }
}

/// A small thing in a scan.
struct Object {
    appearance: Appearance,
    shape: Shape,
    /// Map frame.
    points: Vec<Point>,
    middle: Point,
}

impl Object {
    fn of(keyframes: &[Keyframe], appearance: Appearance, settings: &MovingSettings) -> Option<Self> {
        let keyframe = &keyframes[appearance.0];
        let ScanPolyline { polyline, .. } = &keyframe.extraction.polylines[appearance.1];
        if polyline.length_m() > settings.widest_m {
            return None;
        }
        let points: Vec<Point> = polyline
            .sides()
            .flat_map(|s| [s.a, s.at(0.5), s.b])
            .map(|p| keyframe.map_from_scan * p)
            .collect();
        let middle = points.iter().fold(Point::default(), |sum, &p| sum + p) / points.len() as f64;
        Some(Self {
            appearance,
            shape: Shape::new(polyline)?,
            points,
            middle,
        })
    }

    fn stands(&self, other: &Self, settings: &MovingSettings) -> bool {
        self.middle.distance(other.middle) < settings.least_way_m
    }
}

/// Whether most of the object lies on the map.
fn is_known(object: &Object, map: &GrowingMap, settings: &MovingSettings) -> bool {
    let near = Near {
        direction: Point::new(1.0, 0.0),
        min_cos: -1.0,
        max_distance_m: settings.least_way_m,
        beyond_ends: true,
    };
    let mut reader = map.dense.reader();
    let known = object
        .points
        .iter()
        .filter(|&&p| reader.nearest(p, &near, |_| true).is_some())
        .count();
    2 * known > object.points.len()
}

/// The same object in the keyframe before: the most alike of those that stand where it stands, or that are gone now
/// from a place near by while its own place was free then.
fn earlier(keyframes: &[Keyframe], object: &Object, settings: &MovingSettings) -> Option<Object> {
    let now = &keyframes[object.appearance.0];
    let number = object.appearance.0.checked_sub(1)?;
    let then = &keyframes[number];
    let was_free = free_share(then, &object.points) >= settings.least_free;
    (0..then.extraction.polylines.len())
        .filter_map(|k| Object::of(keyframes, (number, k), settings))
        .filter(|o| o.middle.distance(object.middle) <= settings.most_way_m)
        .filter(|o| {
            o.stands(object, settings) || (was_free && free_share(now, &o.points) >= settings.least_free)
        })
        .filter_map(|o| {
            let alike = similarity(&o.shape, &object.shape, settings.most_unlike_rad2)?;
            (alike.cost_rad2 <= settings.most_unlike_rad2).then_some((alike.cost_rad2, o))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, o)| o)
}

/// Share of the points (map frame) that the keyframe's beams passed: they returned from well behind, or not at all.
fn free_share(keyframe: &Keyframe, points: &[Point]) -> f64 {
    const BEHIND_M: f64 = 0.3;
    let scan_from_map = keyframe.map_from_scan.inverse();
    let passed = points.iter().filter(|&&p| {
        let seen = scan_from_map * p;
        let beam = keyframe.scan.beam_at(seen.bearing_rad());
        let range_m = beam.and_then(|beam| keyframe.scan.ranges_m().get(beam));
        range_m.is_some_and(|r| r.is_nan() || *r > seen.norm() + BEHIND_M)
    });
    passed.count() as f64 / points.len().max(1) as f64
}
