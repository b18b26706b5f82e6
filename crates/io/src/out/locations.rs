//! Where the scans of a log are in a map: a table for people, CSV and JSON lines for programs, a row a scan.
//!
//! Poses are those of the laser in the map frame, metres; the heading in degrees for people and in radians, as in
//! `trajectory.csv`, for programs.

use std::io::{self, Write};

use polymapper_core::geometry::Pose;
use serde::Serialize;

use super::decimals::rounded_4;

/// A pose that explains a scan, and how well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocatedPose {
    /// Pose of the laser in the map.
    pub map_from_scan: Pose,
    /// 1 for a perfect fit, 0 for none.
    pub score: f64,
}

/// What became of a scan.
#[derive(Clone, Debug, PartialEq)]
pub struct LocationRow {
    /// 0-based place of the scan in the log.
    pub scan: usize,
    /// Stamp of the log, seconds.
    pub stamp_s: Option<f64>,
    /// `located`, `ambiguous` or `not_found`.
    pub outcome: &'static str,
    /// Whether the pose was carried on from the scan before, or found without a guess.
    pub tracked: bool,
    /// Probability that the first pose is the right one, given that the scan is of this map.
    pub confidence: f64,
    /// Poses, best first.
    pub poses: Vec<LocatedPose>,
    /// What else there is to say, in words; empty for nothing.
    pub reason: String,
}

/// How rows are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocationFormat {
    /// Columns for people.
    Table,
    /// Comma-separated values.
    Csv,
    /// A JSON object a line, with every pose.
    JsonLines,
}

impl LocationFormat {
    /// Writes what stands before the first row.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_head(self, out: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Table => writeln!(
                out,
                "{:>7} {:>10} {:>10} {:>10} {:>11} {:>7} {:>7}",
                "scan", "outcome", "x_m", "y_m", "heading_deg", "score", "second"
            ),
            Self::Csv => writeln!(
                out,
                "scan,stamp_s,outcome,x_m,y_m,theta_rad,heading_deg,score,second_score,second_x_m,second_y_m,\
                 second_heading_deg,confidence,tracked,reason"
            ),
            Self::JsonLines => Ok(()),
        }
    }

    /// Writes a row.
    ///
    /// # Errors
    /// Those of `out`.
    pub fn write_row(self, out: &mut impl Write, row: &LocationRow) -> io::Result<()> {
        match self {
            Self::Table => table_row(out, row),
            Self::Csv => csv_row(out, row),
            Self::JsonLines => json_row(out, row),
        }
    }
}

fn table_row(out: &mut impl Write, row: &LocationRow) -> io::Result<()> {
    let best = row.poses.first();
    let cell = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "-".to_owned(), |v| format!("{:.decimals$}", v + 0.0))
    };
    writeln!(
        out,
        "{:>7} {:>10} {:>10} {:>10} {:>11} {:>7} {:>7}",
        row.scan,
        row.outcome,
        cell(best.map(|p| p.map_from_scan.x), 3),
        cell(best.map(|p| p.map_from_scan.y), 3),
        cell(best.map(|p| p.map_from_scan.theta_rad.to_degrees()), 2),
        cell(best.map(|p| p.score), 3),
        cell(row.poses.get(1).map(|p| p.score), 3),
    )
}

fn csv_row(out: &mut impl Write, row: &LocationRow) -> io::Result<()> {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or_else(String::new, |v| format!("{:.decimals$}", v + 0.0))
    };
    let (best, second) = (row.poses.first(), row.poses.get(1));
    let x = |p: Option<&LocatedPose>| number(p.map(|p| p.map_from_scan.x), 4);
    let y = |p: Option<&LocatedPose>| number(p.map(|p| p.map_from_scan.y), 4);
    let heading = |p: Option<&LocatedPose>| number(p.map(|p| p.map_from_scan.theta_rad.to_degrees()), 3);
    let score = |p: Option<&LocatedPose>| number(p.map(|p| p.score), 4);
    let mut csv = csv::Writer::from_writer(out);
    csv.write_record([
        row.scan.to_string(),
        number(row.stamp_s, 6),
        row.outcome.to_owned(),
        x(best),
        y(best),
        number(best.map(|p| p.map_from_scan.theta_rad), 6),
        heading(best),
        score(best),
        score(second),
        x(second),
        y(second),
        heading(second),
        number(best.map(|_| row.confidence), 4),
        u8::from(row.tracked).to_string(),
        row.reason.clone(),
    ])?;
    csv.flush()
}

#[derive(Serialize)]
struct Record<'a> {
    scan: usize,
    stamp_s: Option<f64>,
    outcome: &'a str,
    confidence: f64,
    tracked: bool,
    poses: Vec<PoseRecord>,
    #[serde(skip_serializing_if = "str::is_empty")]
    reason: &'a str,
}

#[derive(Serialize)]
struct PoseRecord {
    x_m: f64,
    y_m: f64,
    theta_rad: f64,
    score: f64,
}

fn json_row(out: &mut impl Write, row: &LocationRow) -> io::Result<()> {
    let record = Record {
        scan: row.scan,
        stamp_s: row.stamp_s,
        outcome: row.outcome,
        confidence: rounded_4(row.confidence),
        tracked: row.tracked,
        poses: row
            .poses
            .iter()
            .map(|p| PoseRecord {
                x_m: rounded_4(p.map_from_scan.x),
                y_m: rounded_4(p.map_from_scan.y),
                theta_rad: (p.map_from_scan.theta_rad * 1e6).round() / 1e6 + 0.0,
                score: rounded_4(p.score),
            })
            .collect(),
        reason: &row.reason,
    };
    serde_json::to_writer(&mut *out, &record)?;
    writeln!(out)
}
