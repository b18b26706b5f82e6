//! g2o: `VERTEX_SE2` for every placed scan, `EDGE_SE2` from each to the next, and to each that was recognised to be
//! at a known place from the scan that was there before.
//!
//! The vertices are the poses of the map. An edge holds the motion between two scans *in the finished map*, so that
//! the graph is at its optimum; its information is that of the pipeline's motion model (3 cm + 20 % of the way, 0.03
//! rad + 20 % of the turn).

use std::io::{self, Write};

use polymapper_core::geometry::Pose;

use super::subject::PlacedRow;
use super::{ExportError, Place, Subject};

pub(super) fn write(subject: &Subject<'_>, place: &Place<'_>) -> Result<(), ExportError> {
    let rows = subject.way(place)?;
    place.write(0, |f| {
        for row in &rows {
            writeln!(f, "VERTEX_SE2 {} {}", row.scan, numbers(row.map_from_scan))?;
        }
        if let Some(first) = rows.first() {
            writeln!(f, "FIX {}", first.scan)?;
        }
        for pair in rows.windows(2) {
            write_edge(f, &pair[0], &pair[1])?;
        }
        for row in &rows {
            let known = row.recognised.filter(|&known| known != row.scan);
            let place = known.and_then(|known| rows.binary_search_by_key(&known, |row| row.scan).ok());
            if let Some(place) = place {
                write_edge(f, &rows[place], row)?;
            }
        }
        Ok(())
    })
}

fn write_edge(out: &mut impl Write, from: &PlacedRow, to: &PlacedRow) -> io::Result<()> {
    let motion = from.map_from_scan.inverse() * to.map_from_scan;
    let [place, turn] = information(motion);
    let (from, to, motion) = (from.scan, to.scan, numbers(motion));
    writeln!(
        out,
        "EDGE_SE2 {from} {to} {motion} {place:.3} 0 0 {place:.3} 0 {turn:.3}"
    )
}

fn numbers(pose: Pose) -> String {
    // Adding 0 turns −0 into 0.
    let [x, y, theta_rad] = [pose.x, pose.y, pose.theta_rad].map(|v| v + 0.0);
    format!("{x:.6} {y:.6} {theta_rad:.7}")
}

/// Inverse variances of the place, 1/m², and of the heading, 1/rad².
fn information(motion: Pose) -> [f64; 2] {
    let sigma_m = 0.03 + 0.2 * motion.translation().norm();
    let sigma_rad = 0.03 + 0.2 * motion.theta_rad.abs();
    [sigma_m.powi(-2), sigma_rad.powi(-2)]
}
