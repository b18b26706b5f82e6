//! Goes through the scans of a log with progress bar, Ctrl-C and the faults of the log told.

use std::path::Path;

use anyhow::{Context, bail};
use polymapper_io::log::{self, BadScan, Entry, Log, LogError, Tally};

use crate::interrupt::Interrupt;
use crate::progress::Progress;

/// Faulty lines that are told one by one; the rest is only counted.
const MOST_TOLD: usize = 5;

/// How the reading of a log ended.
pub struct Reading {
    pub tally: Tally,
    /// Why the log was not read to its end; `None` when it was.
    pub partial: Option<String>,
}

impl Reading {
    /// Whether something of the log was not used.
    pub fn has_loss(&self) -> bool {
        self.partial.is_some() || self.tally.lost.is_some() || self.tally.bad_scans > 0
    }
}

/// Gives every laser line of `log` to `each`, until the end, a fault of the stream, or Ctrl-C.
///
/// # Errors
/// Those of `each`; a log without one usable scan.
pub fn for_each(
    log: &mut Log,
    interrupt: &Interrupt,
    mut each: impl FnMut(Entry) -> anyhow::Result<()>,
) -> anyhow::Result<Reading> {
    let progress = Progress::new(log.progress());
    let (mut done, mut told) = (0, 0);
    let mut first_bad = None;
    let mut partial = None;
    while let Some(entry) = log.next() {
        let entry = match entry {
            Ok(entry) => entry,
            Err(broken @ LogError::Broken { .. }) if done > 0 => {
                let words = format!("{:#}", anyhow::Error::new(broken));
                progress.say(format_args!("warning: {words}; what came before is used"));
                partial = Some(words);
                break;
            }
            Err(error) => return Err(error.into()),
        };
        if let Entry::Bad(bad) = &entry {
            if told < MOST_TOLD {
                progress.say(format_args!("warning: {}", located(log.place(), bad)));
            }
            told += 1;
            first_bad.get_or_insert_with(|| located(log.place(), bad));
        }
        done += 1;
        each(entry)?;
        progress.show(done);
        if interrupt.asked() {
            partial = Some(format!("stopped by hand after {done} scans"));
            break;
        }
    }
    progress.finish();
    if told > MOST_TOLD {
        progress.say(format_args!(
            "warning: {}: {} more scans could not be used",
            log.name(),
            told - MOST_TOLD
        ));
    }
    let tally = log.tally();
    if let Some(lost) = &tally.lost {
        progress.say(format_args!("warning: {}: {lost}", log.name()));
    }
    for note in &tally.notes {
        progress.say(format_args!("note: {note}"));
    }
    if let (0, Some(bad)) = (tally.scans, first_bad) {
        bail!(
            "{}: none of its {} scans can be used; the first: {bad}",
            log.name(),
            tally.bad_scans,
        );
    }
    Ok(Reading { tally, partial })
}

fn located(place: &str, bad: &BadScan) -> String {
    format!(
        "{place}, {} {}: {} (scan {} left out)",
        bad.unit, bad.line, bad.fault, bad.index
    )
}

/// Opens a log.
pub fn open(path: &Path, options: log::ReadOptions) -> anyhow::Result<Log> {
    log::open(path, options).context("cannot use the log")
}

/// The last part of the path of a log, for titles and captions.
pub fn short_name(log_name: &str) -> String {
    Path::new(log_name)
        .file_name()
        .map_or_else(|| log_name.to_owned(), |name| name.to_string_lossy().into_owned())
}
