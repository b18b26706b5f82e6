//! `polymapper merge` and `polymapper build --into`: two maps joined by their shape.

use std::path::Path;

use anyhow::Context;
use polymapper_core::join::{Joined, SavedMap};
use polymapper_core::mapper::{Mapper, Settings};
use polymapper_io::log::Entry;
use polymapper_io::out::{Outcome, TrajectoryRow, prepare_folder};

use crate::args::{BuildArgs, MergeArgs};
use crate::interrupt::Interrupt;
use crate::map_folder::{LaserLine, MapFolder};
use crate::mapping::{Noted, outcome};
use crate::scans::{self, Reading};
use crate::talk::{say, say_loose};
use crate::{Finish, pictures};

/// Where the map of a log goes that could not be joined.
const APART: &str = "apart";

/// Runs `merge`.
pub fn run(args: &MergeArgs) -> anyhow::Result<Finish> {
    let (first, second) = (MapFolder::read(&args.first)?, MapFolder::read(&args.second)?);
    let joined = first
        .saved
        .join(&second.saved, first.rows.len(), &Settings::default())
        .with_context(|| {
            format!(
                "{} and {} are not joined",
                args.first.display(),
                args.second.display()
            )
        })?;
    prepare_folder(&args.output)?;
    write_joined(first, second, joined, &args.output)?;
    Ok(Finish::Whole)
}

/// Runs `build --into`.
pub fn continue_map(args: &BuildArgs, old: &Path) -> anyhow::Result<Finish> {
    let first = MapFolder::read(old)?;
    let output = args.output.as_deref().unwrap_or(old);
    prepare_folder(output)?;
    let (mut second, reading) = map_log(args)?;
    let has_loss = reading.has_loss() || second.rows.iter().any(|r| !is_placed(r));
    match first
        .saved
        .join(&second.saved, first.rows.len(), &Settings::default())
    {
        Ok(joined) => {
            second.partial = reading.partial;
            write_joined(first, second, joined, output)?;
            Ok(Finish::with_loss(has_loss))
        }
        Err(why) => {
            let apart = args.output.clone().unwrap_or_else(|| old.join(APART));
            prepare_folder(&apart)?;
            second.partial = reading.partial;
            second.write(&apart)?;
            pictures::write(
                &apart,
                &second.map,
                &second.rows,
                &args.log.choice.log.to_string_lossy(),
            )?;
            say(format_args!("not joined to {}: {why}", old.display()));
            say(format_args!(
                "the map of the log is kept apart: {}",
                apart.display()
            ));
            Ok(Finish::WithLoss)
        }
    }
}

/// Maps the log by itself.
fn map_log(args: &BuildArgs) -> anyhow::Result<(MapFolder, Reading)> {
    let mut log = scans::open(&args.log.choice.log, args.log.read_options())?;
    let mut mapper = Mapper::new(Settings::default());
    let (mut lines, mut noted, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let reading = scans::for_each(&mut log, &Interrupt::listen()?, |entry| {
        lines.push(LaserLine::of(&entry));
        if let Entry::Scan(scan) = entry {
            numbers.push(scan.index);
            noted.push(Noted::of(&mapper.add_scan(&scan.scan, scan.odometry)));
        }
        Ok(())
    })?;
    mapper.settle();
    let loose = mapper.loose_stretches().into_iter();
    say_loose(&loose.map(|l| l.numbered(&numbers)).collect::<Vec<_>>());
    let outcomes = mapper.outcomes().iter().map(outcome).collect();
    let second = MapFolder::of(lines, mapper.map(), outcomes, &noted, mapper.saved())?;
    Ok((second, reading))
}

fn write_joined(first: MapFolder, second: MapFolder, joined: Joined, folder: &Path) -> anyhow::Result<()> {
    let Joined {
        saved,
        map,
        agreeing,
        tied,
    } = joined;
    let (now_first, now_second) = saved.keyframes.split_at(first.saved.keyframes.len());
    let scans_before = first.rows.len();
    let mut rows = moved(
        first.rows,
        &first.saved,
        now_first.iter().map(|k| k.map_from_scan),
    );
    let after = moved(
        second.rows,
        &second.saved,
        now_second.iter().map(|k| k.map_from_scan),
    );
    rows.extend(after.into_iter().map(|row| TrajectoryRow {
        scan: row.scan + scans_before,
        recognised: row.recognised.map(|scan| scan + scans_before),
        ..row
    }));
    let result = MapFolder {
        map,
        rows,
        saved,
        partial: second.partial,
        turned_rad: 0.0,
    };
    result.write(folder)?;
    pictures::write(folder, &result.map, &result.rows, "joined map")?;
    let placed = result.rows.iter().filter(|r| is_placed(r)).count();
    say(format_args!(
        "joined: {agreeing} places of the second map were found in the first, {tied} of its keyframes are tied to it"
    ));
    say(format_args!(
        "{placed} of {} scans placed; {} polylines: {}",
        result.rows.len(),
        result.map.polylines.len(),
        folder.join("map.json").display()
    ));
    Ok(())
}

fn is_placed(row: &TrajectoryRow) -> bool {
    matches!(row.outcome, Outcome::Placed { .. })
}

/// Every scan moves with the keyframe that it was placed after.
fn moved(
    rows: Vec<TrajectoryRow>,
    before: &SavedMap,
    now: impl Iterator<Item = polymapper_core::geometry::Pose>,
) -> Vec<TrajectoryRow> {
    let moves: Vec<(usize, _)> = before
        .keyframes
        .iter()
        .zip(now)
        .map(|(k, now)| (k.number, now * k.map_from_scan.inverse()))
        .collect();
    let by = |scan: usize| {
        let after = moves.partition_point(|m| m.0 <= scan);
        moves.get(after.saturating_sub(1)).map(|m| m.1)
    };
    rows.into_iter()
        .map(|mut row| {
            if let (Outcome::Placed { map_from_scan }, Some(by)) = (&mut row.outcome, by(row.scan)) {
                *map_from_scan = by * *map_from_scan;
            }
            row
        })
        .collect()
}
