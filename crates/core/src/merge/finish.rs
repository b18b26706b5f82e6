//! Final pass (paper section 4): the map of all keyframes, cleaned, simplified and fitted by least squares.
//!
//! In: keyframes and eraser boxes. Out: the map. All keyframes are merged in order; what their beams looked through is
//! taken out, with the evidence of the whole log instead of the past alone; polylines that lie on others are merged
//! into them; each is divided into sides anew and its sides fitted.

use super::growing_map::{GrowingMap, GrowingPolyline, SIDE_PENALTY};
use super::overlap::merge_overlaps;
use super::{MergeSettings, merge_all, sight};
use crate::extract::simplify_chain;
use crate::geometry::Point;
use crate::keyframe::Keyframe;
use crate::map::{EraserBox, Map, MapPolyline, MapVertex};

/// The map of all keyframes, outside the boxes.
pub(crate) fn finish(keyframes: &[Keyframe], eraser_boxes: Vec<EraserBox>, settings: &MergeSettings) -> Map {
    let mut map = GrowingMap::default();
    merge_all(&mut map, keyframes, &eraser_boxes, settings);
    map.forget_looks();
    for (k, keyframe) in (0..).zip(keyframes) {
        sight::look(&mut map, &keyframe.scan, keyframe.map_from_scan, k, settings);
    }
    sight::clear_all(&mut map, settings);
    merge_overlaps(&mut map, settings);
    let mut out = Map {
        polylines: Vec::new(),
        eraser_boxes,
    };
    out.polylines
        .extend(map.polylines().map(|(_, p)| finished(p, settings)));
    out
}

/// A polyline with as few vertices as the noise supports, walls fitted by least squares.
fn finished(polyline: &GrowingPolyline, settings: &MergeSettings) -> MapPolyline {
    let sigma_m = settings.skeleton_sigma_m;
    let points: Vec<Point> = polyline.vertices.iter().map(|v| v.point).collect();
    let weights = vec![1.0 / (sigma_m * sigma_m); points.len()];
    let vertices = simplify_chain(&points, &weights, SIDE_PENALTY)
        .into_iter()
        .map(|point| {
            // A corner is where two fitted sides meet; it rests on what the vertex nearest to it rests on.
            let nearest = polyline
                .vertices
                .iter()
                .min_by(|a, b| a.point.distance(point).total_cmp(&b.point.distance(point)));
            MapVertex {
                point,
                observations: nearest.map_or(0, |v| v.hits),
                sigma_m: nearest.map_or(sigma_m, |v| v.sigma_m(sigma_m)),
            }
        })
        .collect();
    MapPolyline {
        id: polyline.id,
        vertices,
    }
}
