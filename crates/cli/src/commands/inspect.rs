//! `polymapper inspect`: log → what is in it, on standard output.

use std::io::{self, Write};

use anyhow::Context;
use polymapper_io::inspect::{Inspection, Stamps, inspect};
use polymapper_io::log::ReadOptions;

use crate::args::InspectArgs;
use crate::{Finish, scans};

/// Kinds of geometry that are told one by one.
const KINDS_TOLD: usize = 4;

/// Runs the command.
pub fn run(args: &InspectArgs) -> anyhow::Result<Finish> {
    let options = ReadOptions {
        use_odometry: true,
        keep_raw: true,
        ..args.log.read_options()
    };
    let mut log = scans::open(&args.log.log, options)?;
    let found = inspect(&mut log).context("cannot use the log")?;
    let mut out = io::stdout().lock();
    if args.json {
        serde_json::to_writer_pretty(&mut out, &found)?;
        writeln!(out)?;
    } else {
        write(&mut out, &found)?;
    }
    Ok(Finish::with_loss(
        found.broken.is_some() || !found.bad_scans.is_empty(),
    ))
}

fn write(out: &mut impl Write, found: &Inspection) -> io::Result<()> {
    let packed = found
        .compression
        .as_ref()
        .map_or(String::new(), |c| format!(", {c}"));
    writeln!(
        out,
        "{}: {}{packed}, {:.1} MB",
        found.name,
        found.format,
        found.bytes as f64 / 1e6
    )?;
    let laser = found.laser.as_ref().map_or(String::new(), |l| format!(" of {l}"));
    writeln!(out, "scans       {}{laser}", found.scans)?;
    for (k, geometry) in found.geometries.iter().take(KINDS_TOLD).enumerate() {
        let last_deg = geometry.first_deg + geometry.step_deg * (geometry.beams - 1) as f64;
        writeln!(
            out,
            "{}{} beams from {:.2}° to {last_deg:.2}°, {:.4}° apart{}",
            if k == 0 { "geometry    " } else { "            " },
            geometry.beams,
            geometry.first_deg,
            geometry.step_deg,
            if found.geometries.len() > 1 || found.more_geometries > 0 {
                format!(" ({} scans)", geometry.scans)
            } else {
                String::new()
            }
        )?;
    }
    let untold = found.geometries.iter().skip(KINDS_TOLD).map(|g| g.scans);
    let others = untold.sum::<usize>() + found.more_geometries;
    if others > 0 {
        writeln!(out, "            others ({others} scans)")?;
    }
    write_ranges(out, found)?;
    match &found.stamps {
        Some(stamps) => write_stamps(out, stamps, found.scans)?,
        None => writeln!(out, "stamps      none")?,
    }
    if found.odometry_poses > 0 {
        writeln!(
            out,
            "odometry    {} poses, a way of {:.1} m; not used unless --use-odometry",
            found.odometry_poses, found.odometry_way_m
        )?;
    } else {
        writeln!(out, "odometry    none")?;
    }
    for bad in &found.bad_scans {
        writeln!(out, "left out    {} scans; the first: {}", bad.scans, bad.first)?;
    }
    if let Some(broken) = &found.broken {
        writeln!(out, "left out    {broken}")?;
    }
    for other in &found.not_used {
        let reason = other.reason.as_deref().unwrap_or("no scans");
        writeln!(out, "not used    {} {}: {reason}", other.messages, other.name)?;
    }
    for note in &found.notes {
        writeln!(out, "note        {note}")?;
    }
    Ok(())
}

fn write_ranges(out: &mut impl Write, found: &Inspection) -> io::Result<()> {
    let ranges = &found.ranges;
    writeln!(
        out,
        "returns     {:.1} % of {} beams, {:.3} to {:.3} m",
        100.0 * ranges.returns as f64 / ranges.beams.max(1) as f64,
        ranges.beams,
        ranges.shortest_m,
        ranges.longest_m
    )?;
    let mut codes: Vec<String> = ranges
        .codes
        .iter()
        .map(|code| format!("{} ({})", code.value, code.beams))
        .collect();
    if ranges.other_codes > 0 {
        codes.push(format!("others ({})", ranges.other_codes));
    }
    if codes.is_empty() {
        codes.push("never".to_owned());
    }
    writeln!(out, "no return   {}", codes.join(", "))
}

/// A time in seconds, to a millisecond unless it is none that a clock can show.
fn time(seconds: f64) -> String {
    const LATEST_S: f64 = 1e12;
    if seconds.abs() < LATEST_S {
        format!("{seconds:.3}")
    } else {
        format!("{seconds:e}")
    }
}

fn write_stamps(out: &mut impl Write, stamps: &Stamps, scans: usize) -> io::Result<()> {
    let (first, last) = (time(stamps.first_s), time(stamps.last_s));
    write!(out, "stamps      {first} to {last} s")?;
    match stamps.median_step_s {
        Some(_) if stamps.are_useless() => write!(out, ", useless: most are no later than the one before")?,
        Some(step_s) => write!(out, ", {:.1} Hz", 1.0 / step_s)?,
        None => write!(out, ", useless: none is later than the one before")?,
    }
    if stamps.stamped < scans {
        write!(out, "; {} scans without", scans - stamps.stamped)?;
    }
    if stamps.backwards > 0 {
        write!(
            out,
            "; {} run backwards, by {:.3} s at most",
            stamps.backwards, stamps.most_backwards_s
        )?;
    }
    if stamps.repeated > 0 && stamps.median_step_s.is_some() {
        write!(out, "; {} repeated", stamps.repeated)?;
    }
    if let (true, Some(gap)) = (stamps.gaps > 0, &stamps.longest_gap) {
        write!(
            out,
            "; {} gaps, the longest {:.1} s after scan {}",
            stamps.gaps, gap.seconds, gap.after_scan
        )?;
    }
    writeln!(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stamp_that_no_clock_shows_is_said_in_a_word() {
        assert_eq!(time(976_052_857.337_8), "976052857.338");
        assert_eq!(time(1e300), "1e300");
    }
}
