//! `polymapper build`: log → map, trajectory, report.
//!
//! The folder is tried and the log opened before any work; the scans go to the mapper one by one; at the end,
//! whether by the log's end, a fault in it, or Ctrl-C, everything is written whole.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::Context;
use polymapper_core::geometry::Polyline;
use polymapper_core::map::Map;
use polymapper_core::mapper::{LooseStretch, Settings};
use polymapper_io::log::{Entry, Log};
use polymapper_io::out::formats::{ExportFormat, ScanSource};
use polymapper_io::out::{
    AtomicFile, InputReport, MapReport, Outcome, QualityReport, Report, ScanReport, TrajectoryRow,
    prepare_folder, read_map, read_trajectory_csv,
};

use crate::args::BuildArgs;
use crate::clock::StageClock;
use crate::exports::{ExportChoice, Exported, KeptScans, use_scans, write_all};
use crate::interrupt::Interrupt;
use crate::map_folder::{LaserLine, MapFolder, UNUSABLE};
use crate::mapping::{CoreMapping, Mapping};
use crate::record::BuildRecord;
use crate::scans::{self, Reading};
use crate::talk::{say, say_loose};
use crate::{Finish, memory, pictures, report_html};

/// Runs the command.
pub fn run(args: &BuildArgs) -> anyhow::Result<Finish> {
    if let Some(old) = &args.into {
        return super::merge::continue_map(args, old);
    }
    let output = args
        .output
        .as_deref()
        .context("no folder for the result: --output or --into")?;
    prepare_folder(output)?;
    let log = scans::open(&args.log.choice.log, args.log.read_options())?;
    let odometry_used = args.log.use_odometry;
    let record = BuildRecord::create(output, log.name(), !args.no_replay)?;
    build(
        log,
        CoreMapping::new(Settings::default(), record),
        output,
        odometry_used,
        &Interrupt::listen()?,
        &Also {
            formats: &args.export,
            choice: Some(&args.choice),
            align_axes: args.align_axes,
        },
    )
}

/// What is exported besides.
#[derive(Default)]
pub struct Also<'a> {
    formats: &'a [&'static ExportFormat],
    choice: Option<&'a ExportChoice>,
    /// The result is turned so that walls lie along the axes.
    align_axes: bool,
}

/// Builds the map of `log` and writes everything into `folder`, which is there and writable.
pub fn build(
    mut log: Log,
    mut mapper: impl Mapping,
    folder: &Path,
    odometry_used: bool,
    interrupt: &Interrupt,
    also: &Also<'_>,
) -> anyhow::Result<Finish> {
    let keep_scans = use_scans(also.formats);
    let mut kept = KeptScans::default();
    let mut clock = StageClock::new(&["read"]);
    let mut lines = Vec::new();
    let mut returns = 0;
    clock.enter("read");
    let reading = scans::for_each(&mut log, interrupt, |entry| {
        lines.push(LaserLine::of(&entry));
        match entry {
            Entry::Scan(scan) => {
                returns += scan.scan.returns();
                mapper.add_scan(&scan, &mut clock)?;
                clock.enter("read");
                if keep_scans {
                    kept.0.push((scan.index, scan.scan));
                }
            }
            Entry::Bad(bad) => mapper.skip(&bad)?,
        }
        Ok(())
    })?;
    let settings = mapper.settings();
    let finished = mapper.finish(reading.partial.as_deref(), &mut clock)?;
    clock.enter("write");
    let mut result = MapFolder::of(
        lines,
        finished.map,
        finished.outcomes,
        &finished.noted,
        finished.saved,
    )?;
    result.partial.clone_from(&reading.partial);
    if also.align_axes {
        result.align_axes();
    }
    result.write(folder)?;
    let MapFolder { map, rows, .. } = result;
    let notes = reading.tally.notes.iter().chain(&finished.corrections);
    clock.enter("draw");
    pictures::write(folder, &map, &rows, log.name())?;
    if let Some(choice) = also.choice.filter(|_| !also.formats.is_empty()) {
        clock.enter("export");
        // From the files, so that `export` gives the same bytes another day.
        let map = read_map(&folder.join("map.json"))?.map;
        let rows = read_trajectory_csv(&folder.join("trajectory.csv"))?;
        let exported = Exported {
            map: &map,
            trajectory: Some(&rows),
            scans: keep_scans.then_some(&kept as &dyn ScanSource),
            title: &scans::short_name(log.name()),
        };
        write_all(also.formats, choice, &exported, folder, "map")?;
    }
    let report = Report {
        generator: concat!("polymapper ", env!("CARGO_PKG_VERSION")).to_owned(),
        partial: reading.partial.clone(),
        input: InputReport::new(log.name(), log.format(), odometry_used, &reading.tally),
        scans: scan_report(&rows),
        quality: QualityReport::of(&rows, &finished.loose, Settings::default().place.clear_lead),
        map: map_report(&map, folder)?,
        stages: clock.times(),
        peak_memory_bytes: memory::peak_bytes(),
        settings,
        notes: notes.cloned().collect(),
    };
    AtomicFile::write(&folder.join("report.json"), |f| report.write(f))?;
    report_html::write(folder, &report, &map, returns, finished.recorded)?;
    tell(&report, &finished.loose, &reading, folder);
    Ok(Finish::with_loss(
        reading.has_loss() || report.scans.not_placed > 0,
    ))
}

