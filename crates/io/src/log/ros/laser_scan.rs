//! A `LaserScan` as a scan of ours.
//!
//! In go angles and ranges as the driver wrote them, out comes a geometry with counter-clockwise bearings. A
//! negative increment is a scanner that turns clockwise; one that hangs upside down turns clockwise as seen from
//! above: the beam at +b looks to −b of the levelled scanner, whose x axis stays where it was. REP 117 (−inf too
//! near, +inf nothing in reach, NaN no measurement) needs no care: none of them is a range.

use polymapper_core::geometry::Pose;
use polymapper_core::scan::ScanGeometry;

use super::super::LineFault;
use super::super::keeper::{Keeper, Reading};
use super::messages::LaserScan;
use super::mount::Mount;

/// An increment below this was not filled in; the limits of the angles are used instead.
const LEAST_STEP_RAD: f64 = 1e-6;
/// A scanner that leans more than this measures walls too far; said, not corrected.
const MOST_LEAN_DEG: f64 = 5.0;

/// The signed angle from beam to beam.
fn step_rad(scan: &LaserScan) -> f64 {
    if scan.angle_increment_rad.abs() >= LEAST_STEP_RAD {
        return scan.angle_increment_rad;
    }
    let gaps = scan.ranges_m.len().saturating_sub(1).max(1);
    (scan.angle_max_rad - scan.angle_min_rad) / gaps as f64
}

pub(super) fn field_of_view_rad(scan: &LaserScan) -> f64 {
    let width = step_rad(scan).abs() * scan.ranges_m.len() as f64;
    if width.is_finite() {
        width.min(std::f64::consts::TAU)
    } else {
        0.0
    }
}

/// Beams with a range within the limits of the message.
pub(super) fn returns(scan: &LaserScan) -> u64 {
    let is_return = |&&r: &&f64| r >= scan.range_min_m && r < scan.range_max_m;
    scan.ranges_m.iter().filter(is_return).count() as u64
}

/// The scan as a reading.
///
/// # Errors
/// Angles that make no sense.
pub(super) fn reading(
    scan: LaserScan,
    upside_down: bool,
    stamp_s: f64,
    odometry: Option<Pose>,
) -> Result<Reading, LineFault> {
    let mut step_rad = step_rad(&scan);
    let mut first_rad = scan.angle_min_rad;
    let mut ranges_m = scan.ranges_m;
    let beams = ranges_m.len();
    if upside_down {
        first_rad = -first_rad;
        step_rad = -step_rad;
    }
    if step_rad < 0.0 {
        first_rad += step_rad * beams.saturating_sub(1) as f64;
        step_rad = -step_rad;
        ranges_m.reverse();
    }
    let geometry = ScanGeometry::new(first_rad, step_rad, beams)?;
    Ok(Reading {
        geometry: geometry.with_limits(scan.range_min_m, scan.range_max_m),
        ranges_m,
        stamp_s: Some(stamp_s),
        odometry,
    })
}

/// Notes what is odd about a scan and its mounting.
pub(super) fn check(scan: &LaserScan, mount: &Mount, keeper: &mut Keeper) {
    if scan.header.stamp_s <= 0.0 {
        keeper.note("scans without a stamp: the time of recording is taken".to_owned());
    }
    if scan.angle_increment_rad < 0.0 {
        keeper.note("the scanner turns clockwise: its beams are turned round".to_owned());
    }
    let gaps = scan.ranges_m.len().saturating_sub(1) as f64;
    let last_rad = scan.angle_min_rad + step_rad(scan) * gaps;
    let off_steps = (last_rad - scan.angle_max_rad).abs() / step_rad(scan).abs().max(LEAST_STEP_RAD);
    if off_steps > 1.5 {
        keeper.note(format!(
            "angle_max is {:.2}°, but {} beams every {:.4}° from {:.2}° end at {:.2}°: the beams are believed",
            scan.angle_max_rad.to_degrees(),
            scan.ranges_m.len(),
            step_rad(scan).to_degrees(),
            scan.angle_min_rad.to_degrees(),
            last_rad.to_degrees(),
        ));
    }
    if mount.is_upside_down() {
        keeper.note(format!(
            "{} is mounted upside down by the static transforms: its beams are turned round",
            scan.header.frame
        ));
    }
    if mount.lean_deg() > MOST_LEAN_DEG {
        keeper.note(format!(
            "{} leans by {:.0}° by the static transforms: taken as level",
            scan.header.frame,
            mount.lean_deg()
        ));
    }
}
