//! Numbers as the exports write them.

use crate::out::decimals::rounded_4;

/// Metres to 0.1 mm with the fewest digits, always with a decimal point: ROS parameters tell `1` and `1.0` apart.
pub(super) fn metres(value: f64) -> String {
    format!("{:?}", rounded_4(value))
}
