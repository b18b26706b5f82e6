//! A JSON object a line, with the ranges of a scan as an array.
//!
//! In go lines, out come scans. Known names, the first that is there counts:
//!
//! | what | names |
//! |---|---|
//! | ranges, metres, `null` for no return | `ranges_m`, `ranges`, `radius` |
//! | a bearing for each, radians | `bearings_rad`, `bearings`, `azimuth`, `angles` |
//! | or the first and the step | `first_bearing_rad` or `angle_min`, `step_rad` or `angle_increment` |
//! | stamp, seconds | `stamp_s`, `stamp`, `timestamp`, `time` |
//! | limits, metres | `range_min` and `range_max`, or `rlim` with both |

use polymapper_core::scan::ScanGeometry;
use serde_json::{Map, Value};

use super::columns::EvenBearings;
use super::keeper::{Keeper, Reading};
use super::{Entry, LineFault, LogError, MAX_BEAMS, ReadOptions, ScanReader, Tally, Unit};
use crate::input::Input;
use crate::lines::{Lines, MAX_LINE_BYTES};

const RANGES: &[&str] = &["ranges_m", "ranges", "radius"];
const BEARINGS: &[&str] = &["bearings_rad", "bearings", "azimuth", "angles"];
const FIRST: &[&str] = &["first_bearing_rad", "angle_min"];
const STEP: &[&str] = &["step_rad", "angle_increment"];
const STAMP: &[&str] = &["stamp_s", "stamp", "timestamp", "time"];

/// Whether the first line is an object with ranges.
pub(super) fn recognise(head: &[u8]) -> bool {
    let line = head
        .split(|&b| b == b'\n')
        .next()
        .unwrap_or_default()
        .trim_ascii();
    line.starts_with(b"{")
        && serde_json::from_slice::<Map<String, Value>>(line)
            .is_ok_and(|object| array(&object, RANGES).is_some())
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    Ok(Box::new(JsonLinesReader {
        name: input.name.clone(),
        lines: Lines::new(input.into_stream()),
        even: EvenBearings::default(),
        ended: false,
        keeper: Keeper::new(Unit::Line, options),
        lines_before: 0,
    }))
}

struct JsonLinesReader {
    name: String,
    lines: Lines,
    even: EvenBearings,
    ended: bool,
    keeper: Keeper,
    lines_before: u64,
}

impl ScanReader for JsonLinesReader {
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>> {
        while !self.ended {
            match self.lines.next_line() {
                Ok(None) => return None,
                Ok(Some(line)) if line.bytes.is_empty() => {}
                Ok(Some(line)) if line.too_long => {
                    let fault = LineFault::TooLong {
                        limit: MAX_LINE_BYTES,
                    };
                    return Some(Ok(self.keeper.entry(line.number, Err(fault))));
                }
                Ok(Some(line)) => {
                    let reading = reading(line.bytes, &mut self.even);
                    return Some(Ok(self.keeper.entry(line.number, reading)));
                }
                Err(source) => {
                    self.ended = true;
                    return Some(Err(LogError::Broken {
                        name: self.name.clone(),
                        line: self.lines.number(),
                        unit: Unit::Line,
                        source,
                    }));
                }
            }
        }
        None
    }

    fn continue_with(&mut self, input: Input) -> Result<(), LogError> {
        self.lines_before += self.lines.number();
        input.name.clone_into(&mut self.name);
        self.lines.continue_with(input.into_stream());
        Ok(())
    }

    fn tally(&self) -> Tally {
        Tally {
            lines: self.lines_before + self.lines.number(),
            bytes: self.lines.read_bytes(),
            ..self.keeper.tally.clone()
        }
    }
}

fn reading(line: &[u8], even: &mut EvenBearings) -> Result<Reading, LineFault> {
    let object: Map<String, Value> =
        serde_json::from_slice(line).map_err(|error| malformed(format!("no JSON object: {error}")))?;
    let ranges_m =
        array(&object, RANGES).ok_or_else(|| malformed(format!("none of {RANGES:?} is an array")))?;
    if ranges_m.is_empty() || ranges_m.len() > MAX_BEAMS {
        return Err(LineFault::Beams {
            header: ranges_m.len() as u64,
            limit: MAX_BEAMS,
        });
    }
    let (geometry, ranges_m) = match (
        array(&object, BEARINGS),
        number(&object, FIRST),
        number(&object, STEP),
    ) {
        (Some(bearings), _, _) => {
            if bearings.len() != ranges_m.len() || bearings.iter().any(|b| !b.is_finite()) {
                return Err(malformed(format!(
                    "{} ranges, but {} bearings that are numbers",
                    ranges_m.len(),
                    bearings.iter().filter(|b| b.is_finite()).count()
                )));
            }
            even.scan(bearings.into_iter().zip(ranges_m).collect())?
        }
        (None, Some(first_rad), Some(step_rad)) => {
            (ScanGeometry::new(first_rad, step_rad, ranges_m.len())?, ranges_m)
        }
        _ => {
            return Err(malformed(format!(
                "no bearings: {BEARINGS:?}, or {FIRST:?} and {STEP:?}"
            )));
        }
    };
    let (min_m, max_m) = limits(&object);
    Ok(Reading {
        geometry: geometry.with_limits(min_m, max_m),
        ranges_m,
        stamp_s: number(&object, STAMP),
        odometry: None,
    })
}

fn limits(object: &Map<String, Value>) -> (f64, f64) {
    match array(object, &["rlim"]).as_deref() {
        Some(&[min_m, max_m]) => (min_m, max_m),
        _ => (
            number(object, &["range_min"]).unwrap_or(0.0),
            number(object, &["range_max"]).unwrap_or(f64::INFINITY),
        ),
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
