//! What `export` and `build --export` have in common: which formats, with which options, and the scans for them.

use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use polymapper_core::map::Map;
use polymapper_core::scan::Scan;
use polymapper_io::Georef;
use polymapper_io::log::{Entry, ReadOptions};
use polymapper_io::out::TrajectoryRow;
use polymapper_io::out::formats::{
    ExportFormat, ExportOptions, FORMATS, ScanSource, Subject, Uses, format_named,
};

use crate::talk::say;
use crate::{pictures, scans};

/// Finest and coarsest cells that make sense, metres.
const RESOLUTIONS_M: [f64; 2] = [0.001, 10.0];

/// How a map is exported.
#[derive(Clone, clap::Args)]
pub struct ExportChoice {
    /// Side of a cell of the grid in nav2 and mcap, metres
    #[arg(long, value_name = "METRES", default_value = "0.05", value_parser = resolution_m)]
    pub resolution: f64,
    /// Where the map lies on Earth, for geojson, json-fg and gpkg: latitude and longitude of its origin,
    /// and the compass bearing of its x axis, degrees
    #[arg(long, value_name = "LAT,LON,BEARING", allow_hyphen_values = true)]
    pub georef: Option<Georef>,
}

impl ExportChoice {
    fn options(&self) -> ExportOptions {
        ExportOptions {
            resolution_m: self.resolution,
            georef: self.georef,
        }
    }
}

fn resolution_m(text: &str) -> Result<f64, String> {
    let [finest, coarsest] = RESOLUTIONS_M;
    let value: Option<f64> = text.parse().ok();
    value
        .filter(|v| (finest..=coarsest).contains(v))
        .ok_or_else(|| format!("metres from {finest} to {coarsest} are expected"))
}

/// Reads the name of a format; `--help` shows what each is.
pub fn format_parser() -> impl TypedValueParser<Value = &'static ExportFormat> {
    let names = FORMATS.iter().map(|f| PossibleValue::new(f.name).help(f.about));
    PossibleValuesParser::new(names).try_map(|name| format_named(&name).ok_or("no such format"))
}

/// What is exported, and under which name.
pub struct Exported<'a> {
    pub map: &'a Map,
    pub trajectory: Option<&'a [TrajectoryRow]>,
    pub scans: Option<&'a dyn ScanSource>,
    /// Title of the picture.
    pub title: &'a str,
}

/// Writes all `formats` into `folder` and tells what was written and what was done without.
pub fn write_all(
    formats: &[&ExportFormat],
    choice: &ExportChoice,
    exported: &Exported<'_>,
    folder: &Path,
    stem: &str,
) -> anyhow::Result<()> {
    let draw_png = || draw(exported);
    let subject = Subject {
        map: exported.map,
        trajectory: exported.trajectory,
        scans: exported.scans,
        draw_png: &draw_png,
        options: choice.options(),
    };
    for format in formats {
        let files = format
            .write(&subject, folder, stem)
            .with_context(|| format!("no {} was written", format.name))?;
        let names: Vec<String> = files.iter().map(|f| f.display().to_string()).collect();
        say(format_args!("{}: {}", format.name, names.join(", ")));
        for note in format.notes(&subject) {
            say(format_args!("note: {}: {note}", format.name));
        }
    }
    Ok(())
}

fn draw(exported: &Exported<'_>) -> Result<Vec<u8>, Box<dyn Error + Send + Sync>> {
    let rows = exported.trajectory.unwrap_or_default();
    Ok(polymapper_draw::to_png(&pictures::scene(
        exported.map,
        rows,
        exported.title,
    ))?)
}

/// Whether one of the formats makes use of the scans.
pub fn use_scans(formats: &[&ExportFormat]) -> bool {
    formats.iter().any(|f| f.uses == Uses::Scans)
}

/// Scans that were kept while a map was built, by their place in the log.
#[derive(Default)]
pub struct KeptScans(pub Vec<(usize, Scan)>);

impl ScanSource for KeptScans {
    fn for_each(
        &self,
        each: &mut dyn FnMut(usize, &Scan) -> io::Result<()>,
    ) -> Result<(), Box<dyn Error + Send + Sync>> {
        for (place, scan) in &self.0 {
            each(*place, scan)?;
        }
        Ok(())
    }
}

/// A log that is read again every time, so that memory does not depend on its length.
pub struct LogScans<'a> {
    path: PathBuf,
    options: ReadOptions,
    rows: &'a [TrajectoryRow],
}

impl<'a> LogScans<'a> {
    /// The scans of the log at `path`, which `rows` places.
    ///
    /// # Errors
    /// The log cannot be read, or is not the one that the trajectory is of.
    pub fn new(path: &Path, options: ReadOptions, rows: &'a [TrajectoryRow]) -> anyhow::Result<Self> {
        ensure!(
            path != Path::new("-"),
            "the log is read several times for an export; standard input can only be read once"
        );
        let scans = Self {
            path: path.to_owned(),
            options,
            rows,
        };
        scans.compare().context("the trajectory is not of this log")?;
        Ok(scans)
    }

    /// Whether the log has the rows of the trajectory, with their stamps.
    fn compare(&self) -> anyhow::Result<()> {
        let mut scans = 0;
        for entry in scans::open(&self.path, self.options.clone())? {
            let entry = match entry {
                // A log that breaks off gave a map of what came before.
                Err(_) if scans >= self.rows.len() => break,
                entry => entry?,
            };
            let (place, stamp_s) = match entry {
                Entry::Scan(scan) => (scan.index, scan.stamp_s),
                Entry::Bad(bad) => (bad.index, None),
            };
            scans = place + 1;
            let row_stamp_s = self.rows.get(place).and_then(|row| row.stamp_s);
            if let (Some(log_s), Some(row_s)) = (stamp_s, row_stamp_s) {
                ensure!(
                    (log_s - row_s).abs() < 1e-3,
                    "scan {place} has the stamp {log_s:.6} in the log and {row_s:.6} in the trajectory"
                );
            }
        }
        // A trajectory of a build that was stopped is shorter.
        ensure!(
            scans >= self.rows.len(),
            "the log has {scans} scans, the trajectory {} rows",
            self.rows.len()
        );
        if scans > self.rows.len() {
            say(format_args!(
                "note: the log has {scans} scans, the trajectory {} rows: the rest of the log is left out",
                self.rows.len()
            ));
        }
        Ok(())
    }
}

impl ScanSource for LogScans<'_> {
    fn for_each(
        &self,
        each: &mut dyn FnMut(usize, &Scan) -> io::Result<()>,
    ) -> Result<(), Box<dyn Error + Send + Sync>> {
        for entry in scans::open(&self.path, self.options.clone())? {
            let place = match entry? {
                Entry::Scan(scan) => {
                    each(scan.index, &scan.scan)?;
                    scan.index
                }
                Entry::Bad(bad) => bad.index,
            };
            if place + 1 >= self.rows.len() {
                break;
            }
        }
        Ok(())
    }
}
