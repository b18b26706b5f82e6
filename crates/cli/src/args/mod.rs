//! The command line.

mod log;
mod scan_place;

use std::net::IpAddr;
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand};
use polymapper_io::out::formats::ExportFormat;
use polymapper_sim::{PlanKind, ScannerKind};

use crate::commands::export::ExportArgs;
use crate::commands::import::ImportArgs;
use crate::exports::{ExportChoice, format_parser};
pub use log::{LogArgs, LogChoice, ReadingChoice};
pub use scan_place::ScanPlace;

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
    /// Say what is in a log before a map is built of it
    ///
    /// Topics, scans, geometry, rates, what stands for no return, gaps, stamps that run backwards,
    /// and what will be left out and why; on standard output.
    Inspect(InspectArgs),
    /// Write the scans of a log in another format
    ///
    /// The ending of OUT says which: .log, .clf or .carmen for CARMEN (ROBOTLASER1), .mcap for
    /// MCAP (sensor_msgs/LaserScan, nav_msgs/Odometry); a further .gz packs a CARMEN log. Poses
    /// of odometry are kept. Ranges, bearings and stamps keep every bit in CARMEN; MCAP holds
    /// single precision, as LaserScan does.
    Convert(ConvertArgs),
    /// Write a finished map in the formats of other programs
    ///
    /// The files are named after the map, with an ending for each format. A format that cannot
    /// do without the trajectory, the scans or a place on Earth says so.
    Export(ExportArgs),
    /// Read back a map that was exported and edited by hand
    ///
    /// SVG, DXF, JSON-FG and GeoJSON are known by their content. Lines that still carry their id
    /// keep it, new ones get the next free one. What is no line is left out and counted, and the
    /// exit code is 3.
    Import(ImportArgs),
    /// Write the polylines of every scan, one JSON object a line
    Extract(ExtractArgs),
    /// Draw the figures of the paper from a log
    ///
    /// Each as SVG and PNG:
    ///
    ///   fig1  all scans at the poses in the log, the same with the rotation corrected by long
    ///         walls, the aligned scans, the polygonal map
    ///   fig2  one scan raw, grouped to polylines, and simplified at 1, 5, 10 and 15 mm
    ///   fig3  two scans far apart, matched by shape alone
    ///   fig4  a vertex of the map that no simulated ray hits, and how it passes into the new map
    ///
    /// The poses in the log serve fig1 (a) and (b) only; the mapper does not see them. A figure
    /// for which the log has nothing to show is left out, said on standard error, and the exit
    /// code is 3.
    #[command(verbatim_doc_comment)]
    Figures(FiguresArgs),
    /// Match two scans by shape: where was the scanner the second time?
    ///
    /// No odometry is used. The answer is JSON on standard output. A pose is where the scanner
    /// of B stood and looked in the frame of scan A (x ahead, y left; metres, radians).
    ///
    /// verdict:
    ///   sure       one pose leads clearly, and the walls fix it in every direction
    ///   ambiguous  another pose explains the walls nearly as well, or the walls leave a
    ///              direction open (a corridor)
    ///   none       no pose explains a good part of the walls
    /// Shape cannot tell two places that look alike: sure is about the pose, given that both
    /// scans are of one place.
    ///
    /// hypotheses, best first:
    ///   x_m, y_m, theta_rad   the pose
    ///   score                 what they are ranked by; only differences mean something
    ///   explained_ratio       share of the walls of B that lie on walls of A
    ///   contradicted_ratio    share of the walls of both that the other looked through
    ///   unobservable          direction [x, y] in which the walls leave the place open, or null
    ///   sigma_x_m, sigma_y_m, sigma_theta_rad
    ///                         standard deviations; null where a direction is open
    ///
    /// correspondences, for the best pose:
    ///   a, b                  polylines that belong together, numbered as by `extract`
    ///   shape_cost_rad2       how unlike their shapes are
    #[command(verbatim_doc_comment)]
    Match(MatchArgs),
    /// Find the scans of a log in a finished map
    ///
    /// No guess is needed. Every scan has a row on standard output: scan (counted from 0), outcome, x_m, y_m,
    /// heading_deg (pose of the laser in the map), score (1: every beam ends where the map says),
    /// second (score of the next best, different pose).
    ///
    /// outcome:
    ///   located    one pose explains the scan, and no other comes near
    ///   ambiguous  another pose explains it nearly as well, or the walls leave a direction open;
    ///              the best pose is given
    ///   not_found  no pose explains it
    ///
    /// While scans follow each other closely, a pose is carried on from scan to scan in the map, which does not change.
    /// The exit code is 3 when not all scans are located.
    #[command(verbatim_doc_comment)]
    Locate(LocateArgs),
    /// Join two maps by their shape
    ///
    /// FIRST keeps its place; SECOND is found in it without a guess, moved and tied to it wherever both have seen the
    /// same walls. The maps are not joined, and the exit code is 1, when they have too little in common, do not
    /// fit where they overlap, or could be joined in more than one way.
    Merge(MergeArgs),
    /// Write a log of a made-up place, and the truth about it
    Simulate(SimulateArgs),
    /// Watch a map grow in the browser
    ///
    /// Opens a page on this machine. SOURCE is
    ///
    ///   a log              mapped while you watch; then played back at will
    ///   a folder           that `build` has written, played back
    ///   -                  scans from standard input as they come: CARMEN lines or JSON lines
    ///   `tcp:[HOST:]PORT`  the same from whoever connects to this port, one after the other
    ///
    /// A JSON line is {"ranges_m": [1.23, null, ..], "first_bearing_rad": -1.5708, "step_rad":
    /// 0.0175, "stamp_s": 12.5}. Without the two angles the ranges look half a turn ahead.
    #[command(verbatim_doc_comment)]
    View(ViewArgs),
    /// Write the scans of a log as JSON lines, at the pace at which they were recorded
    Play(PlayArgs),
    /// Build a map of a real log that comes with the program
    Demo(DemoArgs),
}

