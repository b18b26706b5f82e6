//! JSON lines: one scan a line, for scripts and drivers.
//!
//! ```json
//! {"ranges_m": [1.23, 1.24, null], "first_bearing_rad": -1.5708, "step_rad": 0.0175, "stamp_s": 12.5}
//! ```
//!
//! In goes a line, out comes a scan. `ranges_m` may hold `null` for no return. `first_bearing_rad` and `step_rad` may be
//! left out: half a turn ahead, evenly spaced. `min_range_m`, `max_range_m`, `stamp_s` and `odometry` (`[x, y, theta]`)
//! may be there. Fields that are not known are passed over; empty lines too.

use std::f64::consts::{FRAC_PI_2, PI};
use std::io::{self, Write};

use polymapper_core::geometry::Pose;
use polymapper_core::scan::{Scan, ScanGeometry};
use serde::{Deserialize, Serialize};

use super::{BadScan, Entry, LineFault, LogError, LogScan, ReadOptions, ScanReader, Tally};
use crate::input::Input;
use crate::lines::{Line, Lines, MAX_LINE_BYTES};

/// More beams than any 2D scanner has a turn.
const MAX_BEAMS: usize = 65_536;

#[derive(Serialize, Deserialize)]
struct ScanLine {
    ranges_m: Vec<Option<f64>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    first_bearing_rad: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    step_rad: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    min_range_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    max_range_m: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    stamp_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    odometry: Option<[f64; 3]>,
}

/// Writes a scan as one line, ranges to 0.1 mm.
///
/// # Errors
/// Those of `out`.
pub fn write_json_line(out: &mut impl Write, scan: &LogScan) -> io::Result<()> {
    let geometry = scan.scan.geometry();
    let range = |r: &f64| r.is_finite().then(|| (r * 1e4).round() / 1e4);
    let line = ScanLine {
        ranges_m: scan.scan.ranges_m().iter().map(range).collect(),
        first_bearing_rad: Some(geometry.bearing_rad(0)),
        step_rad: Some(geometry.step_rad()),
        min_range_m: None,
        max_range_m: None,
        stamp_s: scan.stamp_s,
        odometry: scan.odometry.map(|p| [p.x, p.y, p.theta_rad]),
    };
    serde_json::to_writer(&mut *out, &line)?;
    out.write_all(b"\n")
}

/// Whether the first line that is not empty is an object with ranges.
pub(super) fn recognise(head: &[u8]) -> bool {
    head.split(|&b| b == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty())
        .is_some_and(|line| line.starts_with(b"{") && line.windows(10).any(|w| w == b"\"ranges_m\""))
}

pub(super) fn open(input: Input, options: ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    Ok(Box::new(JsonReader {
        name: input.name.clone(),
        lines: Lines::new(input.into_stream()),
        use_odometry: options.use_odometry,
        ended: false,
        last_stamp_s: None,
        tally: Tally::default(),
    }))
}

struct JsonReader {
    name: String,
    lines: Lines,
    use_odometry: bool,
    ended: bool,
    last_stamp_s: Option<f64>,
    tally: Tally,
}

impl ScanReader for JsonReader {
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>> {
        while !self.ended {
            match self.lines.next_line() {
                Ok(Some(line)) if line.bytes.is_empty() => {}
                Ok(Some(line)) => {
                    let (number, parsed) = (line.number, parse(&line, self.use_odometry));
                    return Some(Ok(self.entry(number, parsed)));
                }
                Ok(None) => self.ended = true,
                Err(source) => {
                    self.ended = true;
                    return Some(Err(LogError::Broken {
                        name: self.name.clone(),
                        line: self.lines.number(),
                        source,
                    }));
                }
            }
        }
        None
    }

    fn tally(&self) -> Tally {
        Tally {
            lines: self.lines.number(),
            bytes: self.lines.read_bytes(),
            ..self.tally.clone()
        }
    }
}

impl JsonReader {
    fn entry(&mut self, line: u64, parsed: Result<Parsed, LineFault>) -> Entry {
        let index = self.tally.scans + self.tally.bad_scans;
        match parsed {
            Ok((scan, stamp_s, odometry)) => {
                self.tally.scans += 1;
                if let (Some(before), Some(now)) = (self.last_stamp_s, stamp_s) {
                    self.tally.stamps_backwards += usize::from(now < before);
                }
                self.last_stamp_s = stamp_s.or(self.last_stamp_s);
                Entry::Scan(LogScan {
                    index,
                    line,
                    stamp_s,
                    scan,
                    odometry,
                })
            }
            Err(fault) => {
                self.tally.bad_scans += 1;
                Entry::Bad(BadScan { index, line, fault })
            }
        }
    }
}