fn scan_report(rows: &[TrajectoryRow]) -> ScanReport {
    let mut by_reason = BTreeMap::new();
    for row in rows {
        if let Outcome::NotPlaced { reason } = &row.outcome {
            let reason = if reason.starts_with(UNUSABLE) {
                UNUSABLE
            } else {
                reason
            };
            *by_reason.entry(reason.to_owned()).or_insert(0) += 1;
        }
    }
    let not_placed = by_reason.values().sum();
    ScanReport {
        read: rows.len(),
        placed: rows.len() - not_placed,
        not_placed,
        not_placed_by_reason: by_reason,
    }
}

fn map_report(map: &Map, folder: &Path) -> anyhow::Result<MapReport> {
    let length_m: f64 = map
        .polylines
        .iter()
        .filter_map(|p| p.polyline().as_ref().map(Polyline::length_m))
        .sum();
    Ok(MapReport {
        polylines: map.polylines.len(),
        vertices: map.polylines.iter().map(|p| p.vertices.len()).sum(),
        length_m: (length_m * 1e3).round() / 1e3,
        eraser_boxes: map.eraser_boxes.len(),
        bytes: fs::metadata(folder.join("map.json"))
            .context("map.json is gone")?
            .len(),
    })
}

fn tell(report: &Report, loose: &[LooseStretch], reading: &Reading, folder: &Path) {
    let (scans, map) = (&report.scans, &report.map);
    say(format_args!(
        "{} of {} scans placed; {} polylines, {} vertices, {:.1} m, {} bytes: {}",
        scans.placed,
        scans.read,
        map.polylines,
        map.vertices,
        map.length_m,
        map.bytes,
        folder.join("map.json").display()
    ));
    say(format_args!("picture: {}", folder.join(pictures::PNG).display()));
    say(format_args!(
        "report: {}",
        folder.join(report_html::FILE).display()
    ));
    for (reason, count) in &scans.not_placed_by_reason {
        say(format_args!("not placed: {count} ({reason})"));
    }
    say_loose(loose);
    if let Some(partial) = &reading.partial {
        say(format_args!("the result is partial: {partial}"));
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use polymapper_core::geometry::{Point, Pose};
    use polymapper_core::join::SavedMap;
    use polymapper_core::map::{MapPolyline, MapVertex};
    use polymapper_core::mapper::{Origin, Quality};
    use polymapper_io::log::{BadScan, LogScan, ReadOptions};
    use polymapper_io::out::read_map;

    use super::*;
    use crate::mapping::{Finished, Noted};
    use crate::record::Recorded;

    /// Every scan after the first is at the place of the first, and half of its beams agree.
    fn noted(scan: usize) -> Noted {
        let quality = Quality {
            won: Some(if scan > 0 {
                Origin::Predicted
            } else {
                Origin::First
            }),
            fit: (scan > 0).then_some(0.5),
            ..Quality::default()
        };
        Noted {
            recognised: (scan > 0).then_some(0),
            quality,
        }
    }

    /// Puts scan k at (k, 0) and refuses those without returns; the map is one wall.
    #[derive(Default)]
    struct Rail {
        outcomes: Vec<Outcome>,
        interrupt_after: Option<(usize, Interrupt)>,
    }

    impl Mapping for Rail {
        fn add_scan(&mut self, scan: &LogScan, clock: &mut StageClock) -> anyhow::Result<()> {
            clock.enter("map");
            self.outcomes.push(match scan.scan.returns() {
                0 => Outcome::NotPlaced {
                    reason: "no returns".to_owned(),
                },
                _ => Outcome::Placed {
                    map_from_scan: Pose::new(self.outcomes.len() as f64, 0.0, 0.0),
                },
            });
            if let Some((after, interrupt)) = &self.interrupt_after
                && *after == self.outcomes.len()
            {
                interrupt.ask();
            }
            Ok(())
        }

        fn skip(&mut self, _bad: &BadScan) -> anyhow::Result<()> {
            Ok(())
        }

        fn finish(self, _partial: Option<&str>, clock: &mut StageClock) -> anyhow::Result<Finished> {
            clock.enter("finish");
            let vertex = |x, y| MapVertex {
                point: Point::new(x, y),
                observations: 1,
                sigma_m: 0.01,
            };
            let wall = MapPolyline {
                id: 1,
                vertices: vec![vertex(0.0, 0.0), vertex(3.0, 4.0)],
            };
            Ok(Finished {
                map: Map {
                    polylines: vec![wall],
                    eraser_boxes: Vec::new(),
                },
                noted: (0..self.outcomes.len()).map(noted).collect(),
                outcomes: self.outcomes,
                corrections: Vec::new(),
                loose: Vec::new(),
                saved: SavedMap::default(),
                recorded: Recorded(Vec::new()),
            })
        }

        fn settings(&self) -> serde_json::Value {
            serde_json::json!({})
        }
    }

    struct Built {
        finish: anyhow::Result<Finish>,
        folder: tempfile::TempDir,
    }

    impl Built {
        fn read(&self, name: &str) -> String {
            fs::read_to_string(self.folder.path().join(name)).unwrap()
        }

        fn report(&self) -> serde_json::Value {
            serde_json::from_str(&self.read("report.json")).unwrap()
        }
    }

    fn build_text(text: &str, mapper: Rail, interrupt: &Interrupt) -> Built {
        let folder = tempfile::tempdir().unwrap();
        let path: PathBuf = folder.path().join("test.log");
        fs::write(&path, text).unwrap();
        let log = scans::open(&path, ReadOptions::default()).unwrap();
        let finish = build(log, mapper, folder.path(), false, interrupt, &Also::default());
        Built { finish, folder }
    }

    const GOOD: &str = "FLASER 3 1 1 1 0 0 0 0 0 0 5.5 host 1\n";
    const BLIND: &str = "FLASER 3 nan inf 0 0 0 0 0 0 0 6.5 host 1\n";
    const WRONG: &str = "FLASER 4 1 1 1 0 0 0 0 0 0 7.5 host 1\n";

    #[test]
    fn every_laser_line_has_its_row_and_reason() {
        let text = format!("{WRONG}{GOOD}{BLIND}{GOOD}");
        let built = build_text(&text, Rail::default(), &Interrupt::default());
        assert_eq!(built.finish.as_ref().unwrap(), &Finish::WithLoss);
        let expected = "scan,stamp_s,x_m,y_m,theta_rad,outcome,reason,recognised,won,lead,hypotheses,fit,known,through,matched,\
             rank,open_rad,var_x_m2,cov_xy_m2,var_y_m2,cov_xt_m_rad,cov_yt_m_rad,var_t_rad2\n\
             0,,,,,not_placed,\"unusable line 1: 3 ranges, but the header says 4\",,,,,,,,,,,,,,,,\n\
             1,5.500000,0.0000,0.0000,0.000000,placed,,,first,,,,,,,,,,,,,,\n\
             2,6.500000,,,,not_placed,no returns,1,predicted,,,0.5,,,,,,,,,,,\n\
             3,5.500000,2.0000,0.0000,0.000000,placed,,1,predicted,,,0.5,,,,,,,,,,,\n";
        assert_eq!(built.read("trajectory.csv"), expected);
        let quality = &built.report()["quality"];
        assert_eq!(quality["won"], serde_json::json!({"first": 1, "predicted": 2}));
        assert_eq!(quality["fit_median"], 0.5);
        let scans = &built.report()["scans"];
        assert_eq!(
            scans["not_placed_by_reason"],
            serde_json::json!({"no returns": 1, "unusable line": 1})
        );
        assert_eq!((&scans["read"], &scans["placed"]), (&4.into(), &2.into()));
    }

    #[test]
    fn a_whole_log_is_reported_as_such() {
        let built = build_text(&GOOD.repeat(3), Rail::default(), &Interrupt::default());
        assert_eq!(built.finish.as_ref().unwrap(), &Finish::Whole);
        let report = built.report();
        assert_eq!(report["map"]["length_m"], 5.0);
        assert_eq!(report["map"]["bytes"], built.read("map.json").len());
        assert!(report["partial"].is_null());
        let stages: Vec<&str> = report["stages"]
            .as_array()
            .unwrap()
            .iter()
            .map(|s| s["stage"].as_str().unwrap())
            .collect();
        assert_eq!(stages, ["read", "map", "finish", "write", "draw"]);
    }

    #[test]
    fn ctrl_c_leaves_a_partial_map_and_says_so() {
        let interrupt = Interrupt::default();
        let mapper = Rail {
            interrupt_after: Some((2, interrupt.clone())),
            ..Rail::default()
        };
        let built = build_text(&GOOD.repeat(9), mapper, &interrupt);
        assert_eq!(built.finish.as_ref().unwrap(), &Finish::WithLoss);
        let map = read_map(&built.folder.path().join("map.json")).unwrap();
        assert_eq!(map.partial.as_deref(), Some("stopped by hand after 2 scans"));
        assert_eq!(built.read("trajectory.csv").lines().count(), 1 + 2);
    }

    #[test]
    fn a_log_of_unusable_lines_is_a_failure_and_leaves_no_map() {
        let built = build_text(&WRONG.repeat(2), Rail::default(), &Interrupt::default());
        let error = built.finish.as_ref().unwrap_err().to_string();
        assert!(
            error.contains("none of its 2 scans can be used; the first:")
                && error.contains("line 1: 3 ranges"),
            "{error}"
        );
        assert!(!built.folder.path().join("map.json").exists());
    }
}
