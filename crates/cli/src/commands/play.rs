//! `polymapper play`: a log as a live stream, at the pace at which it was recorded.

use std::io::{self, BufWriter, Write};
use std::net::TcpStream;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use polymapper_io::log::{Entry, LogScan, write_json_line};

use crate::Finish;
use crate::args::PlayArgs;
use crate::scans;
use crate::talk::say;

/// A gap in the stamps that is longer than this is no pause of the scanner but a fault of the log, seconds.
const LONGEST_GAP_S: f64 = 5.0;
/// Taken where the stamps do not tell the time between two scans, seconds.
const USUAL_GAP_S: f64 = 0.1;

/// Runs the command.
pub fn run(args: &PlayArgs) -> anyhow::Result<Finish> {
    let mut pace = Pace::new(args)?;
    let mut log = scans::open(&args.log.choice.log, args.log.read_options())?;
    let mut out = open(&args.output)?;
    for entry in log.by_ref() {
        match entry? {
            Entry::Scan(scan) => {
                pace.wait(&scan);
                write_json_line(&mut out, &scan)?;
                out.flush()?;
            }
            Entry::Bad(bad) => say(format_args!("line {}: {} (left out)", bad.line, bad.fault)),
        }
    }
    Ok(Finish::with_loss(log.tally().bad_scans > 0))
}

fn open(place: &str) -> anyhow::Result<BufWriter<Box<dyn Write>>> {
    let sink: Box<dyn Write> = match place.strip_prefix("tcp:") {
        Some(address) => {
            let stream =
                TcpStream::connect(address).with_context(|| format!("cannot connect to {address}"))?;
            stream.set_nodelay(true)?;
            Box::new(stream)
        }
        None if place == "-" => Box::new(io::stdout()),
        None => bail!("{place} is no place to play to: `-` or tcp:HOST:PORT is expected"),
    };
    Ok(BufWriter::new(sink))
}

/// When the next scan is due.
struct Pace {
    rate: f64,
    fixed_s: Option<f64>,
    last_stamp_s: Option<f64>,
    due: Instant,
}

impl Pace {
    fn new(args: &PlayArgs) -> anyhow::Result<Self> {
        let is_good = |v: f64| v.is_finite() && v >= 0.0;
        if !is_good(args.rate) || !args.hz.is_none_or(|hz| is_good(hz) && hz > 0.0) {
            bail!("--rate and --hz want positive numbers");
        }
        Ok(Self {
            rate: args.rate,
            fixed_s: args.hz.map(|hz| 1.0 / hz),
            last_stamp_s: None,
            due: Instant::now(),
        })
    }

    fn wait(&mut self, scan: &LogScan) {
        let gap_s = self.gap_s(scan.stamp_s);
        self.due += Duration::from_secs_f64(gap_s);
        sleep(self.due.saturating_duration_since(Instant::now()));
    }

    /// Time since the scan before, seconds. Stamps that run backwards or leap tell nothing.
    fn gap_s(&mut self, stamp_s: Option<f64>) -> f64 {
        let before = self.last_stamp_s;
        self.last_stamp_s = stamp_s.or(before);
        if let Some(fixed_s) = self.fixed_s {
            return fixed_s;
        }
        if self.rate == 0.0 {
            return 0.0;
        }
        let gap_s = match (before, stamp_s) {
            (None, _) => 0.0,
            (Some(before), Some(now)) if (0.0..LONGEST_GAP_S).contains(&(now - before)) => now - before,
            _ => USUAL_GAP_S,
        };
        gap_s / self.rate
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gaps(rate: f64, hz: Option<f64>, stamps_s: &[Option<f64>]) -> Vec<f64> {
        let mut pace = Pace {
            rate,
            fixed_s: hz.map(|hz| 1.0 / hz),
            last_stamp_s: None,
            due: Instant::now(),
        };
        stamps_s
            .iter()
            .map(|s| (pace.gap_s(*s) * 1e6).round() / 1e6)
            .collect()
    }

    #[test]
    fn stamps_set_the_pace_where_they_make_sense() {
        let stamps = [Some(10.0), Some(10.2), Some(10.1), Some(90.0), Some(90.05), None];
        assert_eq!(gaps(1.0, None, &stamps), [0.0, 0.2, 0.1, 0.1, 0.05, 0.1]);
        assert_eq!(gaps(2.0, None, &stamps[..2]), [0.0, 0.1]);
        assert_eq!(gaps(0.0, None, &stamps[..2]), [0.0, 0.0]);
        assert_eq!(gaps(1.0, Some(40.0), &stamps[..2]), [0.025, 0.025]);
    }
}
