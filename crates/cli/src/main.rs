//! `polymapper`: a polygonal map from a laser log, in one command.
//!
//! Standard output is for data, standard error for talk. Exit codes: 0 done, 1 failed, 2 wrong usage,
//! 3 done, but with scans not placed or input skipped. A reader of our output that goes away (`| head`) is no
//! failure.

mod args;
mod clock;
mod commands;
mod exports;
mod interrupt;
mod map_folder;
mod mapping;
mod memory;
mod pictures;
mod progress;
mod record;
mod report_html;
mod scans;
mod shape_match;
mod talk;

use std::io;
use std::process::ExitCode;

use clap::Parser;

use crate::args::{Args, Command};
use crate::talk::say;

/// How a command that did not fail came to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Finish {
    /// Everything was used.
    Whole,
    /// Something was left out, and said.
    WithLoss,
}

impl Finish {
    fn with_loss(loss: bool) -> Self {
        if loss { Self::WithLoss } else { Self::Whole }
    }
}

fn main() -> ExitCode {
    let args = Args::parse();
    let result = match args.command {
        Command::Build(args) => commands::build::run(&args),
        Command::Inspect(args) => commands::inspect::run(&args),
        Command::Convert(args) => commands::convert::run(&args),
        Command::Export(args) => commands::export::run(&args),
        Command::Import(args) => commands::import::run(&args),
        Command::Extract(args) => commands::extract::run(&args),
        Command::Figures(args) => commands::figures::run(&args),
        Command::Match(args) => commands::match_scans::run(&args),
        Command::Locate(args) => commands::locate::run(&args),
        Command::Merge(args) => commands::merge::run(&args),
        Command::Simulate(args) => commands::simulate::run(&args),
        Command::View(args) => commands::view::run(&args),
        Command::Play(args) => commands::play::run(&args),
        Command::Demo(args) => commands::demo::run(&args),
    };
    match result {
        Ok(Finish::Whole) => ExitCode::SUCCESS,
        Ok(Finish::WithLoss) => ExitCode::from(3),
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            say(format_args!("error: {error:#}"));
            ExitCode::FAILURE
        }
    }
}

/// Whether whoever read our standard output has gone.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<io::Error>())
        .any(|cause| cause.kind() == io::ErrorKind::BrokenPipe)
}
