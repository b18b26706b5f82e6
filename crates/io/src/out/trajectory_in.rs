//! `trajectory.csv` read back: poses for exports of a map that was built before.
//!
//! In goes a file that [`super::write_trajectory_csv`] wrote, maybe with more columns; columns are found by their
//! names.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use polymapper_core::geometry::Pose;

use super::quality::{self, QUALITY_COLUMNS};
use super::trajectory::{Outcome, TRAJECTORY_COLUMNS as NAMES, TrajectoryRow};

/// Why a file is not a trajectory.
#[derive(Debug, thiserror::Error)]
pub enum TrajectoryFileError {
    /// The system does not give the file, or it is no CSV.
    #[error("{name} cannot be read as a trajectory")]
    Unreadable {
        /// Name of the file.
        name: String,
        /// What the reader says.
        source: csv::Error,
    },
    /// A column is not there.
    #[error("{name} is no trajectory: the column `{column}` is missing")]
    Column {
        /// Name of the file.
        name: String,
        /// The column.
        column: &'static str,
    },
    /// A field that cannot be.
    #[error("{name}, line {line}: `{column}` is \"{found}\", {expected} is expected")]
    Field {
        /// Name of the file.
        name: String,
        /// 1-based line.
        line: u64,
        /// The column.
        column: &'static str,
        /// What stands there.
        found: String,
        /// What should.
        expected: &'static str,
    },
}

/// Reads the trajectory at `path`.
///
/// # Errors
/// No file, a column that is missing, a field that is no number, scans that are not counted 0, 1, 2 ..
pub fn read_trajectory_csv(path: &Path) -> Result<Vec<TrajectoryRow>, TrajectoryFileError> {
    let name = path.display().to_string();
    match File::open(path) {
        Ok(file) => read(file, &name),
        Err(source) => Err(TrajectoryFileError::Unreadable {
            name,
            source: source.into(),
        }),
    }
}

fn read(input: impl Read, name: &str) -> Result<Vec<TrajectoryRow>, TrajectoryFileError> {
    let unreadable = |source| TrajectoryFileError::Unreadable {
        name: name.to_owned(),
        source,
    };
    let mut csv = csv::Reader::from_reader(input);
    let columns = Columns::find(csv.headers().map_err(unreadable)?, name)?;
    let mut rows = Vec::new();
    for record in csv.records() {
        let record = record.map_err(unreadable)?;
        let row = columns.row(&record, rows.len());
        rows.push(
            row.map_err(|(column, found, expected)| TrajectoryFileError::Field {
                name: name.to_owned(),
                line: record.position().map_or(0, csv::Position::line),
                column,
                found,
                expected,
            })?,
        );
    }
    Ok(rows)
}

/// Columns that must be there; the others came later.
const NEEDED: usize = 7;

/// Where the columns of a trajectory stand; `None` for one that is not there.
struct Columns {
    first: [Option<usize>; NAMES.len()],
    quality: [Option<usize>; QUALITY_COLUMNS.len()],
}

/// Column, what was found, what is expected.
type Fault = (&'static str, String, &'static str);

impl Columns {
    fn find(header: &csv::StringRecord, name: &str) -> Result<Self, TrajectoryFileError> {
        let place = |column| header.iter().position(|field| field == column);
        let first = NAMES.map(place);
        match first.iter().take(NEEDED).position(Option::is_none) {
            Some(k) => Err(TrajectoryFileError::Column {
                name: name.to_owned(),
                column: NAMES[k],
            }),
            None => Ok(Self {
                first,
                quality: QUALITY_COLUMNS.map(place),
            }),
        }
    }

