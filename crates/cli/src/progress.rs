//! The progress bar: how much of the log is done, how fast, how long yet.

use std::cell::Cell;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use polymapper_io::log::ReadProgress;

/// Time between two changes of the bar; more often nobody can read it.
const REFRESH: Duration = Duration::from_millis(100);

/// A bar on standard error while a log is worked on; nothing where that is no terminal.
///
/// How many scans a log has is not known before its end, so the bar goes by the bytes of the file.
pub struct Progress {
    bar: ProgressBar,
    reading: ReadProgress,
    start: Instant,
    shown: Cell<Duration>,
}

impl Progress {
    pub fn new(reading: ReadProgress) -> Self {
        let (template, bar) = match reading.total_bytes() {
            Some(total) => (
                "{bar:30} {percent:>3} % | {msg} | {eta} left",
                ProgressBar::new(total),
            ),
            None => ("{spinner} {elapsed} | {msg}", ProgressBar::no_length()),
        };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        // Redraws while one scan takes long.
        bar.enable_steady_tick(2 * REFRESH);
        Self {
            bar,
            reading,
            start: Instant::now(),
            shown: Cell::default(),
        }
    }

    /// Shows that `scans` scans are done.
    pub fn show(&self, scans: usize) {
        let elapsed = self.start.elapsed();
        if self.bar.is_hidden() || elapsed < self.shown.get() + REFRESH {
            return;
        }
        self.shown.set(elapsed);
        self.bar.set_position(self.reading.read_bytes());
        let rate = scans as f64 / elapsed.as_secs_f64();
        self.bar.set_message(format!("{scans} scans, {rate:.0}/s"));
    }

    /// Says something above the bar.
    pub fn say(&self, words: std::fmt::Arguments<'_>) {
        self.bar.suspend(|| crate::talk::say(words));
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
