//! A declared layout: what the columns of a line are.
//!
//! In goes a text of words, out comes a layout; `--layout`, a `# layout:` comment in the file and the table of known
//! files all use it:
//!
//! | word | what stands there |
//! |---|---|
//! | `=WORD` | the line begins with this word; other lines hold no scan |
//! | `skip`, `skip*3`, `skip*` | one column, three, all that are left: not used |
//! | `stamp_s`, `stamp_ms`, `stamp_us`, `stamp_ns` | a time; several add up |
//! | `count` | how many readings follow |
//! | `x_m`, `y_m`, `theta_rad`, `theta_deg` | a pose of odometry |
//! | `range_m*682`, `range_mm*`, `range_cm*` | readings; without a number as many as `count` says, or up to the end |
//! | `bearing_deg+range_m*` | readings with a bearing before each (`bearing_rad` too, `_mm`, `_cm`) |
//! | `first_deg=-90`, `step_deg=0.5`, `width_deg=180` | bearing of the first reading, angle from reading to reading (negative: clockwise), or from the first to the last |
//! | `max_m=10` | ranges from here on are no returns |
//! | `pose=WORD` | lines with this word hold `x_m y_m theta_rad` of the scan behind them |

use std::str::FromStr;

use polymapper_core::scan::{ScanError, ScanGeometry};

use crate::log::MAX_BEAMS;
use crate::log::number::number;

/// What the columns of a line are.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    pub(super) keyword: Option<String>,
    pub(super) pose_keyword: Option<String>,
    pub(super) columns: Vec<Column>,
    pub(super) bearings: Bearings,
    pub(super) max_m: Option<f64>,
}

/// One column, or many of a kind.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Column {
    /// Not used; `None`: all that are left.
    Skip(Option<usize>),
    /// Seconds to a unit.
    Stamp(f64),
    Count,
    X,
    Y,
    /// Radians to a unit.
    Theta(f64),
    /// Readings.
    Ranges {
        /// Metres to a unit.
        scale_m: f64,
        /// Radians to a unit of the bearing before each, if there is one.
        bearing_rad: Option<f64>,
        /// `None`: as many as `count` says, or up to the end.
        readings: Option<usize>,
    },
}

/// Where readings without their own bearing look.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bearings {
    pub first_rad: Option<f64>,
    /// Negative for a scanner that turns clockwise.
    pub step_rad: Option<f64>,
    pub width_rad: Option<f64>,
}

impl Bearings {
    pub fn are_known(&self) -> bool {
        self.first_rad.is_some() && (self.step_rad.is_some() || self.width_rad.is_some())
    }

    /// The geometry of `beams` readings, and whether they must be turned round for it.
    pub fn geometry(&self, beams: usize) -> Result<(ScanGeometry, bool), ScanError> {
        let gaps = beams.saturating_sub(1).max(1) as f64;
        let first_rad = self.first_rad.unwrap_or(f64::NAN);
        let step_rad = match (self.step_rad, self.width_rad) {
            (Some(step_rad), _) => step_rad,
            (None, Some(width_rad)) => width_rad / gaps,
            (None, None) => f64::NAN,
        };
        if step_rad < 0.0 {
            let last_rad = first_rad + step_rad * beams.saturating_sub(1) as f64;
            return Ok((ScanGeometry::new(last_rad, -step_rad, beams)?, true));
        }
        Ok((ScanGeometry::new(first_rad, step_rad, beams)?, false))
    }
}

/// Why a layout makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayoutError {
    /// A word that is none of the known ones.
    #[error(
        "`{0}` is no word of a layout; those are =WORD, skip, stamp_s, count, x_m, y_m, theta_rad, range_m*N, bearing_deg+range_m*, first_deg=, step_deg=, width_deg=, max_m=, pose=WORD"
    )]
    UnknownWord(String),
    /// A number that is none or out of bounds.
    #[error("`{0}`: a finite number is expected, and at most {MAX_BEAMS} readings")]
    BadNumber(String),
    /// No ranges, or more than one group of them.
    #[error("a layout needs one `range_..` word, {0} are there")]
    Ranges(usize),
}

impl FromStr for Layout {
    type Err = LayoutError;

    fn from_str(text: &str) -> Result<Self, LayoutError> {
        let mut layout = Self {
            keyword: None,
            pose_keyword: None,
            columns: Vec::new(),
            bearings: Bearings::default(),
            max_m: None,
        };
        for word in text.split_ascii_whitespace() {
            layout.take(word)?;
        }
        let is_ranges = |c: &&Column| matches!(c, Column::Ranges { .. });
        match layout.columns.iter().filter(is_ranges).count() {
            1 => Ok(layout),
            n => Err(LayoutError::Ranges(n)),
        }
    }
}

