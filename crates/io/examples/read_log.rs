//! Reads a log to its end and prints what was in it and how fast it went.

use std::path::Path;
use std::time::Instant;

use polymapper_io::log::{self, Entry, ReadOptions};

fn main() -> Result<(), log::LogError> {
    for name in std::env::args().skip(1) {
        let start = Instant::now();
        let mut log = log::open(Path::new(&name), ReadOptions::default())?;
        let (mut beams, mut returns) = (0, 0);
        for entry in &mut log {
            match entry? {
                Entry::Scan(s) => {
                    beams += s.scan.geometry().beams();
                    returns += s.scan.returns();
                }
                Entry::Bad(bad) => println!("{}, line {}: {}", log_name(&name), bad.line, bad.fault),
            }
        }
        let tally = log.tally();
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "{}: {} scans, {} bad, {beams} beams, {returns} returns, {} lines, {:.1} MB/s of text, {tally:?}",
            log_name(&name),
            tally.scans,
            tally.bad_scans,
            tally.lines,
            tally.bytes as f64 / 1e6 / seconds
        );
    }
    Ok(())
}

fn log_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}