    fn row(&self, record: &csv::StringRecord, expected_scan: usize) -> Result<TrajectoryRow, Fault> {
        let at = |place: Option<usize>| place.and_then(|place| record.get(place)).unwrap_or("");
        let field = |k: usize| at(self.first[k]);
        let number = |k: usize| {
            let value: Option<f64> = field(k).parse().ok().filter(|v: &f64| v.is_finite());
            value.ok_or((NAMES[k], field(k).to_owned(), "a number"))
        };
        if field(0).parse() != Ok(expected_scan) {
            return Err((NAMES[0], field(0).to_owned(), "the count of the rows before"));
        }
        let stamp_s = if field(1).is_empty() {
            None
        } else {
            Some(number(1)?)
        };
        let outcome = match field(5) {
            "placed" => Outcome::Placed {
                map_from_scan: Pose::new(number(2)?, number(3)?, number(4)?),
            },
            "not_placed" => Outcome::NotPlaced {
                reason: field(6).to_owned(),
            },
            other => return Err((NAMES[5], other.to_owned(), "placed or not_placed")),
        };
        let recognised = match field(7) {
            "" => None,
            scan => Some(
                scan.parse()
                    .map_err(|_| (NAMES[7], scan.to_owned(), "the number of a scan"))?,
            ),
        };
        let heading_rad = match &outcome {
            Outcome::Placed { map_from_scan } => Some(map_from_scan.theta_rad),
            Outcome::NotPlaced { .. } => None,
        };
        let of_quality = |k: usize| at(self.quality[k]);
        let quality = quality::read(of_quality, heading_rad)
            .map_err(|(k, expected)| (QUALITY_COLUMNS[k], of_quality(k).to_owned(), expected))?;
        Ok(TrajectoryRow {
            scan: expected_scan,
            stamp_s,
            outcome,
            recognised,
            quality,
        })
    }
}

#[cfg(test)]
mod tests {
    use polymapper_core::mapper::{Origin, Quality};

    use super::*;
    use crate::out::write_trajectory_csv;

    const HEAD: &str = "scan,stamp_s,x_m,y_m,theta_rad,outcome,reason\n";

    #[test]
    fn what_was_written_is_read_back_also_with_other_columns() {
        let rows = vec![
            TrajectoryRow {
                scan: 0,
                stamp_s: Some(12.5),
                outcome: Outcome::Placed {
                    map_from_scan: Pose::new(1.25, -2.0, 0.5),
                },
                recognised: None,
                quality: Quality {
                    won: Some(Origin::Predicted),
                    hypotheses: Some(1),
                    fit: Some(0.5),
                    rank: Some(3),
                    ..Quality::default()
                },
            },
            TrajectoryRow {
                scan: 1,
                stamp_s: None,
                outcome: Outcome::NotPlaced {
                    reason: "line 3: \"x\", and more".to_owned(),
                },
                recognised: Some(0),
                quality: Quality::default(),
            },
        ];
        let mut text = Vec::new();
        write_trajectory_csv(&mut text, &rows).unwrap();
        assert_eq!(read(text.as_slice(), "t.csv").unwrap(), rows);
        // Of a version that did not tell.
        let old = TrajectoryRow {
            quality: Quality::default(),
            ..rows[0].clone()
        };
        let wider = "why,scan,stamp_s,x_m,y_m,theta_rad,outcome,reason\n-,0,12.5,1.25,-2,0.5,placed,\n";
        assert_eq!(read(wider.as_bytes(), "t.csv").unwrap(), [old]);
    }

    #[test]
    fn a_file_that_is_no_trajectory_says_where() {
        let fault = |text: &str| read(text.as_bytes(), "t.csv").unwrap_err().to_string();
        assert!(fault("a,b\n1,2\n").contains("the column `scan` is missing"));
        let row = fault(&format!("{HEAD}0,1,2,x,4,placed,\n"));
        assert_eq!(row, "t.csv, line 2: `y_m` is \"x\", a number is expected");
        assert!(fault(&format!("{HEAD}5,1,2,3,4,placed,\n")).contains("the count of the rows before"));
        assert!(fault(&format!("{HEAD}0,1,NaN,3,4,placed,\n")).contains("`x_m` is \"NaN\""));
        assert!(fault(&format!("{HEAD}0,1,2,3,4,lost,\n")).contains("placed or not_placed"));
        let known = fault("scan,stamp_s,x_m,y_m,theta_rad,outcome,reason,recognised\n0,1,2,3,4,placed,,-1\n");
        assert!(known.contains("`recognised` is \"-1\""), "{known}");
        let fit = fault(&format!("{},fit\n0,1,2,3,4,placed,,good\n", HEAD.trim_end()));
        assert_eq!(fit, "t.csv, line 2: `fit` is \"good\", a number is expected");
    }
}
