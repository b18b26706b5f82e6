//! Keyframes of a CARMEN log: enough of a reader for the examples.

use std::f64::consts::{FRAC_PI_2, PI};
use std::io::BufRead;

use polymapper_core::extract::{ExtractSettings, extract};
use polymapper_core::geometry::{Polyline, Pose};
use polymapper_core::scan::{Scan, ScanGeometry};

/// A scan's polylines and the pose that the log gives it.
pub struct Keyframe {
    /// Laser frame.
    pub polylines: Vec<Polyline>,
    /// `map_from_scan` behind the ranges.
    pub pose: Pose,
}

/// Every scan of a log.
pub fn read_keyframes(log: impl BufRead) -> std::io::Result<Vec<Keyframe>> {
    let mut keyframes = Vec::new();
    for line in log.lines() {
        keyframes.extend(read_flaser(&line?));
    }
    Ok(keyframes)
}

/// `FLASER n r1..rn x y theta ..`; `None` for any other or broken line.
fn read_flaser(line: &str) -> Option<Keyframe> {
    let mut words = line.split_ascii_whitespace();
    if words.next()? != "FLASER" {
        return None;
    }
    let beams: usize = words.next()?.parse().ok()?;
    let numbers: Vec<f64> = words.map_while(|w| w.parse().ok()).collect();
    let (ranges_m, rest) = numbers.split_at_checked(beams)?;
    let [x, y, theta_rad, ..] = *rest else {
        return None;
    };
    let step_rad = if beams > 200 { PI / 360.0 } else { PI / 180.0 };
    let geometry = ScanGeometry::new(-FRAC_PI_2, step_rad, beams).ok()?;
    let scan = Scan::new(geometry, ranges_m.to_vec()).ok()?;
    let extraction = extract(&scan, &ExtractSettings::default());
    Some(Keyframe {
        polylines: extraction.polylines.into_iter().map(|p| p.polyline).collect(),
        pose: Pose::new(x, y, theta_rad),
    })
}
