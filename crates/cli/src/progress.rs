//! The progress bar: how much of the log is done, how fast, how long yet.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use polymapper_io::log::ReadProgress;

/// A bar on standard error while a log is worked on; nothing where that is no terminal.
///
/// How many scans a log has is not known before its end, so the bar goes by the bytes of the file.
pub struct Progress {
    bar: ProgressBar,
    reading: ReadProgress,
    start: Instant,
}

impl Progress {
    pub fn new(reading: ReadProgress) -> Self {
        let bar = ProgressBar::new(0);
        if let Some(total) = reading.total_bytes() {
            bar.set_length(total);
            if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} % | {msg} | {eta} left") {
                bar.set_style(style);
            }
        } else if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} | {msg}") {
            bar.set_style(style);
        }
        // Redraws while one scan takes long.
        bar.enable_steady_tick(Duration::from_millis(200));
        Self {
            bar,
            reading,
            start: Instant::now(),
        }
    }

    /// Shows that `scans` scans are done.
    pub fn show(&self, scans: usize) {
        if self.bar.is_hidden() {
            return;
        }
        self.bar.set_position(self.reading.read_bytes());
        let rate = scans as f64 / self.start.elapsed().as_secs_f64().max(1e-3);
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
