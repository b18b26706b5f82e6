//! The command line.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand};
use polymapper_io::log::ReadOptions;
use polymapper_sim::{PlanKind, ScannerKind};

/// A polygonal map from 2D laser scans, without odometry.
#[derive(Parser)]
#[command(
    version,
    after_help = "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 done but with scans not placed or input skipped."
)]
pub struct Args {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Subcommand)]
pub enum Command {
    /// Build a map from a laser log
    Build(BuildArgs),
    /// Write the polylines of every scan, one JSON object a line
    Extract(ExtractArgs),
    /// Write a log of a made-up place, and the truth about it
    Simulate(SimulateArgs),
    /// Build a map of a real log that comes with the program
    Demo(DemoArgs),
}

/// Which log, and what of it.
#[derive(clap::Args)]
pub struct LogArgs {
    /// Laser log, plain or gzip; `-` is standard input
    pub log: PathBuf,
    /// Use the poses in the log (they are not read unless told)
    #[arg(long)]
    pub use_odometry: bool,
    /// Kind of message to read, such as RLASER, where the log has several lasers [default: the front laser]
    #[arg(long, value_name = "KIND")]
    pub laser: Option<String>,
}

impl LogArgs {
    pub fn read_options(&self) -> ReadOptions {
        ReadOptions {
            use_odometry: self.use_odometry,
            laser: self.laser.clone(),
        }
    }
}

#[derive(clap::Args)]
pub struct BuildArgs {
    #[command(flatten)]
    pub log: LogArgs,
    /// Folder for the map, the trajectory and the report; made if it is not there
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
}

#[derive(clap::Args)]
pub struct ExtractArgs {
    /// Laser log, plain or gzip; `-` is standard input
    pub log: PathBuf,
    /// Kind of message to read, such as RLASER, where the log has several lasers [default: the front laser]
    #[arg(long, value_name = "KIND")]
    pub laser: Option<String>,
    /// File for the polylines; `-` is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    pub output: PathBuf,
    /// Most vertices of all polylines of a scan together [default: as many as the noise supports]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    pub vertices: Option<u32>,
}

#[derive(clap::Args)]
pub struct DemoArgs {
    /// Folder for the result; made if it is not there
    #[arg(short, long, value_name = "FOLDER", default_value = "polymapper-demo")]
    pub output: PathBuf,
}

#[derive(clap::Args)]
pub struct SimulateArgs {
    /// Kind of floor plan
    #[arg(long, default_value = "office", value_parser = plan_kind())]
    pub plan: PlanKind,
    /// Seed of everything that is drawn at random
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Device
    #[arg(long, default_value = "sick180", value_parser = scanner_kind())]
    pub scanner: ScannerKind,
    /// People who walk about
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub people: usize,
    /// Keep a scan every metre or 40° only
    #[arg(long)]
    pub keyframes: bool,
    /// Most scans [default: the whole tour]
    #[arg(long, value_name = "N")]
    pub scans: Option<usize>,
    /// CARMEN log to write, gzip if the name ends in .gz; `-` is standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// File for the truth (poses, walls, people) [default: beside the log, ending in .truth.json]
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
}

fn plan_kind() -> impl TypedValueParser<Value = PlanKind> {
    PossibleValuesParser::new(PlanKind::ALL.map(PlanKind::name)).try_map(|name| name.parse())
}

fn scanner_kind() -> impl TypedValueParser<Value = ScannerKind> {
    PossibleValuesParser::new(ScannerKind::ALL.map(ScannerKind::name)).try_map(|name| name.parse())
}
