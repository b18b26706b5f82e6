//! Final pass (paper section 4): the map of all keyframes, cleaned, simplified and fitted by least squares.
//!
//! In: keyframes and eraser boxes. Out: the map. All keyframes are merged in order; what their beams looked through is
//! taken out, with the evidence of the whole log instead of the past alone; polylines that lie on others are merged
//! into them; all are laid on the returns (`refit`) and traced anew where no return lies on them (`retrace`); stubs go; each
//! is divided into sides anew and its sides fitted.

use super::growing_map::{GrowingMap, GrowingPolyline, SIDE_PENALTY, Vertex};
use super::refit::refit;
use super::retrace::retrace;
use super::stubs::clear_stubs;
use super::{MergeSettings, merge_all, sight};
use crate::extract::simplify_chain;
use crate::geometry::Point;
use crate::keyframe::Keyframe;
use crate::map::{EraserBox, Map, MapPolyline, MapVertex};

/// The map of all keyframes, outside the boxes.
pub(crate) fn finish(keyframes: &[Keyframe], eraser_boxes: Vec<EraserBox>, settings: &MergeSettings) -> Map {
    let mut map = GrowingMap::default();
    merge_all(&mut map, (0..).zip(keyframes), &eraser_boxes, settings);
    map.forget_looks();
    for (k, keyframe) in (0..).zip(keyframes) {
        sight::look(&mut map, &keyframe.scan, keyframe.map_from_scan, k, settings);
    }
    sight::clear_all(&mut map, keyframes, settings);
    cut_gaps(&mut map);
    let covered = refit(&mut map, keyframes, settings);
    retrace(&mut map, &covered, keyframes, settings);
    clear_stubs(&mut map, settings);
    let mut out = Map {
        polylines: Vec::new(),
        eraser_boxes,
    };
    out.polylines
        .extend(map.polylines().map(|(_, p)| finished(p, settings)));
    out
}

/// Vertices of the growing map are some centimetres apart, on far walls seen at a grazing angle up to a metre. A side longer than
/// this was joined over what nobody saw; where nobody could look through it, no beam takes it out.
const WIDEST_GAP_M: f64 = 1.5;

/// Cuts polylines where no return lies between two vertices.
fn cut_gaps(map: &mut GrowingMap) {
    let slots: Vec<u32> = map.polylines().map(|(slot, _)| slot).collect();
    for slot in slots {
        let is_close = |a: &Vertex, b: &Vertex| a.point.distance(b.point) <= WIDEST_GAP_M;
        let Some(polyline) = map.polyline(slot) else {
            continue;
        };
        let pieces: Vec<Vec<Vertex>> = polyline.vertices.chunk_by(is_close).map(<[_]>::to_vec).collect();
        if pieces.len() > 1 {
            map.replace_by(slot, pieces.into_iter().filter(|piece| piece.len() > 1));
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_walls_that_were_joined_over_what_nobody_saw_are_cut_apart() {
        let near = (0..30).map(|k| Vertex::new(Point::new(0.04 * f64::from(k), 0.0), 0));
        let far = (0..30).map(|k| Vertex::new(Point::new(7.0 + 0.04 * f64::from(k), -11.0), 0));
        let mut map = GrowingMap::default();
        map.add(near.chain(far).collect());
        cut_gaps(&mut map);
        let spans_m: Vec<f64> = map.polylines().map(|(_, p)| p.span_m()).collect();
        assert_eq!(spans_m.len(), 2);
        assert!(
            spans_m.iter().all(|span_m| (span_m - 1.16).abs() < 1e-9),
            "{spans_m:?}"
        );
    }
}
