//! JSON lines: a JSON object a line, with the ranges of a scan as an array; for scripts, drivers and live streams.
//!
//! ```json
//! {"ranges_m": [1.23, 1.24, null], "first_bearing_rad": -1.5708, "step_rad": 0.0175, "stamp_s": 12.5}
//! ```
//!
//! In go lines, out come scans. Known names, the first that is there counts:
//!
//! | what | names |
//! |---|---|
//! | ranges, metres, `null` for no return | `ranges_m`, `ranges`, `radius` |
//! | a bearing for each, radians | `bearings_rad`, `bearings`, `azimuth`, `angles` |
//! | or the first and the step | `first_bearing_rad` or `angle_min`, `step_rad` or `angle_increment` |
//! | stamp, seconds | `stamp_s`, `stamp`, `timestamp`, `time` |
//! | limits, metres | `min_range_m` or `range_min`, `max_range_m` or `range_max`; or `rlim` with both |
//! | pose of odometry, metres and radians | `odometry`, `[x, y, theta]` |
//!
//! `ranges_m` without any bearing looks half a turn ahead, from right to left, evenly spaced; that is noted. Under the
//! other names ranges come from programs that know nothing of this habit, so that they need bearings. Other names are
//! passed over, empty lines too.

use std::f64::consts::{FRAC_PI_2, PI};
use std::io::{self, Write};

use polymapper_core::geometry::Pose;
use polymapper_core::scan::ScanGeometry;
use serde::Serialize;
use serde_json::{Map, Value};

use super::columns::EvenBearings;
use super::keeper::{Keeper, Reading};
use super::text::{TextLines, as_bytes};
use super::{Entry, LineFault, LogError, LogScan, MAX_BEAMS, ReadOptions, ScanReader, Tally, Unit};
use crate::input::Input;

/// The name under which ranges may come without bearings.
const OWN_RANGES: &str = "ranges_m";
const RANGES: &[&str] = &[OWN_RANGES, "ranges", "radius"];
const BEARINGS: &[&str] = &["bearings_rad", "bearings", "azimuth", "angles"];
const FIRST: &[&str] = &["first_bearing_rad", "angle_min"];
const STEP: &[&str] = &["step_rad", "angle_increment"];
const STAMP: &[&str] = &["stamp_s", "stamp", "timestamp", "time"];

#[derive(Serialize)]
struct ScanLine {
    ranges_m: Vec<Option<f64>>,
    first_bearing_rad: f64,
    step_rad: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    stamp_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
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
        first_bearing_rad: geometry.bearing_rad(0),
        step_rad: geometry.step_rad(),
        stamp_s: scan.stamp_s,
        odometry: scan.odometry.map(|p| [p.x, p.y, p.theta_rad]),
    };
    serde_json::to_writer(&mut *out, &line)?;
    out.write_all(b"\n")
}

/// Whether the first line that is not empty is an object with ranges.
pub(super) fn recognise(head: &[u8]) -> bool {
    let line = head
        .split(|&b| b == b'\n')
        .map(<[u8]>::trim_ascii)
        .find(|line| !line.is_empty())
        .unwrap_or_default();
    line.starts_with(b"{")
        && serde_json::from_slice::<Map<String, Value>>(line)
            .is_ok_and(|object| array(&object, RANGES).is_some())
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    Ok(Box::new(JsonLinesReader {
        lines: TextLines::new(input),
        use_odometry: options.use_odometry,
        even: EvenBearings::default(),
        keeper: Keeper::new(Unit::Line, options),
    }))
}

struct JsonLinesReader {
    lines: TextLines,
    use_odometry: bool,
    even: EvenBearings,
    keeper: Keeper,
}

impl ScanReader for JsonLinesReader {
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>> {
        loop {
            let line = match self.lines.next_line()? {
                Ok(line) => line,
                Err(broken) => return Some(Err(broken)),
            };
            if line.bytes.is_empty() {
                continue;
            }
            let number = line.number;
            let object = as_bytes(&line).and_then(parse);
            let reading = object.and_then(|object| self.reading(&object));
            return Some(Ok(self.keeper.entry(number, reading)));
        }
    }

