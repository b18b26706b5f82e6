//! The messages, with the definitions (ROS 2 Humble and later) that stand in the file beside them.

use polymapper_core::geometry::{Point, Pose};
use polymapper_core::map::Map;
use polymapper_core::scan::{Scan, ScanGeometry};

use super::cdr::Cdr;
use crate::out::formats::grid::{Cell, Grid};
use crate::out::formats::subject::PlacedRow;

/// Name of the map's frame (REP 105).
pub(super) const MAP_FRAME: &str = "map";
/// Name of the scanner's frame.
pub(super) const LASER_FRAME: &str = "laser";

const HEADER: &str = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
const TIME: &str = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
const DURATION: &str = "MSG: builtin_interfaces/Duration\nint32 sec\nuint32 nanosec\n";
const POSE: &str = "MSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n";
const POINT: &str = "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n";
const QUATERNION: &str =
    "MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";
const VECTOR: &str = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

/// A message type: its name, its definition, and the definitions of what is in it.
pub(super) struct Type {
    pub name: &'static str,
    definition: &'static str,
    parts: &'static [&'static str],
}

impl Type {
    /// The definition with all that is in it, as MCAP wants it for the encoding `ros2msg`.
    pub fn schema(&self) -> String {
        let mut text = self.definition.to_owned();
        for part in self.parts {
            text.push_str(&"=".repeat(80));
            text.push('\n');
            text.push_str(part);
        }
        text
    }
}

pub(super) const LASER_SCAN: Type = Type {
    name: "sensor_msgs/msg/LaserScan",
    definition: "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
                 float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n\
                 float32[] intensities\n",
    parts: &[HEADER, TIME],
};

pub(super) const TF: Type = Type {
    name: "tf2_msgs/msg/TFMessage",
    definition: "geometry_msgs/TransformStamped[] transforms\n",
    parts: &[
        "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\nTransform transform\n",
        "MSG: geometry_msgs/Transform\nVector3 translation\nQuaternion rotation\n",
        VECTOR,
        QUATERNION,
        HEADER,
        TIME,
    ],
};

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

/// Nanoseconds of a time in seconds; times below 0 and beyond what ROS can say are its ends.
pub(super) fn nanoseconds(time_s: f64) -> u64 {
    // A cast of a float to a whole number takes the nearest end.
    ((time_s * 1e9).round() as u64).min(i32::MAX as u64 * 1_000_000_000)
}

/// A scan. What gave no return is NaN (REP 117: invalid), since nobody knows any more whether it was out of
/// reach.
pub(super) fn laser_scan(time_ns: u64, scan: &Scan) -> Vec<u8> {
    let geometry = scan.geometry();
    let mut cdr = Cdr::new();
    header(&mut cdr, time_ns, LASER_FRAME);
    cdr.f32(geometry.bearing_rad(0) as f32);
    cdr.f32(geometry.bearing_rad(geometry.beams().saturating_sub(1)) as f32);
    cdr.f32(geometry.step_rad() as f32);
    cdr.f32(0.0);
    cdr.f32(0.0);
    cdr.f32(ScanGeometry::SHORTEST_RANGE_M as f32);
    cdr.f32(ScanGeometry::LONGEST_RANGE_M as f32);
    cdr.count(scan.ranges_m().len());
    scan.ranges_m()
        .iter()
        .for_each(|&range_m| cdr.f32(range_m as f32));
    cdr.count(0);
    cdr.bytes()
}

/// Where the scanner is in the map.
pub(super) fn tf(time_ns: u64, map_from_scan: Pose) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.count(1);
    header(&mut cdr, time_ns, MAP_FRAME);
    cdr.text(LASER_FRAME);
    pose(&mut cdr, map_from_scan);
    cdr.bytes()
}

/// The way of the scanner.
pub(super) fn path(time_ns: u64, rows: &[PlacedRow]) -> Vec<u8> {
    let mut cdr = Cdr::new();
    header(&mut cdr, time_ns, MAP_FRAME);
    cdr.count(rows.len());
    for row in rows {
        header(&mut cdr, nanoseconds(row.time_s), MAP_FRAME);
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
        let corner = Point::new;
        let ring = [
            b.min,
            corner(b.max.x, b.min.y),
            b.max,
            corner(b.min.x, b.max.y),
            b.min,
        ];
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

fn header(cdr: &mut Cdr, time_ns: u64, frame: &str) {
    time(cdr, time_ns);
    cdr.text(frame);
}

fn time(cdr: &mut Cdr, time_ns: u64) {
    cdr.i32(i32::try_from(time_ns / 1_000_000_000).unwrap_or(i32::MAX));
    cdr.u32((time_ns % 1_000_000_000) as u32);
}

/// A pose, or a transform: the same seven numbers.
fn pose(cdr: &mut Cdr, pose: Pose) {
    let (sin, cos) = (0.5 * pose.theta_rad).sin_cos();
    cdr.f64s([pose.x, pose.y, 0.0, 0.0, 0.0, sin, cos]);
}
