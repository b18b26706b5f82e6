//! CARMEN log of the placed scans with the poses of the map in place of odometry.
//!
//! Scans of 180 or 181 beams 1° apart and of 360 or 361 beams 0.5° apart from −90° are `FLASER` lines, which old
//! tools read; all others `ROBOTLASER1`, which hold their geometry. No return is written as 81.83 m, the code of
//! the published logs, beyond what any reader takes for a wall.

use std::f64::consts::{FRAC_PI_2, PI};
use std::io::{self, Write};

use polymapper_core::scan::{Scan, ScanGeometry};

use super::{ExportError, Place, PlacedScan, Subject};

const NO_RETURN_M: f64 = 81.83;

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    if subject.scans.is_none() || subject.trajectory.is_none() {
        return Err(place.needs("the scans and the trajectory: give --log LOG --trajectory trajectory.csv"));
    }
    let mut file = place.create(0)?;
    subject.for_each_scan(&mut |scan| line(&mut file, &scan))?;
    Ok(file.finish()?)
}

fn line(out: &mut impl Write, scan: &PlacedScan<'_>) -> io::Result<()> {
    let geometry = scan.readings.geometry();
    let plain = is_implied(geometry);
    if plain {
        write!(out, "FLASER {}", geometry.beams())?;
    } else {
        let span_rad = geometry.step_rad() * geometry.beams().saturating_sub(1) as f64;
        write!(
            out,
            "ROBOTLASER1 0 {:.9} {span_rad:.9} {:.12} 80 0.01 0 {}",
            geometry.bearing_rad(0),
            geometry.step_rad(),
            geometry.beams()
        )?;
    }
    ranges(out, scan.readings)?;
    if !plain {
        write!(out, " 0")?;
    }
    let pose = scan.map_from_scan;
    let [x, y, theta_rad] = [pose.x, pose.y, pose.theta_rad].map(|v| v + 0.0);
    for _ in ["laser", "robot"] {
        write!(out, " {x:.4} {y:.4} {theta_rad:.6}")?;
    }
    if !plain {
        write!(out, " 0 0 0 0 0")?;
    }
    // The stamps of the log, also where they run backwards: the order of the lines is the true one.
    let stamp_s = scan.stamp_s.unwrap_or(scan.time_s);
    writeln!(out, " {stamp_s:.6} polymapper {stamp_s:.6}")
}

fn ranges(out: &mut impl Write, scan: &Scan) -> io::Result<()> {
    for &range_m in scan.ranges_m() {
        let range_m = if range_m.is_finite() { range_m } else { NO_RETURN_M };
        write!(out, " {range_m:.3}")?;
    }
    Ok(())
}

/// Whether a `FLASER` line without geometry stands for these bearings.
fn is_implied(geometry: &ScanGeometry) -> bool {
    let step_rad = match geometry.beams() {
        180 | 181 => PI / 180.0,
        360 | 361 => PI / 360.0,
        _ => return false,
    };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-6;
    near(geometry.step_rad(), step_rad) && near(geometry.bearing_rad(0), -FRAC_PI_2)
}
