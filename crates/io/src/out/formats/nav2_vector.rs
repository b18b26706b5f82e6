//! Parameters of the Nav2 vector object server (`nav2_map_server`, `vector_object_server`).
//!
//! Every polyline is an open polygon: `closed: true` would fill it. The server draws from each point to the next
//! and wants three points at least (`Polygon::obtainParams`), so a wall of two vertices gets its middle as a
//! third. Points are float parameters: a number without a decimal point would be refused. Eraser boxes are filled
//! polygons.

use std::fmt::Write as _;
use std::io::Write;

use polymapper_core::geometry::Point;

use super::extent::corners;
use super::text::metres;
use super::{ExportError, Place, Subject};

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let mut shapes = Vec::new();
    for polyline in &subject.map.polylines {
        let mut points: Vec<Point> = polyline.vertices.iter().map(|v| v.point).collect();
        if let [a, b] = points[..] {
            points.insert(1, (a + b) * 0.5);
        }
        shapes.push((format!("polyline_{}", polyline.id), false, points));
    }
    for (k, b) in subject.map.eraser_boxes.iter().enumerate() {
        shapes.push((format!("eraser_box_{k}"), true, corners(b).to_vec()));
    }
    let names: Vec<String> = shapes.iter().map(|(name, ..)| format!("\"{name}\"")).collect();
    let mut text = format!(
        "vector_object_server:\n  ros__parameters:\n    map_topic: \"vo_map\"\n    global_frame_id: \"map\"\n    \
         resolution: {:?}\n    default_value: -1\n    overlay_type: 0\n    update_frequency: 1.0\n    \
         transform_tolerance: 0.1\n    shapes: [{}]\n",
        subject.options.resolution_m,
        names.join(", ")
    );
    for (name, filled, points) in &shapes {
        let numbers: Vec<String> = points.iter().flat_map(|p| [metres(p.x), metres(p.y)]).collect();
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "    {name}:\n      type: \"polygon\"\n      frame_id: \"map\"\n      closed: {filled}\n      value: 100\n      \
             points: [{}]\n",
            numbers.join(", ")
        );
    }
    place.write(0, |f| f.write_all(text.as_bytes()))
}
