//! `polymapper extract`: the polylines of every scan.

use std::io::{self, BufWriter, Write};
use std::path::Path;

use polymapper_core::extract::{ExtractSettings, extract, extract_with_budget};
use polymapper_core::scan::Scan;
use polymapper_io::log::Entry;
use polymapper_io::out::{AtomicFile, write_polylines};

use crate::args::ExtractArgs;
use crate::interrupt::Interrupt;
use crate::scans::{self, Reading};
use crate::{Finish, talk::say};

/// Runs the command.
pub fn run(args: &ExtractArgs) -> anyhow::Result<Finish> {
    let reading = if args.output == Path::new("-") {
        let mut out = BufWriter::new(io::stdout().lock());
        let reading = write_all(args, &mut out)?;
        out.flush()?;
        reading
    } else {
        let mut out = AtomicFile::create(&args.output)?;
        let reading = write_all(args, &mut out)?;
        out.finish()?;
        reading
    };
    if let Some(partial) = &reading.partial {
        say(format_args!("the result is partial: {partial}"));
    }
    Ok(Finish::with_loss(reading.has_loss()))
}

fn write_all(args: &ExtractArgs, out: &mut impl Write) -> anyhow::Result<Reading> {
    let mut log = scans::open(&args.log.log, args.log.read_options())?;
    let settings = ExtractSettings::default();
    scans::for_each(&mut log, &Interrupt::listen()?, |entry| {
        let Entry::Scan(scan) = entry else { return Ok(()) };
        let extraction = polylines(&scan.scan, args.vertices, &settings);
        write_polylines(out, scan.index, extraction.polylines.iter().map(|p| &p.polyline))?;
        Ok(())
    })
}

fn polylines(
    scan: &Scan,
    vertices: Option<u32>,
    settings: &ExtractSettings,
) -> polymapper_core::extract::Extraction {
    match vertices {
        Some(budget) => extract_with_budget(scan, budget as usize, settings),
        None => extract(scan, settings),
    }
}
