//! Which log a command takes, and how it is read.

use std::path::PathBuf;

use polymapper_io::log::{Layout, ReadOptions};

/// How a log is read.
#[derive(clap::Args)]
pub struct ReadingChoice {
    /// Topic or kind of message to read, such as /scan or RLASER, where the log has several lasers [default: the best]
    #[arg(long, visible_alias = "topic", value_name = "NAME")]
    pub laser: Option<String>,
    /// What the columns of a text file are, such as "stamp_ms range_mm*360 first_deg=0 step_deg=-1" (see docs/logs.md)
    #[arg(long, value_name = "WORDS")]
    pub layout: Option<Layout>,
    /// Read on behind a place where the recording does not hang together
    #[arg(long)]
    pub salvage: bool,
}

impl ReadingChoice {
    pub fn read_options(&self) -> ReadOptions {
        ReadOptions {
            laser: self.laser.clone(),
            layout: self.layout.clone(),
            salvage: self.salvage,
            ..ReadOptions::default()
        }
    }
}

/// Which log, and how it is read.
#[derive(clap::Args)]
pub struct LogChoice {
    /// Laser log, plain or packed, or a folder with its parts; `-` is standard input
    pub log: PathBuf,
    #[command(flatten)]
    pub reading: ReadingChoice,
}

impl LogChoice {
    pub fn read_options(&self) -> ReadOptions {
        self.reading.read_options()
    }
}

/// Which log, and what of it.
#[derive(clap::Args)]
pub struct LogArgs {
    #[command(flatten)]
    pub choice: LogChoice,
    /// Use the poses in the log (they are not read unless told)
    #[arg(long)]
    pub use_odometry: bool,
}

impl LogArgs {
    pub fn read_options(&self) -> ReadOptions {
        ReadOptions {
            use_odometry: self.use_odometry,
            ..self.choice.read_options()
        }
    }
}
