//! The map as features for GIS formats: a layer, properties, a geometry. Coordinates go through a function given.

use polymapper_core::geometry::Point;
use serde_json::{Map as JsonMap, Value, json};

use super::extent::corners;
use super::{ERASER_BOXES, Subject, WALLS, WAY};

/// Coordinate system of maps without a place on Earth, as JSON-FG names it (OGC 21-045r1, 7.5.3): "for unknown
/// coordinate reference systems, such as with CAD engineering drawings".
pub(crate) const ENGINEERING_2D: &str = "http://www.opengis.net/def/crs/OGC/0/Engineering2D";

/// Layer, id in the layer, properties, kind of geometry, points in the map frame.
pub(super) struct Feature {
    pub layer: &'static str,
    pub id: u64,
    pub properties: JsonMap<String, Value>,
    /// A closed area; its first point is not repeated.
    pub is_area: bool,
    pub points: Vec<Point>,
}

/// Walls, eraser boxes, pieces of the way, in this order.
pub(super) fn features(subject: &Subject<'_>) -> Vec<Feature> {
    let walls = subject.map.polylines.iter().map(|polyline| {
        let vertices = &polyline.vertices;
        let observations: Vec<u32> = vertices.iter().map(|v| v.observations).collect();
        let sigma_m: Vec<Option<f64>> = vertices
            .iter()
            .map(|v| {
                v.sigma_m
                    .is_finite()
                    .then(|| crate::out::decimals::rounded_5(v.sigma_m))
            })
            .collect();
        Feature {
            layer: WALLS,
            id: polyline.id,
            properties: properties(json!({
                "layer": WALLS, "id": polyline.id, "observations": observations, "sigma_m": sigma_m
            })),
            is_area: false,
            points: vertices.iter().map(|v| v.point).collect(),
        }
    });
    let boxes = subject.map.eraser_boxes.iter().zip(0..).map(|(b, id)| Feature {
        layer: ERASER_BOXES,
        id,
        properties: properties(json!({"layer": ERASER_BOXES})),
        is_area: true,
        points: corners(b).to_vec(),
    });
    let way = subject
        .way_pieces()
        .into_iter()
        .zip(0..)
        .map(|(points, id)| Feature {
            layer: WAY,
            id,
            properties: properties(json!({"layer": WAY})),
            is_area: false,
            points,
        });
    walls.chain(boxes).chain(way).collect()
}

fn properties(value: Value) -> JsonMap<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => JsonMap::new(),
    }
}
