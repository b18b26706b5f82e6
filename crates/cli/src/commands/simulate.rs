//! `polymapper simulate`: a log of a made-up place, and the truth about it.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use polymapper_io::out::AtomicFile;
use polymapper_sim::{Motion, Scanner, SimLog, SimSettings, simulate};

use crate::Finish;
use crate::args::SimulateArgs;
use crate::talk::say;

/// Runs the command.
pub fn run(args: &SimulateArgs) -> anyhow::Result<Finish> {
    let log = simulate(&settings(args))?;
    if args.output == Path::new("-") {
        let mut out = BufWriter::new(io::stdout().lock());
        log.write_carmen(&mut out)?;
        out.flush()?;
    } else {
        AtomicFile::write(&args.output, |file| write_log(&log, file, is_gzip(&args.output)))?;
        say(format_args!(
            "{} scans: {}",
            log.scans.len(),
            args.output.display()
        ));
    }
    if let Some(truth) = truth_place(args) {
        AtomicFile::write(&truth, |file| log.write_truth(file))?;
        say(format_args!("truth: {}", truth.display()));
    }
    Ok(Finish::Whole)
}

fn settings(args: &SimulateArgs) -> SimSettings {
    let motion = if args.keyframes {
        Motion::keyframes()
    } else {
        Motion::full_rate()
    };
    SimSettings {
        scanner: Scanner::new(args.scanner),
        motion: Motion {
            max_scans: args.scans.unwrap_or(motion.max_scans),
            ..motion
        },
        people: args.people,
        ..SimSettings::new(args.plan, args.seed)
    }
}

/// Where the truth goes: where it is told to, or beside the log.
fn truth_place(args: &SimulateArgs) -> Option<PathBuf> {
    let beside_log = || {
        let log = if is_gzip(&args.output) {
            args.output.with_extension("")
        } else {
            args.output.clone()
        };
        (args.output != Path::new("-")).then(|| log.with_extension("truth.json"))
    };
    args.truth.clone().or_else(beside_log)
}

fn is_gzip(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "gz")
}

fn write_log(log: &SimLog, file: &mut AtomicFile, gzip: bool) -> io::Result<()> {
    if !gzip {
        return log.write_carmen(file);
    }
    let mut packed = GzEncoder::new(file, Compression::default());
    log.write_carmen(&mut packed)?;
    packed.finish()?;
    Ok(())
}
