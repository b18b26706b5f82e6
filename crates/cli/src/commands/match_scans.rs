//! `polymapper match`: the pose between two scans, by shape alone.

use std::io::{self, Write};
use std::path::Path;

use anyhow::{Context, bail, ensure};
use polymapper_core::matching::{Correspondence, Hypothesis};
use polymapper_core::scan::Scan;
use polymapper_draw::to_svg;
use polymapper_io::log::{Entry, ReadOptions};
use polymapper_io::out::AtomicFile;
use serde_json::{Value, json};

use crate::Finish;
use crate::args::{MatchArgs, ScanPlace};
use crate::scans;
use crate::shape_match::ShapeMatch;

/// Runs the command.
pub fn run(args: &MatchArgs) -> anyhow::Result<Finish> {
    let is_stdin = |place: &ScanPlace| place.log == Path::new("-");
    ensure!(
        !(is_stdin(&args.first) && is_stdin(&args.second)),
        "only one of the two scans can come from standard input"
    );
    let read = |place| read_scan(place, args.laser.as_deref());
    let (first, second) = (read(&args.first)?, read(&args.second)?);
    let found = ShapeMatch::of(&first, &second);
    if let Some(svg) = &args.svg {
        let scene = found.scene(&format!(
            "{} (green) and {} (blue)",
            name(&args.first),
            name(&args.second)
        ));
        AtomicFile::write(svg, |f| f.write_all(to_svg(&scene).as_bytes()))?;
    }
    let mut out = io::stdout().lock();
    serde_json::to_writer_pretty(&mut out, &answer(&found)).map_err(io::Error::from)?;
    writeln!(out)?;
    Ok(Finish::Whole)
}

/// The scan at a place; of a log without a number, its only one.
fn read_scan(place: &ScanPlace, laser: Option<&str>) -> anyhow::Result<Scan> {
    let options = ReadOptions {
        laser: laser.map(str::to_owned),
        ..ReadOptions::default()
    };
    let mut log = scans::open(&place.log, options)?;
    let name = log.name().to_owned();
    let mut count = 0;
    let mut only = None;
    for entry in log.by_ref() {
        let (index, usable) = match entry? {
            Entry::Scan(scan) => (scan.index, Ok(scan.scan)),
            Entry::Bad(bad) => (bad.index, Err(bad)),
        };
        count += 1;
        if place.scan.is_none_or(|wanted| wanted == index) {
            let scan = usable.map_err(|bad| {
                anyhow::Error::new(bad.fault).context(format!("{name}, line {}: scan {index}", bad.line))
            })?;
            if place.scan.is_some() {
                return Ok(scan);
            }
            if only.replace(scan).is_some() {
                bail!("{name} has more than one scan; say which, counted from 0, as {name}:0");
            }
        }
    }
    only.with_context(|| match place.scan {
        Some(wanted) => format!("{name} has no scan {wanted}: its {count} scans count from 0"),
        None => format!("{name} has no scan"),
    })
}

/// As in the captions: "killian.log.gz, scan 7".
fn name(place: &ScanPlace) -> String {
    let log = scans::short_name(&place.log.to_string_lossy());
    match place.scan {
        Some(scan) => format!("{log}, scan\u{a0}{scan}"),
        None => log,
    }
}

fn answer(found: &ShapeMatch) -> Value {
    json!({
        "verdict": found.verdict.word(),
        "hypotheses": found.matching.hypotheses.iter().map(hypothesis).collect::<Vec<_>>(),
        "correspondences": found.matching.correspondences.iter().map(correspondence).collect::<Vec<_>>(),
    })
}

fn hypothesis(h: &Hypothesis) -> Value {
    let pose = h.reference_from_scan;
    let sigmas = h
        .information
        .covariance()
        .filter(|_| h.unobservable.is_none())
        .map(|c| [c[0][0].sqrt(), c[1][1].sqrt(), c[2][2].sqrt()]);
    let sigma = |k: usize| sigmas.map(|s| rounded(s[k], 1e6));
    json!({
        "x_m": rounded(pose.x, 1e4),
        "y_m": rounded(pose.y, 1e4),
        "theta_rad": rounded(pose.theta_rad, 1e6),
        "score": rounded(h.score, 1e4),
        "explained_ratio": rounded(h.explained_ratio, 1e4),
        "contradicted_ratio": rounded(h.contradicted_ratio, 1e4),
        "unobservable": h.unobservable.map(|d| [rounded(d.x, 1e4), rounded(d.y, 1e4)]),
        "sigma_x_m": sigma(0),
        "sigma_y_m": sigma(1),
        "sigma_theta_rad": sigma(2),
    })
}

fn correspondence(c: &Correspondence) -> Value {
    json!({
        "a": c.reference,
        "b": c.scan,
        "shape_cost_rad2": rounded(c.shape_cost_rad2, 1e6),
    })
}

/// As many decimals as carry meaning; no negative zero.
fn rounded(value: f64, per_unit: f64) -> f64 {
    (value * per_unit).round() / per_unit + 0.0
}
