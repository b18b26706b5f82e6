//! What is watched: a log, a stream, or the folder of a build.

use std::fs::File;
use std::path::Path;

use anyhow::Context;
use polymapper_io::log::{Log, ReadOptions};
use polymapper_io::out::{MapFile, Outcome, TrajectoryRow, read_map, read_trajectory_csv};
use polymapper_view::{Finished, FinishedScan, replay};

use super::stream::Stream;
use crate::record::GENERATOR;
use crate::scans;

/// Names of the files of a build.
const MAP: &str = "map.json";
const TRAJECTORY: &str = "trajectory.csv";

/// What is watched.
pub enum Source {
    /// What a build has recorded.
    Replay {
        /// The packed record.
        file: File,
        /// Its name, for messages.
        name: String,
    },
    /// What a build has left that recorded nothing.
    Finished(Box<Finished>),
    /// A log in a file or a folder.
    Log(Box<Log>),
    /// Scans as they come.
    Stream(Stream),
}

impl Source {
    /// What the name stands for.
    pub fn of(name: &Path, options: ReadOptions) -> anyhow::Result<Self> {
        if name == Path::new("-") {
            return Ok(Self::Stream(Stream::of_stdin(options)));
        }
        if let Some(place) = name.to_str().and_then(|n| n.strip_prefix("tcp:")) {
            return Ok(Self::Stream(Stream::of_callers(place, options)?));
        }
        let record = name.join(replay::FILE);
        if record.exists() {
            let file = File::open(&record).with_context(|| format!("{} cannot be read", record.display()))?;
            return Ok(Self::Replay {
                file,
                name: record.display().to_string(),
            });
        }
        if name.join(MAP).exists() {
            return Ok(Self::Finished(Box::new(finished(name)?)));
        }
        Ok(Self::Log(Box::new(scans::open(name, options)?)))
    }
}

/// Map and poses in the folder of a build, which has no record.
fn finished(folder: &Path) -> anyhow::Result<Finished> {
    let MapFile { map, partial, .. } = read_map(&folder.join(MAP))?;
    let trajectory = folder.join(TRAJECTORY);
    let (rows, missing) = if trajectory.exists() {
        let missing = format!(
            "There is no {} here: scans, searches and how the map grew are not shown.",
            replay::FILE
        );
        (read_trajectory_csv(&trajectory)?, missing)
    } else {
        let missing = format!(
            "There is neither {} nor {TRAJECTORY} here: the map is shown, and nothing else.",
            replay::FILE
        );
        (Vec::new(), missing)
    };
    Ok(Finished {
        name: name_of(folder),
        generator: GENERATOR.to_owned(),
        map,
        scans: rows.into_iter().map(scan).collect(),
        partial,
        missing,
    })
}

fn scan(row: TrajectoryRow) -> FinishedScan {
    FinishedScan {
        scan: row.scan,
        stamp_s: row.stamp_s,
        map_from_scan: match row.outcome {
            Outcome::Placed { map_from_scan } => Ok(map_from_scan),
            Outcome::NotPlaced { reason } => Err(reason),
        },
    }
}

/// The last part of its path, also where it is called `.`
fn name_of(folder: &Path) -> String {
    let whole = folder.canonicalize();
    scans::short_name(&whole.as_deref().unwrap_or(folder).display().to_string())
}
