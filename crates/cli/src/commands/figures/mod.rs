//! `polymapper figures`: the figures of the paper, from any log.
//!
//! One pass over the log maps it and keeps its scans; the figures are drawn from what that pass leaves. The poses in
//! the log serve Fig. 1 (a) and (b) alone: the mapper is not given them.

mod log_poses;
mod one_scan;
mod pair;
mod rotation;
mod survey;
mod vertex;

use std::io::Write;
use std::path::Path;

use polymapper_core::geometry::Point;
use polymapper_draw::figures::{Overlay, Overview, overview};
use polymapper_draw::{Scene, to_png, to_svg};
use polymapper_io::log::ReadOptions;
use polymapper_io::out::{AtomicFile, prepare_folder};

use crate::Finish;
use crate::args::FiguresArgs;
use crate::interrupt::Interrupt;
use crate::scans;
use crate::talk::say;
use survey::Survey;

/// Runs the command.
pub fn run(args: &FiguresArgs) -> anyhow::Result<Finish> {
    prepare_folder(&args.output)?;
    let options = ReadOptions {
        use_odometry: true,
        ..args.log.read_options()
    };
    let mut log = scans::open(&args.log.log, options)?;
    let survey = Survey::take(&mut log, &Interrupt::listen()?)?;
    // Wrong numbers of scans are told before anything is written.
    let chosen = args.scan.map(|k| survey.number(k)).transpose()?;
    let pair = match args.pair {
        Some((a, b)) => Some((survey.number(a)?, survey.number(b)?)),
        None => None,
    };
    let figures = [
        ("fig1", Ok(fig1(&survey))),
        ("fig2", Ok(one_scan::draw(&survey, chosen))),
        ("fig3", pair::draw(&survey, pair)),
        ("fig4", vertex::draw(&survey)),
    ];
    let mut loss = survey.reading.has_loss();
    for (name, scene) in figures {
        match scene {
            Ok(scene) => write(&args.output, name, &scene)?,
            Err(Undrawn(reason)) => {
                say(format_args!("{name} left out: {reason}"));
                loss = true;
            }
        }
    }
    if let Some(partial) = &survey.reading.partial {
        say(format_args!("the figures are partial: {partial}"));
    }
    Ok(Finish::with_loss(loss))
}

/// Why a log has nothing to show in a figure.
#[derive(Debug)]
struct Undrawn(&'static str);

fn fig1(survey: &Survey) -> Scene {
    let log_poses = log_poses::Paths::of(survey);
    let overlay = |poses: &[polymapper_core::geometry::Pose]| {
        let points = survey.scans.iter().map(points);
        poses.iter().copied().zip(points).collect::<Vec<_>>()
    };
    let raw = log_poses.as_ref().map(|paths| overlay(&paths.raw));
    let corrected = log_poses.as_ref().map(|paths| overlay(&paths.rotation_corrected));
    let aligned: Vec<_> = survey
        .scans
        .iter()
        .filter_map(|scan| Some((scan.map_from_scan?, points(scan))))
        .collect();
    let input = Overview {
        odometry: raw.as_deref(),
        rotation_corrected: corrected.as_deref(),
        aligned: Some(&aligned as &Overlay),
        map: &survey.map,
    };
    let mut scene = overview(&input);
    scene.caption = format!("{}. {}", survey.name, scene.caption);
    scene
}

fn points(scan: &survey::SurveyedScan) -> Vec<Point> {
    scan.scan.points().map(|(_, point)| point).collect()
}

fn write(folder: &Path, name: &str, scene: &Scene) -> anyhow::Result<()> {
    let png = to_png(scene)?;
    let place = folder.join(name);
    AtomicFile::write(&place.with_extension("svg"), |f| {
        f.write_all(to_svg(scene).as_bytes())
    })?;
    let picture = place.with_extension("png");
    AtomicFile::write(&picture, |f| f.write_all(&png))?;
    say(format_args!("{}", picture.display()));
    Ok(())
}
