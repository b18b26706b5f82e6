//! `polymapper export`: a finished map in the formats of other programs.

use std::path::{Path, PathBuf};

use anyhow::Context;
use polymapper_io::out::formats::{ExportFormat, ScanSource};
use polymapper_io::out::{prepare_folder, read_map, read_trajectory_csv};

use crate::Finish;
use crate::args::ReadingChoice;
use crate::exports::{ExportChoice, Exported, LogScans, format_parser, use_scans, write_all};
use crate::talk::say;

/// Name of the trajectory that `build` puts beside a map.
const TRAJECTORY: &str = "trajectory.csv";

// How a log is read is nothing without a log.
#[derive(clap::Args)]
#[command(mut_group("ReadingChoice", |choice| choice.requires("log")))]
pub struct ExportArgs {
    /// Map to export, as `build` wrote it
    pub map: PathBuf,
    /// Formats, with commas between or the option again
    #[arg(long, value_name = "FORMAT", required = true, value_delimiter = ',', value_parser = format_parser())]
    pub to: Vec<&'static ExportFormat>,
    /// Folder for the files; made if it is not there [default: that of the map]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// How the names of the files begin [default: as the map's]
    #[arg(long)]
    pub name: Option<String>,
    /// Poses of the scans, as `build` wrote them [default: trajectory.csv beside the map, if it is there]
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// Log that the map was built of: nav2 and mcap carve free space from its scans, carmen writes them anew
    #[arg(long)]
    pub log: Option<PathBuf>,
    /// As it was given to `build`.
    #[command(flatten)]
    pub reading: ReadingChoice,
    #[command(flatten)]
    pub choice: ExportChoice,
}

/// Runs the command.
pub fn run(args: &ExportArgs) -> anyhow::Result<Finish> {
    let file = read_map(&args.map)?;
    if let Some(partial) = &file.partial {
        say(format_args!("note: the map is partial: {partial}"));
    }
    let folder = args.output.as_deref().unwrap_or_else(|| folder_of(&args.map));
    prepare_folder(folder)?;
    let beside = folder_of(&args.map).join(TRAJECTORY);
    let place = args
        .trajectory
        .clone()
        .or_else(|| beside.is_file().then_some(beside));
    let rows = place.as_deref().map(read_trajectory_csv).transpose()?;
    if let (None, Some(place)) = (&args.trajectory, &place) {
        say(format_args!("trajectory: {}", place.display()));
    }
    let scans = match (&args.log, &rows) {
        (Some(log), Some(rows)) => Some(LogScans::new(log, args.reading.read_options(), rows)?),
        (Some(_), None) => {
            anyhow::bail!("--log needs the poses of its scans: give --trajectory trajectory.csv")
        }
        (None, _) => None,
    };
    if args.log.is_some() && !use_scans(&args.to) {
        say(format_args!("note: none of these formats makes use of the scans"));
    }
    let stem = stem(args)?;
    let exported = Exported {
        map: &file.map,
        trajectory: rows.as_deref(),
        scans: scans.as_ref().map(|scans| scans as &dyn ScanSource),
        title: &stem,
    };
    write_all(&args.to, &args.choice, &exported, folder, &stem)?;
    Ok(Finish::Whole)
}

fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// How the names of the files begin.
fn stem(args: &ExportArgs) -> anyhow::Result<String> {
    let of_map = || {
        args.map
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned())
    };
    let stem = args.name.clone().or_else(of_map).context("the map has no name")?;
    anyhow::ensure!(
        !stem.is_empty() && !stem.contains(['/', '\\']),
        "\"{stem}\" cannot begin the name of a file; folders go to --output"
    );
    Ok(stem)
}
