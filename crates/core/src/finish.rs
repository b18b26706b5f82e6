//! Final pass (paper section 4): simplification and least squares over the whole map.

use crate::extract::simplify_chain;
use crate::geometry::Point;
use crate::keyframe::Keyframe;
use crate::map::{EraserBox, Map, MapPolyline, MapVertex};
use crate::merge::growing_map::GrowingMap;
use crate::merge::overlap::merge_overlaps;
use crate::merge::{MergeSettings, merge, sight};

/// The map of all keyframes, outside the boxes.
pub(crate) fn finish(keyframes: &[Keyframe], eraser_boxes: Vec<EraserBox>, settings: &MergeSettings) -> Map {
    let mut map = GrowingMap::default();
    for (number, keyframe) in (0..).zip(keyframes) {
        merge(&mut map, keyframe, &eraser_boxes, number, settings);
    }
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
    for (_, polyline) in map.polylines() {
        let points: Vec<Point> = polyline.vertices.iter().map(|v| v.point).collect();
        let weights = vec![1.0 / (0.01 * 0.01); points.len()];
        let vertices = simplify_chain(&points, &weights, 16.0)
            .into_iter()
            .map(|point| {
                let near = polyline
                    .vertices
                    .iter()
                    .min_by(|a, b| a.point.distance(point).total_cmp(&b.point.distance(point)));
                MapVertex {
                    point,
                    observations: near.map_or(0, |v| v.hits),
                    sigma_m: near.map_or(0.0, |v| v.sigma_m(0.01)),
                }
            })
            .collect();
        out.polylines.push(MapPolyline {
            id: polyline.id,
            vertices,
        });
    }
    out
}