    fn continue_with(&mut self, input: Input) -> Result<(), LogError> {
        self.lines.continue_with(input);
        Ok(())
    }

    fn tally(&self) -> Tally {
        self.lines.tally(&self.keeper)
    }
}

impl JsonLinesReader {
    fn reading(&mut self, object: &Map<String, Value>) -> Result<Reading, LineFault> {
        let ranges_m =
            array(object, RANGES).ok_or_else(|| malformed(format!("none of {RANGES:?} is an array")))?;
        if ranges_m.is_empty() || ranges_m.len() > MAX_BEAMS {
            return Err(LineFault::Beams {
                header: ranges_m.len() as u64,
                limit: MAX_BEAMS,
            });
        }
        let (geometry, ranges_m) = self.with_bearings(object, ranges_m)?;
        let (min_m, max_m) = limits(object);
        Ok(Reading {
            geometry: geometry.with_limits(min_m, max_m),
            ranges_m,
            stamp_s: number(object, STAMP),
            odometry: self.use_odometry.then(|| pose(object)).flatten(),
        })
    }

    /// The ranges in the order of their bearings.
    fn with_bearings(
        &mut self,
        object: &Map<String, Value>,
        ranges_m: Vec<f64>,
    ) -> Result<(ScanGeometry, Vec<f64>), LineFault> {
        let beams = ranges_m.len();
        if let Some(bearings) = array(object, BEARINGS) {
            if bearings.len() != beams || bearings.iter().any(|b| !b.is_finite()) {
                return Err(malformed(format!(
                    "{beams} ranges, but {} bearings that are numbers",
                    bearings.iter().filter(|b| b.is_finite()).count()
                )));
            }
            return self.even.scan(bearings.into_iter().zip(ranges_m).collect());
        }
        let (first_rad, step_rad) = match (number(object, FIRST), number(object, STEP)) {
            (Some(first_rad), Some(step_rad)) => (first_rad, step_rad),
            (None, None) if object.contains_key(OWN_RANGES) => {
                self.keeper
                    .note("ranges without bearings, taken as half a turn ahead".to_owned());
                (-FRAC_PI_2, PI / (beams.max(2) - 1) as f64)
            }
            _ => {
                return Err(malformed(format!(
                    "no bearings: {BEARINGS:?}, or {FIRST:?} and {STEP:?}"
                )));
            }
        };
        Ok((ScanGeometry::new(first_rad, step_rad, beams)?, ranges_m))
    }
}

fn parse(line: &[u8]) -> Result<Map<String, Value>, LineFault> {
    serde_json::from_slice(line).map_err(|error| malformed(format!("no JSON object: {error}")))
}

fn limits(object: &Map<String, Value>) -> (f64, f64) {
    match array(object, &["rlim"]).as_deref() {
        Some(&[min_m, max_m]) => (min_m, max_m),
        _ => (
            number(object, &["min_range_m", "range_min"]).unwrap_or(0.0),
            number(object, &["max_range_m", "range_max"]).unwrap_or(f64::INFINITY),
        ),
    }
}

fn pose(object: &Map<String, Value>) -> Option<Pose> {
    match array(object, &["odometry"])?[..] {
        [x, y, theta_rad] if [x, y, theta_rad].iter().all(|v| v.is_finite()) => {
            Some(Pose::new(x, y, theta_rad))
        }
        _ => None,
    }
}

/// The numbers of the first array that is there; what is none is NaN.
fn array(object: &Map<String, Value>, names: &[&str]) -> Option<Vec<f64>> {
    let values = names.iter().find_map(|name| object.get(*name)?.as_array())?;
    Some(values.iter().map(|v| v.as_f64().unwrap_or(f64::NAN)).collect())
}

