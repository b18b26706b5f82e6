//! The messages that are written, and their definitions as MCAP wants them beside the data (`ros2msg`: the message,
//! then every type it uses).

use polymapper_core::geometry::Pose;
use polymapper_core::scan::Scan;

use super::cdr::Cdr;

/// Name and definition of a type.
pub(super) struct Definition {
    pub name: &'static str,
    pub text: &'static str,
}

pub(super) const LASER_SCAN: Definition = Definition {
    name: "sensor_msgs/msg/LaserScan",
    text: "std_msgs/Header header
float32 angle_min
float32 angle_max
float32 angle_increment
float32 time_increment
float32 scan_time
float32 range_min
float32 range_max
float32[] ranges
float32[] intensities
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
",
};

pub(super) const ODOMETRY: Definition = Definition {
    name: "nav_msgs/msg/Odometry",
    text: "std_msgs/Header header
string child_frame_id
geometry_msgs/PoseWithCovariance pose
geometry_msgs/TwistWithCovariance twist
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: geometry_msgs/PoseWithCovariance
geometry_msgs/Pose pose
float64[36] covariance
================================================================================
MSG: geometry_msgs/Pose
geometry_msgs/Point position
geometry_msgs/Quaternion orientation
================================================================================
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
================================================================================
MSG: geometry_msgs/TwistWithCovariance
geometry_msgs/Twist twist
float64[36] covariance
================================================================================
MSG: geometry_msgs/Twist
geometry_msgs/Vector3 linear
geometry_msgs/Vector3 angular
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
",
};

const LASER_FRAME: &str = "laser";

/// A time as ROS 2 has it; times that it cannot hold are zero.
#[derive(Clone, Copy)]
pub(super) struct Time {
    pub seconds: u32,
    pub nanoseconds: u32,
}

impl Time {
    pub fn of(stamp_s: Option<f64>) -> Self {
        let zero = Self {
            seconds: 0,
            nanoseconds: 0,
        };
        let Some(stamp_s) = stamp_s.filter(|s| (0.0..f64::from(i32::MAX)).contains(s)) else {
            return zero;
        };
        let whole = stamp_s.floor();
        let nanoseconds = ((stamp_s - whole) * 1e9).round() as u32;
        if nanoseconds >= 1_000_000_000 {
            return Self {
                seconds: whole as u32 + 1,
                nanoseconds: 0,
            };
        }
        Self {
            seconds: whole as u32,
            nanoseconds,
        }
    }

    pub fn nanoseconds_in_all(self) -> u64 {
        u64::from(self.seconds) * 1_000_000_000 + u64::from(self.nanoseconds)
    }
}

fn header(cdr: &mut Cdr, time: Time, frame: &str) {
    cdr.u32(time.seconds);
    cdr.u32(time.nanoseconds);
    cdr.text(frame);
}

/// A `LaserScan`; beams without return hold infinity (REP 117: nothing in reach).
pub(super) fn laser_scan(scan: &Scan, time: Time) -> Vec<u8> {
    let geometry = scan.geometry();
    let beams = geometry.beams();
    let mut cdr = Cdr::new();
    header(&mut cdr, time, LASER_FRAME);
    cdr.f32(geometry.bearing_rad(0));
    cdr.f32(geometry.bearing_rad(beams.saturating_sub(1)));
    cdr.f32(geometry.step_rad());
    cdr.f32(0.0);
    cdr.f32(0.0);
    cdr.f32(geometry.min_range_m());
    cdr.f32(geometry.max_range_m());
    cdr.u32(beams as u32);
    for &range_m in scan.ranges_m() {
        cdr.f32(if range_m.is_nan() { f64::INFINITY } else { range_m });
    }
    cdr.u32(0);
    cdr.into_bytes()
}

/// An `Odometry` of the laser.
pub(super) fn odometry(pose: Pose, time: Time) -> Vec<u8> {
    let mut cdr = Cdr::new();
    header(&mut cdr, time, "odom");
    cdr.text(LASER_FRAME);
    let half_rad = 0.5 * pose.theta_rad;
    for number in [pose.x, pose.y, 0.0, 0.0, 0.0, half_rad.sin(), half_rad.cos()] {
        cdr.f64(number);
    }
    const COVARIANCE: usize = 36;
    const TWIST: usize = 6;
    for _ in 0..COVARIANCE + TWIST + COVARIANCE {
        cdr.f64(0.0);
    }
    cdr.into_bytes()
}
