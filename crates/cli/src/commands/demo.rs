//! `polymapper demo`: a map of a real log that comes with the program.

use polymapper_core::mapper::Settings;
use polymapper_io::log::{self, ReadOptions};
use polymapper_io::out::prepare_folder;

use crate::Finish;
use crate::args::DemoArgs;
use crate::commands::build::{Also, build};
use crate::interrupt::Interrupt;
use crate::mapping::CoreMapping;
use crate::record::BuildRecord;
use crate::talk::say;

/// Where it comes from and who made it: `samples/README.md`.
const SAMPLE: &[u8] = include_bytes!("../../../../samples/killian.log.gz");

/// Runs the command.
pub fn run(args: &DemoArgs) -> anyhow::Result<Finish> {
    prepare_folder(&args.output)?;
    say(format_args!(
        "300 scans of the MIT Killian Court log by M. Bosse and J. Leonard (PyPI rtb-data, MIT licence)"
    ));
    let log = log::open_bytes("MIT Killian Court, 300 scans", SAMPLE, ReadOptions::default())?;
    let record = BuildRecord::create(&args.output, log.name(), true)?;
    build(
        log,
        CoreMapping::new(Settings::default(), record),
        &args.output,
        false,
        &Interrupt::listen()?,
        &Also::default(),
    )
}