fn number(object: &Map<String, Value>, names: &[&str]) -> Option<f64> {
    names.iter().find_map(|name| object.get(*name)?.as_f64())
}

fn malformed(what: String) -> LineFault {
    LineFault::Malformed { what }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Log, open_bytes};

    fn opened(text: &'static str) -> Log {
        let options = ReadOptions {
            use_odometry: true,
            ..ReadOptions::default()
        };
        let log = open_bytes("test", text.as_bytes(), options).unwrap();
        assert_eq!(log.format(), "JSON lines");
        log
    }

    fn entries(text: &'static str) -> Vec<Entry> {
        opened(text).map(Result::unwrap).collect()
    }

    #[test]
    fn a_line_with_ranges_alone_looks_half_a_turn_ahead_and_that_is_noted() {
        let mut log = opened("\n{\"ranges_m\": [1.0, null, 2.5], \"stamp_s\": 12.5}\n");
        let Some(Ok(Entry::Scan(scan))) = log.next() else {
            panic!("no scan");
        };
        assert_eq!((scan.index, scan.line, scan.stamp_s), (0, 2, Some(12.5)));
        assert_eq!(scan.scan.returns(), 2);
        let geometry = scan.scan.geometry();
        assert!((geometry.bearing_rad(0) + FRAC_PI_2).abs() < 1e-12);
        assert!((geometry.bearing_rad(2) - FRAC_PI_2).abs() < 1e-12);
        assert_eq!(
            log.tally().notes,
            ["ranges without bearings, taken as half a turn ahead"]
        );
    }

    #[test]
    fn ranges_of_other_programs_need_their_bearings() {
        for text in [
            "{\"ranges\": [1, 2, 3]}\n",
            "{\"ranges_m\": [1, 2, 3], \"step_rad\": 0.1}\n",
        ] {
            let all = entries(text);
            assert!(
                matches!(&all[..], [Entry::Bad(bad)] if bad.fault.to_string().starts_with("no bearings")),
                "{all:?}"
            );
        }
    }

    #[test]
    fn ranges_beyond_the_limits_are_no_returns() {
        let all = entries("{\"ranges_m\": [0.1, 1, 9], \"min_range_m\": 0.2, \"max_range_m\": 8}\n");
        assert!(
            matches!(&all[..], [Entry::Scan(scan)] if scan.scan.returns() == 1),
            "{all:?}"
        );
    }

    #[test]
    fn what_is_written_is_read() {
        let text = "{\"ranges_m\":[1.0,null,2.0],\"first_bearing_rad\":-0.5,\"step_rad\":0.5,\
            \"stamp_s\":3.5,\"odometry\":[1.0,2.0,0.5]}\n";
        let all = entries(text);
        let [Entry::Scan(scan)] = &all[..] else {
            panic!("{all:?}");
        };
        let mut written = Vec::new();
        write_json_line(&mut written, scan).unwrap();
        assert_eq!(String::from_utf8(written).unwrap(), text);
    }

    #[test]
    fn a_bad_line_costs_one_scan_and_says_why() {
        let all = entries(
            "{\"ranges_m\":[1,2]}\n{\"ranges_m\":[1,\n{\"ranges_m\":[]}\n\
             {\"ranges_m\":[1,1,1],\"first_bearing_rad\":0,\"step_rad\":9}\n{\"ranges_m\":[1]}\n",
        );
        let faults: Vec<String> = all
            .iter()
            .filter_map(|entry| match entry {
                Entry::Bad(bad) => Some(format!("{}: {}", bad.line, bad.fault)),
                Entry::Scan(_) => None,
            })
            .collect();
        assert_eq!((all.len(), faults.len()), (5, 3));
        assert!(faults[0].starts_with("2: no JSON object: EOF"), "{}", faults[0]);
        assert!(faults[1].contains("0 ranges"), "{}", faults[1]);
        assert!(faults[2].contains("9 rad"), "{}", faults[2]);
    }
}
