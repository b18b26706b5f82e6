//! One line by its layout.

use polymapper_core::geometry::Pose;

use super::layout::{Column, Layout};
use crate::log::number::{finite_pose, not_a_number, number};
use crate::log::{LineFault, MAX_BEAMS};

/// What the columns of a line hold.
#[derive(Debug, Default)]
pub(super) struct Parsed {
    pub stamp_s: Option<f64>,
    pub pose: Option<Pose>,
    pub ranges_m: Vec<f64>,
    /// One a range, or none at all.
    pub bearings_rad: Vec<f64>,
}

/// The fields of a line: between commas or semicolons where there are some, else between blanks. An empty field
/// between commas is no number.
pub(super) fn fields(line: &str) -> Box<dyn Iterator<Item = &str> + '_> {
    for separator in [',', ';'] {
        if line.contains(separator) {
            let line = line.trim_end_matches(separator);
            return Box::new(line.split(separator).map(str::trim));
        }
    }
    Box::new(line.split_ascii_whitespace())
}

/// Reads a line; the keyword, if the layout has one, is its first field.
///
/// # Errors
/// Fewer or more columns than the layout has, or a field that is no number.
pub(super) fn parse(line: &str, layout: &Layout) -> Result<Parsed, LineFault> {
    let all: Vec<&str> = fields(line).collect();
    let mut columns = Columns {
        all: &all[usize::from(layout.keyword.is_some()).min(all.len())..],
        at: 0,
    };
    let mut parsed = Parsed::default();
    let mut count = None;
    let mut pose = [None; 3];
    for (k, column) in layout.columns.iter().enumerate() {
        match column {
            Column::Skip(Some(n)) => columns.skip(*n)?,
            Column::Skip(None) => columns.at = columns.all.len(),
            Column::Stamp(scale_s) => {
                let stamp_s = columns.number("the stamp")? * scale_s;
                parsed.stamp_s = Some(parsed.stamp_s.unwrap_or(0.0) + stamp_s);
            }
            Column::Count => count = Some(columns.count()?),
            Column::X => pose[0] = Some(columns.number("x")?),
            Column::Y => pose[1] = Some(columns.number("y")?),
            Column::Theta(scale_rad) => pose[2] = Some(columns.number("theta")? * scale_rad),
            Column::Ranges {
                scale_m,
                bearing_rad,
                readings,
            } => {
                let width = if bearing_rad.is_some() { 2 } else { 1 };
                let behind = layout.columns[k + 1..].iter().map(least).sum::<usize>();
                let up_to_end = || columns.left().saturating_sub(behind) / width;
                let readings = readings.or(count).unwrap_or_else(up_to_end);
                columns.readings(readings, *scale_m, *bearing_rad, &mut parsed)?;
            }
        }
    }
    if columns.left() > 0 {
        return Err(LineFault::Malformed {
            what: format!("{} fields, but the layout has {}", columns.all.len(), columns.at),
        });
    }
    if let [Some(x_m), Some(y_m), Some(theta_rad)] = pose {
        parsed.pose = finite_pose(x_m, y_m, theta_rad);
    }
    Ok(parsed)
}

/// Fields that a column has at least.
fn least(column: &Column) -> usize {
    match column {
        Column::Skip(n) => n.unwrap_or(0),
        Column::Ranges { .. } => 0,
        _ => 1,
    }
}

struct Columns<'a> {
    all: &'a [&'a str],
    at: usize,
}

impl<'a> Columns<'a> {
    fn left(&self) -> usize {
        self.all.len() - self.at
    }

    fn take(&mut self, count: usize) -> Result<&'a [&'a str], LineFault> {
        if count > self.left() {
            return Err(LineFault::Malformed {
                what: format!(
                    "the line is cut: {} fields, at least {} are expected",
                    self.all.len(),
                    self.at.saturating_add(count)
                ),
            });
        }
        let taken = &self.all[self.at..self.at + count];
        self.at += count;
        Ok(taken)
    }

    fn skip(&mut self, count: usize) -> Result<(), LineFault> {
        self.take(count).map(|_| ())
    }

    fn number(&mut self, field: &str) -> Result<f64, LineFault> {
        let text = self.take(1)?[0];
        number(text).ok_or_else(|| not_a_number(field.to_owned(), text))
    }

    fn count(&mut self) -> Result<usize, LineFault> {
        let text = self.take(1)?[0];
        let what = || not_a_number("the number of ranges".to_owned(), text);
        let count: u64 = text.parse().map_err(|_| what())?;
        usize::try_from(count)
            .ok()
            .filter(|&n| n <= MAX_BEAMS)
            .ok_or(LineFault::Beams {
                header: count,
                limit: MAX_BEAMS,
            })
    }

    fn readings(
        &mut self,
        readings: usize,
        scale_m: f64,
        bearing_rad: Option<f64>,
        parsed: &mut Parsed,
    ) -> Result<(), LineFault> {
        if readings == 0 || readings > MAX_BEAMS {
            return Err(LineFault::Beams {
                header: readings as u64,
                limit: MAX_BEAMS,
            });
        }
        let width = if bearing_rad.is_some() { 2 } else { 1 };
        for (k, fields) in self.take(readings * width)?.chunks_exact(width).enumerate() {
            if let (Some(scale_rad), [text, _]) = (bearing_rad, fields) {
                let bearing = number(text).filter(|b| b.is_finite());
                let bearing = bearing.ok_or_else(|| not_a_number(format!("bearing {}", k + 1), text))?;
                parsed.bearings_rad.push(bearing * scale_rad);
            }
            let text = fields[width - 1];
            let range = if text.is_empty() {
                f64::NAN
            } else {
                number(text).ok_or_else(|| not_a_number(format!("range {}", k + 1), text))?
            };
            parsed.ranges_m.push(range * scale_m);
        }
        Ok(())
    }
}
