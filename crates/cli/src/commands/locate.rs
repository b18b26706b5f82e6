//! `polymapper locate`: where the scans of a log are in a finished map.

use std::collections::BTreeMap;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::time::Instant;

use polymapper_core::locate::{LocateSettings, Locator, Tracked, Tracker, Verdict};
use polymapper_io::log::{Entry, LogScan};
use polymapper_io::out::{AtomicFile, LocatedPose, LocationFormat, LocationRow, read_map};

use crate::args::LocateArgs;
use crate::interrupt::Interrupt;
use crate::scans::{self, Reading};
use crate::{Finish, talk::say};

/// Runs the command.
pub fn run(args: &LocateArgs) -> anyhow::Result<Finish> {
    let map = read_map(&args.map)?.map;
    let mut out = Rows::create(args.output.as_deref())?;
    let mut log = scans::open(&args.log.log, args.log.read_options())?;
    let mut tracker = Tracker::new(Locator::new(&map, LocateSettings::default()));
    let mut tally = Tally::default();
    let reading = scans::for_each(&mut log, &Interrupt::listen()?, |entry| {
        let row = match entry {
            Entry::Scan(scan) => {
                let begin = Instant::now();
                if args.alone {
                    tracker.forget();
                }
                let found = tracker.add_scan(&scan.scan, scan.stamp_s);
                tally.times_s.push(begin.elapsed().as_secs_f64());
                row(&scan, &found)
            }
            Entry::Bad(bad) => LocationRow {
                scan: bad.index,
                stamp_s: None,
                outcome: word(Verdict::NotFound),
                tracked: false,
                confidence: 0.0,
                poses: Vec::new(),
                reason: format!("unusable line {}: {}", bad.line, bad.fault),
            },
        };
        *tally.outcomes.entry(row.outcome).or_insert(0) += 1;
        out.write(&row)
    })?;
    out.finish()?;
    tally.tell(&reading);
    let all = tally.outcomes.keys().all(|&o| o == word(Verdict::Located));
    Ok(Finish::with_loss(reading.has_loss() || !all))
}

fn row(scan: &LogScan, found: &Tracked) -> LocationRow {
    LocationRow {
        scan: scan.index,
        stamp_s: scan.stamp_s,
        outcome: word(found.localisation.verdict),
        tracked: found.is_carried_on,
        confidence: found.localisation.confidence,
        poses: found
            .localisation
            .fixes
            .iter()
            .map(|f| LocatedPose {
                map_from_scan: f.map_from_scan,
                score: f.score,
            })
            .collect(),
        reason: String::new(),
    }
}

fn word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Located => "located",
        Verdict::Ambiguous => "ambiguous",
        Verdict::NotFound => "not_found",
    }
}

/// The table on standard output, and the file.
struct Rows {
    table: BufWriter<io::Stdout>,
    file: Option<(AtomicFile, LocationFormat)>,
}

impl Rows {
    fn create(file: Option<&Path>) -> anyhow::Result<Self> {
        let mut table = BufWriter::new(io::stdout());
        LocationFormat::Table.write_head(&mut table)?;
        let mut file = file
            .map(|path| anyhow::Ok((AtomicFile::create(path)?, format_of(path))))
            .transpose()?;
        if let Some((file, format)) = &mut file {
            format.write_head(file)?;
        }
        Ok(Self { table, file })
    }

    fn write(&mut self, row: &LocationRow) -> anyhow::Result<()> {
        LocationFormat::Table.write_row(&mut self.table, row)?;
        if let Some((file, format)) = &mut self.file {
            format.write_row(file, row)?;
        }
        Ok(())
    }

    fn finish(mut self) -> anyhow::Result<()> {
        self.table.flush()?;
        if let Some((file, _)) = self.file {
            file.finish()?;
        }
        Ok(())
    }
}

fn format_of(path: &Path) -> LocationFormat {
    let is_json = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("jsonl") || e.eq_ignore_ascii_case("json"));
    if is_json {
        LocationFormat::JsonLines
    } else {
        LocationFormat::Csv
    }
}

#[derive(Default)]
struct Tally {
    outcomes: BTreeMap<&'static str, usize>,
    times_s: Vec<f64>,
}

impl Tally {
    fn tell(&mut self, reading: &Reading) {
        let total: usize = self.outcomes.values().sum();
        let words: Vec<String> = self.outcomes.iter().map(|(w, n)| format!("{n} {w}")).collect();
        self.times_s.sort_by(f64::total_cmp);
        let mean_s = self.times_s.iter().sum::<f64>() / self.times_s.len().max(1) as f64;
        let p99_s = self
            .times_s
            .get(self.times_s.len() * 99 / 100)
            .copied()
            .unwrap_or_default();
        say(format_args!(
            "{total} scans: {}; {:.1} ms a scan, 99 % within {:.1} ms",
            words.join(", "),
            1e3 * mean_s,
            1e3 * p99_s
        ));
        if let Some(partial) = &reading.partial {
            say(format_args!("the result is partial: {partial}"));
        }
    }
}
