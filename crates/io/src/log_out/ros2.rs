//! The messages of ROS 2 with scans and poses, and their definitions (Humble and later), which stand in a recording
//! beside them.

use polymapper_core::geometry::Pose;
use polymapper_core::scan::Scan;

use super::cdr::Cdr;

/// Name of the map's frame (REP 105).
pub(crate) const MAP_FRAME: &str = "map";
/// Name of the scanner's frame.
pub(crate) const LASER_FRAME: &str = "laser";

/// Name of the frame of odometry (REP 105).
const ODOMETRY_FRAME: &str = "odom";

// What is in messages, each as a part of their definitions.
pub(crate) const HEADER: &str = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
pub(crate) const TIME: &str = "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";
pub(crate) const DURATION: &str = "MSG: builtin_interfaces/Duration\nint32 sec\nuint32 nanosec\n";
pub(crate) const POSE: &str = "MSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation\n";
pub(crate) const POINT: &str = "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n";
pub(crate) const QUATERNION: &str =
    "MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n";
pub(crate) const VECTOR: &str = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

/// A message type: its name, its definition, and the definitions of what is in it.
pub(crate) struct Type {
    /// `package/msg/Name`
    pub name: &'static str,
    /// Its own fields.
    pub definition: &'static str,
    /// The definitions of what is in it, [`HEADER`] and others.
    pub parts: &'static [&'static str],
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

pub(crate) const LASER_SCAN: Type = Type {
    name: "sensor_msgs/msg/LaserScan",
    definition: "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n\
                 float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n\
                 float32[] intensities\n",
    parts: &[HEADER, TIME],
};

pub(crate) const ODOMETRY: Type = Type {
    name: "nav_msgs/msg/Odometry",
    definition: "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/PoseWithCovariance pose\n\
                 geometry_msgs/TwistWithCovariance twist\n",
    parts: &[
        "MSG: geometry_msgs/PoseWithCovariance\nPose pose\nfloat64[36] covariance\n",
        "MSG: geometry_msgs/TwistWithCovariance\nTwist twist\nfloat64[36] covariance\n",
        "MSG: geometry_msgs/Twist\nVector3 linear\nVector3 angular\n",
        POSE,
        POINT,
        QUATERNION,
        VECTOR,
        HEADER,
        TIME,
    ],
};

pub(crate) const TF: Type = Type {
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

/// Nanoseconds of a stamp in seconds; a stamp that ROS cannot say, and none, is zero.
pub(crate) fn nanoseconds(stamp_s: Option<f64>) -> u64 {
    const SECOND_NS: f64 = 1e9;
    let Some(stamp_s) = stamp_s.filter(|s| (0.0..f64::from(i32::MAX)).contains(s)) else {
        return 0;
    };
    // In two steps: seconds since 1970 in nanoseconds are more than the digits of a float hold.
    let whole_s = stamp_s.floor();
    whole_s as u64 * SECOND_NS as u64 + ((stamp_s - whole_s) * SECOND_NS).round() as u64
}

/// A `LaserScan`; beams without return hold infinity (REP 117: nothing in reach).
pub(crate) fn laser_scan(time_ns: u64, scan: &Scan) -> Vec<u8> {
    let geometry = scan.geometry();
    let mut cdr = Cdr::new();
    header(&mut cdr, time_ns, LASER_FRAME);
    cdr.f32(geometry.bearing_rad(0) as f32);
    cdr.f32(geometry.bearing_rad(geometry.beams().saturating_sub(1)) as f32);
    cdr.f32(geometry.step_rad() as f32);
    cdr.f32(0.0);
    cdr.f32(0.0);
    cdr.f32(geometry.min_range_m() as f32);
    cdr.f32(geometry.max_range_m() as f32);
    cdr.count(scan.ranges_m().len());
    for &range_m in scan.ranges_m() {
        cdr.f32(if range_m.is_nan() {
            f32::INFINITY
        } else {
            range_m as f32
        });
    }
    cdr.count(0);
    cdr.bytes()
}

/// An `Odometry` of the laser, without covariance and speed.
pub(crate) fn odometry(time_ns: u64, odometry_from_laser: Pose) -> Vec<u8> {
    const COVARIANCE: usize = 36;
    const TWIST: usize = 6;
    let mut cdr = Cdr::new();
    header(&mut cdr, time_ns, ODOMETRY_FRAME);
    cdr.text(LASER_FRAME);
    pose(&mut cdr, odometry_from_laser);
    cdr.f64s([0.0; COVARIANCE + TWIST + COVARIANCE]);
    cdr.bytes()
}

/// Where the scanner is in the map.
pub(crate) fn tf(time_ns: u64, map_from_scan: Pose) -> Vec<u8> {
    let mut cdr = Cdr::new();
    cdr.count(1);
    header(&mut cdr, time_ns, MAP_FRAME);
    cdr.text(LASER_FRAME);
    pose(&mut cdr, map_from_scan);
    cdr.bytes()
}

/// A header: when, and in which frame.
pub(crate) fn header(cdr: &mut Cdr, time_ns: u64, frame: &str) {
    time(cdr, time_ns);
    cdr.text(frame);
}

/// A time, as seconds and nanoseconds.
pub(crate) fn time(cdr: &mut Cdr, time_ns: u64) {
    cdr.i32(i32::try_from(time_ns / 1_000_000_000).unwrap_or(i32::MAX));
    cdr.u32((time_ns % 1_000_000_000) as u32);
}

/// A pose, or a transform: the same seven numbers.
pub(crate) fn pose(cdr: &mut Cdr, pose: Pose) {
    let (sin, cos) = (0.5 * pose.theta_rad).sin_cos();
    cdr.f64s([pose.x, pose.y, 0.0, 0.0, 0.0, sin, cos]);
}
