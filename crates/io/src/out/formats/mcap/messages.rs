//! The messages about a map, with the definitions (ROS 2 Humble and later) that stand in the file beside them.

use polymapper_core::geometry::{Point, Pose};
use polymapper_core::map::Map;

use crate::log_out::cdr::Cdr;
use crate::log_out::ros2::{
    DURATION, HEADER, MAP_FRAME, POINT, POSE, QUATERNION, TIME, Type, VECTOR, header, nanoseconds, pose, time,
};
use crate::out::formats::extent::corners;
use crate::out::formats::grid::{Cell, Grid};
use crate::out::formats::subject::PlacedRow;

pub(super) const PATH: Type = Type {
    name: "nav_msgs/msg/Path",
    definition: "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n",
    parts: &[
        "MSG: geometry_msgs/PoseStamped\nstd_msgs/Header header\nPose pose\n",
        POSE,
        POINT,
        QUATERNION,
        HEADER,
        TIME,
    ],
};

pub(super) const OCCUPANCY_GRID: Type = Type {
    name: "nav_msgs/msg/OccupancyGrid",
    definition: "std_msgs/Header header\nMapMetaData info\nint8[] data\n",
    parts: &[
        "MSG: nav_msgs/MapMetaData\nbuiltin_interfaces/Time map_load_time\nfloat32 resolution\nuint32 width\n\
         uint32 height\ngeometry_msgs/Pose origin\n",
        POSE,
        POINT,
        QUATERNION,
        HEADER,
        TIME,
    ],
};

pub(super) const MARKER_ARRAY: Type = Type {
    name: "visualization_msgs/msg/MarkerArray",
    definition: "Marker[] markers\n",
    parts: &[
        "MSG: visualization_msgs/Marker\nstd_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n\
         geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n\
         builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n\
         std_msgs/ColorRGBA[] colors\nstring texture_resource\nsensor_msgs/CompressedImage texture\n\
         UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\nMeshFile mesh_file\n\
         bool mesh_use_embedded_materials\n",
        "MSG: std_msgs/ColorRGBA\nfloat32 r\nfloat32 g\nfloat32 b\nfloat32 a\n",
        "MSG: sensor_msgs/CompressedImage\nstd_msgs/Header header\nstring format\nuint8[] data\n",
        "MSG: visualization_msgs/UVCoordinate\nfloat32 u\nfloat32 v\n",
        "MSG: visualization_msgs/MeshFile\nstring filename\nuint8[] data\n",
        POSE,
        POINT,
        QUATERNION,
        VECTOR,
        HEADER,
        TIME,
        DURATION,
    ],
};

/// The way of the scanner.
pub(super) fn path(time_ns: u64, rows: &[PlacedRow]) -> Vec<u8> {
    let mut cdr = Cdr::new();
    header(&mut cdr, time_ns, MAP_FRAME);
    cdr.count(rows.len());
    for row in rows {
        header(&mut cdr, nanoseconds(Some(row.time_s)), MAP_FRAME);
        pose(&mut cdr, row.map_from_scan);
    }
    cdr.bytes()
}

/// The grid: −1 unknown, 0 free, 100 occupied.
pub(super) fn occupancy_grid(time_ns: u64, grid: &Grid) -> Vec<u8> {
    let mut cdr = Cdr::new();
    header(&mut cdr, time_ns, MAP_FRAME);
    time(&mut cdr, time_ns);
    cdr.f32(grid.resolution_m as f32);
    cdr.count(grid.width);
    cdr.count(grid.height);
    pose(&mut cdr, Pose::new(grid.origin.x, grid.origin.y, 0.0));
    cdr.count(grid.cells.len());
    for cell in &grid.cells {
        cdr.u8(match cell {
            Cell::Unknown => u8::MAX,
            Cell::Free => 0,
            Cell::Occupied => 100,
        });
    }
    cdr.bytes()
}

const LINE_STRIP: i32 = 4;
const WALL_WIDTH_M: f64 = 0.04;
const INK: [f32; 4] = [0.1, 0.1, 0.1, 1.0];
const ORANGE: [f32; 4] = [0.9, 0.5, 0.13, 1.0];

/// The lines of the map: a line strip a polyline (`walls`), closed line strips for the eraser boxes.
pub(super) fn markers(time_ns: u64, map: &Map) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.count(map.polylines.len() + map.eraser_boxes.len());
    for (k, polyline) in map.polylines.iter().enumerate() {
        let points: Vec<Point> = polyline.vertices.iter().map(|v| v.point).collect();
        // ids of markers have 32 bits; a polyline whose id has more goes by its place.
        let id = i32::try_from(polyline.id).unwrap_or(k as i32);
        line_strip(&mut cdr, time_ns, "walls", id, INK, &points);
    }
    for (k, b) in map.eraser_boxes.iter().enumerate() {
        let [first, second, third, fourth] = corners(b);
        let ring = [first, second, third, fourth, first];
        line_strip(&mut cdr, time_ns, "eraser boxes", k as i32, ORANGE, &ring);
    }
    cdr.bytes()
}

fn line_strip(cdr: &mut Cdr, time_ns: u64, namespace: &str, id: i32, colour: [f32; 4], points: &[Point]) {
    header(cdr, time_ns, MAP_FRAME);
    cdr.text(namespace);
    cdr.i32(id);
    cdr.i32(LINE_STRIP);
    cdr.i32(0);
    pose(cdr, Pose::IDENTITY);
    cdr.f64s([WALL_WIDTH_M, 0.0, 0.0]);
    colour.into_iter().for_each(|v| cdr.f32(v));
    // For ever.
    cdr.i32(0);
    cdr.u32(0);
    cdr.bool(false);
    cdr.count(points.len());
    for p in points {
        cdr.f64s([p.x, p.y, 0.0]);
    }
    cdr.count(0);
    // No texture, no text, no mesh.
    cdr.text("");
    header(cdr, 0, "");
    cdr.text("");
    cdr.count(0);
    cdr.count(0);
    cdr.text("");
    cdr.text("");
    cdr.text("");
    cdr.count(0);
    cdr.bool(false);
}