type Parsed = (Scan, Option<f64>, Option<Pose>);

fn parse(line: &Line<'_>, use_odometry: bool) -> Result<Parsed, LineFault> {
    if line.too_long {
        return Err(LineFault::TooLong {
            limit: MAX_LINE_BYTES,
        });
    }
    let found: ScanLine = serde_json::from_slice(line.bytes).map_err(|error| LineFault::Json {
        what: error.to_string(),
    })?;
    let beams = found.ranges_m.len();
    if !(1..=MAX_BEAMS).contains(&beams) {
        return Err(LineFault::Beams {
            header: beams as u64,
            limit: MAX_BEAMS,
        });
    }
    let step_rad = found.step_rad.unwrap_or(PI / (beams.max(2) - 1) as f64);
    let geometry = ScanGeometry::new(found.first_bearing_rad.unwrap_or(-FRAC_PI_2), step_rad, beams)?
        .with_limits(
            found.min_range_m.unwrap_or(0.0),
            found.max_range_m.unwrap_or(f64::INFINITY),
        );
    let ranges_m = found.ranges_m.iter().map(|r| r.unwrap_or(f64::NAN)).collect();
    let odometry = found
        .odometry
        .filter(|o| use_odometry && o.iter().all(|v| v.is_finite()));
    Ok((
        Scan::new(geometry, ranges_m)?,
        found.stamp_s,
        odometry.map(|[x, y, theta_rad]| Pose::new(x, y, theta_rad)),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::open_bytes;

    fn entries(text: &'static str) -> Vec<Entry> {
        let options = ReadOptions {
            use_odometry: true,
            ..ReadOptions::default()
        };
        let log = open_bytes("test", text.as_bytes(), options).unwrap();
        assert_eq!(log.format(), "JSON lines");
        log.map(Result::unwrap).collect()
    }

    #[test]
    fn a_line_with_ranges_alone_looks_half_a_turn_ahead() {
        let all = entries("\n{\"ranges_m\": [1.0, null, 2.5]}\n");
        let [Entry::Scan(scan)] = &all[..] else {
            panic!("{all:?}");
        };
        assert_eq!((scan.index, scan.line, scan.scan.returns()), (0, 2, 2));
        assert!((scan.scan.geometry().bearing_rad(2) - FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn what_is_written_is_read() {
        let all = entries(
            "{\"ranges_m\":[1,2],\"step_rad\":0.5,\"stamp_s\":3.5,\"odometry\":[1,2,0.5],\"new\":1}\n",
        );
        let Entry::Scan(scan) = &all[0] else {
            panic!("{all:?}");
        };
        let mut text = Vec::new();
        write_json_line(&mut text, scan).unwrap();
        let expected = "{\"ranges_m\":[1.0,2.0],\"first_bearing_rad\":-1.5707963267948966,\"step_rad\":0.5,\
             \"stamp_s\":3.5,\"odometry\":[1.0,2.0,0.5]}\n";
        assert_eq!(String::from_utf8(text).unwrap(), expected);
    }

    #[test]
    fn a_bad_line_costs_one_scan_and_says_why() {
        let all = entries(
            "{\"ranges_m\":[1,2]}\n{\"ranges_m\":[1,\n{\"ranges_m\":[]}\n{\"ranges_m\":[1,1,1],\"step_rad\":9}\n{\"ranges_m\":[1]}\n",
        );
        let faults: Vec<String> = all
            .iter()
            .filter_map(|entry| match entry {
                Entry::Bad(bad) => Some(format!("{}: {}", bad.line, bad.fault)),
                Entry::Scan(_) => None,
            })
            .collect();
        assert_eq!((all.len(), faults.len()), (5, 3));
        assert!(faults[0].starts_with("2: no scan in JSON: EOF"), "{}", faults[0]);
        assert!(faults[1].contains("0 ranges"), "{}", faults[1]);
        assert!(faults[2].contains("9 rad"), "{}", faults[2]);
    }
}