impl Layout {
    fn take(&mut self, word: &str) -> Result<(), LayoutError> {
        if let Some(keyword) = word.strip_prefix('=') {
            self.keyword = Some(keyword.to_owned());
            return Ok(());
        }
        if let Some((name, value)) = word.split_once('=') {
            return self.set(name, value, word);
        }
        self.columns.push(column(word)?);
        Ok(())
    }

    fn set(&mut self, name: &str, value: &str, word: &str) -> Result<(), LayoutError> {
        if name == "pose" {
            self.pose_keyword = Some(value.to_owned());
            return Ok(());
        }
        let number = number(value)
            .filter(|n| n.is_finite())
            .ok_or_else(|| LayoutError::BadNumber(word.to_owned()))?;
        match name {
            "first_deg" => self.bearings.first_rad = Some(number.to_radians()),
            "step_deg" => self.bearings.step_rad = Some(number.to_radians()),
            "width_deg" => self.bearings.width_rad = Some(number.to_radians()),
            "max_m" => self.max_m = Some(number),
            _ => return Err(LayoutError::UnknownWord(word.to_owned())),
        }
        Ok(())
    }

    /// Whether every reading brings its own bearing.
    pub(super) fn has_bearings(&self) -> bool {
        let has = |c: &Column| {
            matches!(
                c,
                Column::Ranges {
                    bearing_rad: Some(_),
                    ..
                }
            )
        };
        self.columns.iter().any(has)
    }
}

fn column(word: &str) -> Result<Column, LayoutError> {
    let unknown = || LayoutError::UnknownWord(word.to_owned());
    let (name, times) = match word.split_once('*') {
        Some((name, "")) => (name, Some(None)),
        Some((name, times)) => {
            let count = times.parse().ok().filter(|&n: &usize| n > 0 && n <= MAX_BEAMS);
            let count = count.ok_or_else(|| LayoutError::BadNumber(word.to_owned()))?;
            (name, Some(Some(count)))
        }
        None => (word, None),
    };
    let column = match (name, times) {
        ("skip", None) => Column::Skip(Some(1)),
        ("skip", Some(count)) => Column::Skip(count),
        ("stamp_s", None) => Column::Stamp(1.0),
        ("stamp_ms", None) => Column::Stamp(1e-3),
        ("stamp_us", None) => Column::Stamp(1e-6),
        ("stamp_ns", None) => Column::Stamp(1e-9),
        ("count", None) => Column::Count,
        ("x_m", None) => Column::X,
        ("y_m", None) => Column::Y,
        ("theta_rad", None) => Column::Theta(1.0),
        ("theta_deg", None) => Column::Theta(1_f64.to_radians()),
        (_, Some(readings)) => {
            let (bearing_rad, range) = match name.split_once('+') {
                Some(("bearing_deg", range)) => (Some(1_f64.to_radians()), range),
                Some(("bearing_rad", range)) => (Some(1.0), range),
                Some(_) => return Err(unknown()),
                None => (None, name),
            };
            let scale_m = range_unit(range).ok_or_else(unknown)?;
            Column::Ranges {
                scale_m,
                bearing_rad,
                readings,
            }
        }
        _ => return Err(unknown()),
    };
    Ok(column)
}

fn range_unit(name: &str) -> Option<f64> {
    match name {
        "range_m" => Some(1.0),
        "range_cm" => Some(1e-2),
        "range_mm" => Some(1e-3),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_are_read() {
        let layout: Layout = "=LASER stamp_s stamp_ns skip*2 count range_mm* first_deg=90 step_deg=-0.5"
            .parse()
            .unwrap();
        assert_eq!(layout.keyword.as_deref(), Some("LASER"));
        assert_eq!(layout.columns.len(), 5);
        let (geometry, turned) = layout.bearings.geometry(181).unwrap();
        assert!(turned && (geometry.bearing_rad(0)).abs() < 1e-9);
    }

    #[test]
    fn what_makes_no_sense_is_named() {
        let error = |text: &str| text.parse::<Layout>().unwrap_err().to_string();
        assert!(error("range_m*9999999").contains("at most 65536"));
        assert!(error("ranges*5").starts_with("`ranges*5` is no word"));
        assert!(error("stamp_s").contains("0 are there"));
        assert!(error("range_m* first_deg=nan").contains("a finite number"));
    }
}
