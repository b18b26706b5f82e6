//! The way of the scanner, one row a scan: `trajectory.csv`, and `trajectory.tum` for tools that read TUM.
//!
//! Poses are those of the laser in the map frame, metres and radians.

use std::io::{self, Write};

use polymapper_core::geometry::Pose;
use polymapper_core::mapper::Quality;

use super::quality::{self, QUALITY_COLUMNS};

/// What became of a scan.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// It has a place in the map.
    Placed {
        /// Pose of the laser in the map.
        map_from_scan: Pose,
    },
    /// It has none.
    NotPlaced {
        /// Why, as `docs/map-format.md` has it.
        reason: String,
    },
}

/// A scan and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectoryRow {
    /// 0-based place of the scan in the log.
    pub scan: usize,
    /// Stamp of the log, seconds.
    pub stamp_s: Option<f64>,
    /// Placed or not.
    pub outcome: Outcome,
    /// Place in the log of the scan at whose place this one was recognised to be.
    pub recognised: Option<usize>,
    /// How well it was placed.
    pub quality: Quality,
}

/// The first columns of `trajectory.csv`; those of the quality follow.
pub(super) const TRAJECTORY_COLUMNS: [&str; 8] = [
    "scan",
    "stamp_s",
    "x_m",
    "y_m",
    "theta_rad",
    "outcome",
    "reason",
    "recognised",
];

/// Writes `trajectory.csv`: `scan,stamp_s,x_m,y_m,theta_rad,outcome,reason,recognised`, and how well the scan was placed:
/// `won,lead,hypotheses,fit,known,through,matched,rank,open_rad,var_x_m2,cov_xy_m2,var_y_m2,cov_xt_m_rad,cov_yt_m_rad,var_t_rad2`;
/// a row for every scan.
///
/// Fields that are not known are empty. Later versions may add columns at the end.
///
/// # Errors
/// Those of `out`.
pub fn write_trajectory_csv(out: &mut impl Write, rows: &[TrajectoryRow]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record(TRAJECTORY_COLUMNS.iter().chain(&QUALITY_COLUMNS))?;
    for row in rows {
        let stamp = row.stamp_s.map_or(String::new(), |s| format!("{s:.6}"));
        let scan = row.scan.to_string();
        let known = row.recognised.map_or(String::new(), |scan| scan.to_string());
        let heading_rad = match &row.outcome {
            Outcome::Placed { map_from_scan: p } => {
                let (x, y, theta) = (metres(p.x), metres(p.y), radians(p.theta_rad));
                write_fields(&mut csv, &[&scan, &stamp, &x, &y, &theta, "placed", "", &known])?;
                Some(p.theta_rad)
            }
            Outcome::NotPlaced { reason } => {
                write_fields(
                    &mut csv,
                    &[&scan, &stamp, "", "", "", "not_placed", reason, &known],
                )?;
                None
            }
        };
        csv.write_record(quality::fields(&row.quality, heading_rad))?;
    }
    csv.flush()
}

fn write_fields(csv: &mut csv::Writer<impl Write>, fields: &[&str]) -> csv::Result<()> {
    fields.iter().try_for_each(|field| csv.write_field(field))
}

/// Writes `trajectory.tum`: `key x y z qx qy qz qw`, a row for every placed scan.
///
/// The key is the stamp. Where the stamps of the placed scans do not grow from row to row (missing, all the same,
/// running backwards), it is the place in the log for all rows: tools for TUM files need keys that grow.
///
/// # Errors
/// Those of `out`.
pub fn write_trajectory_tum(out: &mut impl Write, rows: &[TrajectoryRow]) -> io::Result<()> {
    let placed = rows
        .iter()
        .filter(|row| matches!(row.outcome, Outcome::Placed { .. }));
    let stamps_s: Option<Vec<f64>> = placed.map(|row| row.stamp_s).collect();
    let by_stamp = stamps_s.is_some_and(|stamps_s| stamps_s.is_sorted_by(|a, b| a < b));
    for row in rows {
        let Outcome::Placed { map_from_scan: p } = &row.outcome else {
            continue;
        };
        match row.stamp_s {
            Some(stamp_s) if by_stamp => write!(out, "{stamp_s:.6}")?,
            _ => write!(out, "{}", row.scan)?,
        }
        let (sin, cos) = (0.5 * p.theta_rad).sin_cos();
        writeln!(out, " {} {} 0 0 0 {sin:.7} {cos:.7}", metres(p.x), metres(p.y))?;
    }
    Ok(())
}

fn metres(value: f64) -> String {
    format!("{:.4}", super::decimals::rounded_4(value))
}

fn radians(value: f64) -> String {
    format!("{:.6}", value + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<TrajectoryRow> {
        let row = |scan, stamp_s, outcome, recognised| TrajectoryRow {
            scan,
            stamp_s,
            outcome,
            recognised,
            quality: Quality::default(),
        };
        let placed = |x, y, theta_rad| Outcome::Placed {
            map_from_scan: Pose::new(x, y, theta_rad),
        };
        vec![
            row(0, Some(976_052_857.345_678), placed(0.0, -0.000_01, 0.0), None),
            row(
                1,
                None,
                Outcome::NotPlaced {
                    reason: "line 7: 3 ranges, but the header says 4".to_owned(),
                },
                None,
            ),
            row(
                2,
                Some(1.5),
                placed(1.0, 2.0, std::f64::consts::FRAC_PI_2),
                Some(0),
            ),
        ]
    }

    fn text(write: impl Fn(&mut Vec<u8>) -> io::Result<()>) -> String {
        let mut out = Vec::new();
        write(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn every_scan_has_a_row() {
        let mut rows = rows();
        rows[2].quality.rank = Some(2);
        rows[2].quality.open_rad = Some(-1.5);
        let expected = "scan,stamp_s,x_m,y_m,theta_rad,outcome,reason,recognised,won,lead,hypotheses,fit,known,through,matched,\
             rank,open_rad,var_x_m2,cov_xy_m2,var_y_m2,cov_xt_m_rad,cov_yt_m_rad,var_t_rad2\n\
             0,976052857.345678,0.0000,0.0000,0.000000,placed,,,,,,,,,,,,,,,,,\n\
             1,,,,,not_placed,\"line 7: 3 ranges, but the header says 4\",,,,,,,,,,,,,,,,\n\
             2,1.500000,1.0000,2.0000,1.570796,placed,,0,,,,,,,,2,0.071,,,,,,\n";
        assert_eq!(text(|out| write_trajectory_csv(out, &rows)), expected);
    }

    #[test]
    fn tum_rows_are_keyed_by_stamp_or_all_by_place() {
        let quarter_turn = "1.0000 2.0000 0 0 0 0.7071068 0.7071068\n";
        let mut rows = rows();
        rows[2].stamp_s = Some(976_052_858.0);
        let by_stamp = text(|out| write_trajectory_tum(out, &rows));
        let last = format!("\n976052858.000000 {quarter_turn}");
        assert!(by_stamp.ends_with(&last), "{by_stamp}");
        let expected = format!("0 0.0000 0.0000 0 0 0 0.0000000 1.0000000\n2 {quarter_turn}");
        for useless in [None, Some(1.5), rows[0].stamp_s] {
            rows[2].stamp_s = useless;
            assert_eq!(
                text(|out| write_trajectory_tum(out, &rows)),
                expected,
                "{useless:?}"
            );
        }
    }
}
