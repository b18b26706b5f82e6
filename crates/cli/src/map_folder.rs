//! The folder of a map: what `build` and `merge` write, and what `merge` and `build --into` read back.

use std::path::Path;

use anyhow::{Context, ensure};
use polymapper_core::geometry::Pose;
use polymapper_core::join::SavedMap;
use polymapper_core::map::{Map, dominant_direction_rad};
use polymapper_io::log::{Entry, LineFault};
use polymapper_io::out::{
    AtomicFile, KeyframeFile, MapFile, Outcome, TrajectoryRow, read_keyframes, read_trajectory_csv,
    write_keyframes, write_map, write_trajectory_csv, write_trajectory_tum,
};

use crate::mapping::Noted;

const KEYFRAMES: &str = "keyframes.jsonl.gz";
/// How the reason of a line that could not be used begins.
pub const UNUSABLE: &str = "unusable line";

/// A map with all that is needed to continue it.
pub struct MapFolder {
    pub map: Map,
    /// A row for every laser line.
    pub rows: Vec<TrajectoryRow>,
    /// Keyframes, numbered by row.
    pub saved: SavedMap,
    /// Why the map does not hold the whole log.
    pub partial: Option<String>,
    /// See [`MapFile::turned_rad`].
    pub turned_rad: f64,
}

impl MapFolder {
    /// The result of a mapper, which knows only the lines that could be used.
    pub fn of(
        lines: Vec<LaserLine>,
        map: Map,
        outcomes: Vec<Outcome>,
        noted: &[Noted],
        mut saved: SavedMap,
    ) -> anyhow::Result<Self> {
        let usable: Vec<usize> = (0..lines.len()).filter(|&k| lines[k].fault.is_none()).collect();
        for keyframe in &mut saved.keyframes {
            keyframe.number = *usable
                .get(keyframe.number)
                .context("the mapper kept a scan that was not there")?;
        }
        Ok(Self {
            map,
            rows: trajectory(lines, outcomes, noted)?,
            saved,
            partial: None,
            turned_rad: 0.0,
        })
    }

    /// Reads back what is needed to continue a map. The map itself is made again from the keyframes.
    pub fn read(folder: &Path) -> anyhow::Result<Self> {
        let keyframes = folder.join(KEYFRAMES);
        ensure!(
            keyframes.exists(),
            "{} is not there: only a folder that `build` or `merge` wrote can be joined with another",
            keyframes.display()
        );
        let file = read_keyframes(&keyframes)?;
        let rows = read_trajectory_csv(&folder.join("trajectory.csv"))?;
        ensure!(
            rows.len() == file.scans,
            "{} has {} scans, but the trajectory beside it {}",
            keyframes.display(),
            file.scans,
            rows.len()
        );
        Ok(Self {
            map: Map::default(),
            rows,
            saved: file.saved,
            partial: None,
            turned_rad: 0.0,
        })
    }

    /// Turns everything so that most walls run along the axes.
    pub fn align_axes(&mut self) {
        let Some(direction_rad) = dominant_direction_rad(&self.map) else {
            return;
        };
        let turn = Pose::new(0.0, 0.0, -direction_rad);
        self.map = self.map.turned(-direction_rad);
        self.turned_rad = -direction_rad;
        for row in &mut self.rows {
            if let Outcome::Placed { map_from_scan } = &mut row.outcome {
                *map_from_scan = turn * *map_from_scan;
            }
        }
        for keyframe in &mut self.saved.keyframes {
            keyframe.map_from_scan = turn * keyframe.map_from_scan;
        }
    }

    /// Writes map, trajectory and keyframes into `folder`, which is there and writable.
    pub fn write(&self, folder: &Path) -> anyhow::Result<()> {
        let file = MapFile {
            map: self.map.clone(),
            partial: self.partial.clone(),
            turned_rad: self.turned_rad,
        };
        AtomicFile::write(&folder.join("map.json"), |f| write_map(f, &file))?;
        AtomicFile::write(&folder.join("trajectory.csv"), |f| {
            write_trajectory_csv(f, &self.rows)
        })?;
        AtomicFile::write(&folder.join("trajectory.tum"), |f| {
            write_trajectory_tum(f, &self.rows)
        })?;
        let keyframes = KeyframeFile {
            saved: self.saved.clone(),
            scans: self.rows.len(),
        };
        AtomicFile::write(&folder.join(KEYFRAMES), |f| write_keyframes(f, &keyframes))?;
        Ok(())
    }
}

/// What is kept of a laser line until the poses are known.
pub struct LaserLine {
    stamp_s: Option<f64>,
    fault: Option<(u64, LineFault)>,
}

impl LaserLine {
    pub fn of(entry: &Entry) -> Self {
        match entry {
            Entry::Scan(scan) => Self {
                stamp_s: scan.stamp_s,
                fault: None,
            },
            Entry::Bad(bad) => Self {
                stamp_s: None,
                fault: Some((bad.line, bad.fault.clone())),
            },
        }
    }
}

/// A row for every laser line: what the mapper says of the scans that it saw, in order, and between them the lines
/// that it never saw.
fn trajectory(
    lines: Vec<LaserLine>,
    outcomes: Vec<Outcome>,
    noted: &[Noted],
) -> anyhow::Result<Vec<TrajectoryRow>> {
    // The mapper counts scans, the trajectory laser lines.
    let usable = lines.iter().enumerate().filter(|(_, line)| line.fault.is_none());
    let places: Vec<usize> = usable.map(|(place, _)| place).collect();
    let mut seen = outcomes.into_iter().zip(noted.iter().copied());
    let row = |(scan, line): (usize, LaserLine)| {
        let (outcome, noted) = match line.fault {
            Some((number, fault)) => {
                let reason = format!("{UNUSABLE} {number}: {fault}");
                (Outcome::NotPlaced { reason }, Noted::default())
            }
            None => seen
                .next()
                .with_context(|| format!("the mapper says nothing about scan {scan}"))?,
        };
        Ok(TrajectoryRow {
            scan,
            stamp_s: line.stamp_s,
            outcome,
            recognised: noted.recognised.and_then(|number| places.get(number).copied()),
            quality: noted.quality,
        })
    };
    lines.into_iter().enumerate().map(row).collect()
}
