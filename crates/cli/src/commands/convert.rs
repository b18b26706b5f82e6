//! `polymapper convert`: log → the same scans in another format.

use std::io::{self, Write};
use std::path::Path;

use anyhow::Context;
use flate2::Compression;
use flate2::write::GzEncoder;
use polymapper_io::log::{Entry, ReadOptions};
use polymapper_io::log_out::LogFormat;
use polymapper_io::out::AtomicFile;

use crate::args::ConvertArgs;
use crate::interrupt::Interrupt;
use crate::talk::say;
use crate::{Finish, scans};

/// Runs the command.
pub fn run(args: &ConvertArgs) -> anyhow::Result<Finish> {
    let to_stdout = args.output == Path::new("-");
    let name = args.output.display().to_string();
    let format = if to_stdout {
        LogFormat::Carmen
    } else {
        LogFormat::of_name(&name).with_context(|| {
            format!("{name}: the ending says no format; .log, .clf, .carmen (each also with .gz) and .mcap are known")
        })?
    };
    let options = ReadOptions {
        use_odometry: true,
        ..args.log.read_options()
    };
    let mut log = scans::open(&args.log.log, options)?;
    if to_stdout {
        let mut out = io::stdout().lock();
        return convert(&mut log, format, &mut out, "standard output");
    }
    let mut file = AtomicFile::create(&args.output)?;
    let finish = if name.to_ascii_lowercase().ends_with(".gz") {
        let mut packed = GzEncoder::new(&mut file, Compression::default());
        let finish = convert(&mut log, format, &mut packed, &name)?;
        packed.finish().with_context(|| format!("cannot write {name}"))?;
        finish
    } else {
        convert(&mut log, format, &mut file, &name)?
    };
    file.finish()?;
    Ok(finish)
}

fn convert(
    log: &mut polymapper_io::log::Log,
    format: LogFormat,
    out: &mut impl Write,
    name: &str,
) -> anyhow::Result<Finish> {
    let cannot_write = || format!("cannot write {name}");
    let mut writer = format.writer(out, "/scan").with_context(cannot_write)?;
    let reading = scans::for_each(log, &Interrupt::listen()?, |entry| {
        if let Entry::Scan(scan) = entry {
            writer.write_scan(&scan).with_context(cannot_write)?;
        }
        Ok(())
    })?;
    writer.finish().with_context(cannot_write)?;
    say(format_args!("{} scans: {name}", reading.tally.scans));
    Ok(Finish::with_loss(reading.has_loss()))
}