#[derive(clap::Args)]
pub struct BuildArgs {
    #[command(flatten)]
    pub log: LogArgs,
    /// Folder for the map, the trajectory and the report; made if it is not there [with --into: the folder that is continued]
    #[arg(short, long, value_name = "FOLDER", required_unless_present = "into")]
    pub output: Option<PathBuf>,
    /// Folder of a map that this log continues: the log is mapped, found in that map by its shape, and joined to it
    ///
    /// Scans of the log are counted on in the trajectory. Where the log cannot be found, or in more than one way,
    /// its map is kept apart, in OUTPUT or in the subfolder `apart`, and the exit code is 3. No report is written.
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["export", "align_axes"])]
    pub into: Option<PathBuf>,
    /// Turn the map so that most of its walls run along x and y
    #[arg(long)]
    pub align_axes: bool,
    /// Leave out replay.jsonl.gz: `view` then shows the map, but not how it grew
    #[arg(long)]
    pub no_replay: bool,
    /// Formats to write as well, as `export --to` does; those that want scans have them
    #[arg(long, value_name = "FORMAT", value_delimiter = ',', value_parser = format_parser())]
    pub export: Vec<&'static ExportFormat>,
    #[command(flatten)]
    pub choice: ExportChoice,
}

#[derive(clap::Args)]
pub struct InspectArgs {
    #[command(flatten)]
    pub log: LogChoice,
    /// Write JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(clap::Args)]
pub struct ConvertArgs {
    #[command(flatten)]
    pub log: LogChoice,
    /// File to write
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
}

#[derive(clap::Args)]
pub struct ViewArgs {
    /// Laser log, plain or packed, or a folder with its parts; folder of a build; `-`; or `tcp:[HOST:]PORT`
    #[arg(value_name = "SOURCE")]
    pub source: PathBuf,
    #[command(flatten)]
    pub reading: ReadingChoice,
    /// Use the poses in the log (they are not read unless told)
    #[arg(long)]
    pub use_odometry: bool,
    /// Port of the page; 0 takes any that is free
    #[arg(long, value_name = "PORT", default_value_t = 7878)]
    pub port: u16,
    /// Address of the page; other machines can see it if this is not the local one
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    pub host: IpAddr,
    /// Open the page in the browser
    #[arg(long)]
    pub open: bool,
}

#[derive(clap::Args)]
pub struct PlayArgs {
    #[command(flatten)]
    pub log: LogArgs,
    /// Times the pace at which the log was recorded; 0 is as fast as possible
    #[arg(long, value_name = "TIMES", default_value_t = 1.0)]
    pub rate: f64,
    /// Scans a second, whatever the stamps say
    #[arg(long, value_name = "N", conflicts_with = "rate")]
    pub hz: Option<f64>,
    /// Where the lines go: `-` is standard output, tcp:HOST:PORT a connection
    #[arg(short, long, value_name = "PLACE", default_value = "-")]
    pub output: String,
}

#[derive(clap::Args)]
pub struct ExtractArgs {
    #[command(flatten)]
    pub log: LogChoice,
    /// File for the polylines; `-` is standard output
    #[arg(short, long, value_name = "FILE", default_value = "-")]
    pub output: PathBuf,
    /// Most vertices of all polylines of a scan together [default: as many as the noise supports]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..))]
    pub vertices: Option<u32>,
}

#[derive(clap::Args)]
pub struct FiguresArgs {
    #[command(flatten)]
    pub log: LogChoice,
    /// Folder for the figures; made if it is not there
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
    /// Scan of fig2, counted from 0 [default: one with many vertices close by]
    #[arg(long, value_name = "K")]
    pub scan: Option<usize>,
    /// Scans of fig3, counted from 0 [default: a pair a metre or 30° apart that is matched rightly]
    #[arg(long, value_name = "A,B", value_parser = scan_pair)]
    pub pair: Option<(usize, usize)>,
}

#[derive(clap::Args)]
pub struct MatchArgs {
    /// First scan: LOG:SCAN, or a log of one scan
    #[arg(value_name = "A")]
    pub first: ScanPlace,
    /// Second scan: LOG:SCAN, or a log of one scan
    #[arg(value_name = "B")]
    pub second: ScanPlace,
    /// Topic or kind of message to read, such as /scan or RLASER, where a log has several lasers [default: the best]
    #[arg(long, visible_alias = "topic", value_name = "NAME")]
    pub laser: Option<String>,
    /// Picture of the two scans and their correspondences
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}

fn scan_pair(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once(',').and_then(|(a, b)| {
        let number = |n: &str| n.trim().parse().ok();
        Some((number(a)?, number(b)?))
    });
    match numbers {
        Some((a, b)) if a != b => Ok((a, b)),
        Some(_) => Err("two different scans are needed".to_owned()),
        None => Err("two numbers of scans with a comma between are needed, such as 12,40".to_owned()),
    }
}

#[derive(clap::Args)]
pub struct LocateArgs {
    #[command(flatten)]
    pub log: LogChoice,
    /// Map to find the scans in, as `build` writes it
    #[arg(long, value_name = "MAP.JSON")]
    pub map: PathBuf,
    /// File for the rows as well: JSON lines with all poses if the name ends in .jsonl, else CSV
    #[arg(short, long, visible_alias = "out", value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Find every scan on its own, whatever the scans before say
    #[arg(long)]
    pub alone: bool,
}

#[derive(clap::Args)]
pub struct MergeArgs {
    /// Folder of a map, as `build` writes it
    #[arg(value_name = "FIRST")]
    pub first: PathBuf,
    /// Folder of the map that is joined to it
    #[arg(value_name = "SECOND")]
    pub second: PathBuf,
    /// Folder for the joined map; made if it is not there
    #[arg(short, long, visible_alias = "out", value_name = "FOLDER")]
    pub output: PathBuf,
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

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Args::command().debug_assert();
    }
}
