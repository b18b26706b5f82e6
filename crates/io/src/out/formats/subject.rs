//! What is exported: a map, and where it is known the way of the scanner and its scans.

use std::error::Error;
use std::io;

use polymapper_core::geometry::{Point, Pose};
use polymapper_core::map::Map;
use polymapper_core::scan::Scan;

use super::{ExportError, Place};
use crate::georef::Georef;
use crate::out::{Outcome, TrajectoryRow};

/// Time between scans where the log has no usable stamps, seconds.
const STEP_WITHOUT_STAMPS_S: f64 = 0.1;

/// What is exported.
pub struct Subject<'a> {
    /// The map.
    pub map: &'a Map,
    /// The pose of every scan.
    pub trajectory: Option<&'a [TrajectoryRow]>,
    /// The scans that `trajectory` places.
    pub scans: Option<&'a dyn ScanSource>,
    /// Draws the map's picture as PNG.
    pub draw_png: &'a dyn Fn() -> Result<Vec<u8>, Box<dyn Error + Send + Sync>>,
    /// What the user chose.
    pub options: ExportOptions,
}

/// What the user can choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExportOptions {
    /// Side of a cell of the occupancy grid, metres. 5 cm is the default of slam_toolbox and Nav2's maps.
    pub resolution_m: f64,
    /// Where the map lies on Earth.
    pub georef: Option<Georef>,
}

impl Default for ExportOptions {
    fn default() -> Self {
        Self {
            resolution_m: 0.05,
            georef: None,
        }
    }
}

/// Scans that can be gone through as often as needed.
pub trait ScanSource {
    /// Gives every usable scan with its 0-based place in the log, in order.
    ///
    /// # Errors
    /// The scans cannot be read, or the error of `each`.
    fn for_each(
        &self,
        each: &mut dyn FnMut(usize, &Scan) -> io::Result<()>,
    ) -> Result<(), Box<dyn Error + Send + Sync>>;
}

/// A scan and where it was taken.
#[derive(Clone, Copy, Debug)]
pub struct PlacedScan<'a> {
    /// 0-based place in the log.
    pub scan: usize,
    /// Stamp of the log, seconds.
    pub stamp_s: Option<f64>,
    /// A time that grows from scan to scan, seconds: the stamps where they do, see
    /// [`Subject::has_usable_stamps`].
    pub time_s: f64,
    /// Pose of the laser in the map.
    pub map_from_scan: Pose,
    /// Ranges and bearings.
    pub readings: &'a Scan,
}

/// A row of the trajectory with a place in the map.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedRow {
    pub scan: usize,
    pub time_s: f64,
    pub map_from_scan: Pose,
    /// Scan at whose place this one was recognised to be.
    pub recognised: Option<usize>,
}

impl Subject<'_> {
    /// Whether the stamps of the placed scans grow from scan to scan. Where they do not (missing, the same twice,
    /// running backwards), formats that need times that grow take the scans as 0.1 s apart.
    #[must_use]
    pub fn has_usable_stamps(&self) -> bool {
        Times::of(self.trajectory.unwrap_or_default()).by_stamp
    }

    /// The placed scans of the trajectory, with times that grow; empty without a trajectory.
    pub(super) fn placed_rows(&self) -> Vec<PlacedRow> {
        let rows = self.trajectory.unwrap_or_default();
        let times = Times::of(rows);
        rows.iter()
            .filter_map(|row| {
                placed(row).map(|map_from_scan| PlacedRow {
                    scan: row.scan,
                    time_s: times.of_row(row),
                    map_from_scan,
                    recognised: row.recognised,
                })
            })
            .collect()
    }

    /// The placed scans, or an error that names the format and what it needs.
    pub(super) fn way(&self, place: &Place<'_>) -> Result<Vec<PlacedRow>, ExportError> {
        if self.trajectory.is_none() {
            return Err(place.needs("the trajectory: give --trajectory trajectory.csv, as `build` wrote it"));
        }
        Ok(self.placed_rows())
    }

    /// The way of the scanner in pieces without a gap; a scan that was not placed makes one.
    pub(super) fn way_pieces(&self) -> Vec<Vec<Point>> {
        let rows = self.trajectory.unwrap_or_default();
        rows.split(|row| placed(row).is_none())
            .map(|run| run.iter().filter_map(placed).map(Pose::translation).collect())
            .filter(|run: &Vec<Point>| run.len() > 1)
            .collect()
    }

    /// Gives every placed scan to `each`; nothing where there are no scans.
    ///
    /// # Errors
    /// The scans cannot be read, or the error of `each`.
    pub(super) fn for_each_scan(
        &self,
        each: &mut dyn FnMut(PlacedScan<'_>) -> io::Result<()>,
    ) -> Result<(), ExportError> {
        let (Some(scans), Some(rows)) = (self.scans, self.trajectory) else {
            return Ok(());
        };
        let times = Times::of(rows);
        scans
            .for_each(&mut |scan, readings| {
                let Some((row, map_from_scan)) = rows.get(scan).and_then(|row| Some((row, placed(row)?)))
                else {
                    return Ok(());
                };
                each(PlacedScan {
                    scan,
                    stamp_s: row.stamp_s,
                    time_s: times.of_row(row),
                    map_from_scan,
                    readings,
                })
            })
            .map_err(ExportError::Scans)
    }
}

fn placed(row: &TrajectoryRow) -> Option<Pose> {
    match row.outcome {
        Outcome::Placed { map_from_scan } => Some(map_from_scan),
        Outcome::NotPlaced { .. } => None,
    }
}

/// When scans were taken, see [`Subject::has_usable_stamps`].
struct Times {
    by_stamp: bool,
}

impl Times {
    fn of(rows: &[TrajectoryRow]) -> Self {
        let stamps_s: Option<Vec<f64>> = rows
            .iter()
            .filter(|row| placed(row).is_some())
            .map(|row| row.stamp_s)
            .collect();
        Self {
            by_stamp: stamps_s
                .is_some_and(|s| s.is_sorted_by(|a, b| a < b) && s.first().is_none_or(|t| *t >= 0.0)),
        }
    }

    fn of_row(&self, row: &TrajectoryRow) -> f64 {
        match row.stamp_s {
            Some(stamp_s) if self.by_stamp => stamp_s,
            _ => row.scan as f64 * STEP_WITHOUT_STAMPS_S,
        }
    }
}
