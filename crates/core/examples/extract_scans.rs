//! CARMEN ROBOTLASER1 lines on standard input → polylines as JSON lines on standard output.
//!
//! `extract_scans [VERTICES]`: at most so many vertices a scan; without it, as fine as the noise supports.

use std::io::{BufRead, Write};
use std::time::{Duration, Instant};

use polymapper_core::extract::{ExtractSettings, extract, extract_with_budget};
use polymapper_core::scan::{Scan, ScanGeometry};

fn main() -> std::io::Result<()> {
    let budget: Option<usize> = std::env::args().nth(1).and_then(|a| a.parse().ok());
    let settings = ExtractSettings::default();
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let (mut spent, mut count, mut unused, mut returns) = (Duration::ZERO, 0_u32, 0, 0);
    for (k, line) in std::io::stdin().lock().lines().enumerate() {
        let Some(scan) = scan(&line?) else { continue };
        let start = Instant::now();
        let extraction = match budget {
            Some(vertices) => extract_with_budget(&scan, vertices, &settings),
            None => extract(&scan, &settings),
        };
        spent += start.elapsed();
        count += 1;
        unused += extraction.returns_unused;
        returns += extraction.returns;
        let polylines: Vec<String> = extraction
            .polylines
            .iter()
            .map(|p| {
                let vertices: Vec<String> = p
                    .polyline
                    .vertices()
                    .iter()
                    .map(|v| format!("[{:.5}, {:.5}]", v.x, v.y))
                    .collect();
                format!("[{}]", vertices.join(", "))
            })
            .collect();
        writeln!(
            out,
            "{{\"scan\": {k}, \"polylines\": [{}]}}",
            polylines.join(", ")
        )?;
    }
    eprintln!(
        "{count} scans, {:.1} µs a scan, {unused} of {returns} returns unused",
        spent.as_secs_f64() * 1e6 / f64::from(count.max(1))
    );
    Ok(())
}

/// Scan of a ROBOTLASER1 line: start angle, field of view, step, longest range, .., beam count, ranges.
fn scan(line: &str) -> Option<Scan> {
    let f: Vec<&str> = line.split_ascii_whitespace().collect();
    let number = |k: usize| f.get(k)?.parse::<f64>().ok();
    let beams: usize = f.get(8)?.parse().ok()?;
    let geometry = ScanGeometry::new(number(2)?, number(4)?, beams).ok()?;
    let geometry = geometry.with_limits(0.0, number(5)? + 0.5);
    let ranges = (9..9 + beams).map(number).collect::<Option<Vec<f64>>>()?;
    Scan::new(geometry, ranges).ok()
}
