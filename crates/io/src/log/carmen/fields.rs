//! The fields of a line, separated by white space.

use std::str::SplitAsciiWhitespace;

use polymapper_core::geometry::Pose;

use super::MAX_BEAMS;
use crate::log::LineFault;
use crate::log::error::excerpt;

/// Reads field after field; each method says what is missing or wrong.
#[derive(Clone)]
pub(super) struct Fields<'a> {
    rest: SplitAsciiWhitespace<'a>,
    /// Ranges that the header announced, for the messages.
    header: usize,
    /// Numbers read after the header.
    numbers: usize,
    /// Fields that a whole line has after its ranges.
    after: usize,
}

impl<'a> Fields<'a> {
    /// The fields behind the keyword.
    pub fn new(line: &'a str, after: usize) -> Self {
        let mut rest = line.split_ascii_whitespace();
        rest.next();
        Self {
            rest,
            header: 0,
            numbers: 0,
            after,
        }
    }

    pub fn next_field(&mut self) -> Result<&'a str, LineFault> {
        self.rest.next().ok_or(LineFault::Cut {
            found: self.numbers,
            header: self.header,
            after: self.after,
        })
    }

    /// Ranges that the header announced.
    pub fn header(&self) -> usize {
        self.header
    }

    /// The fault of a line that ends too early, with all numbers up to its end or the first field that is none.
    pub fn cut(&self) -> LineFault {
        let more = self.rest.clone().take_while(|f| number(f).is_some()).count();
        LineFault::Cut {
            found: self.numbers + more,
            header: self.header,
            after: self.after,
        }
    }

    /// A number; NaN and infinities are numbers here.
    pub fn number(&mut self, field: &str) -> Result<f64, LineFault> {
        let text = self.next_field()?;
        let value = number(text).ok_or_else(|| not_a_number(field.to_owned(), text))?;
        self.numbers += 1;
        Ok(value)
    }

    /// How many readings follow, kept for the messages.
    pub fn beam_count(&mut self) -> Result<usize, LineFault> {
        let count = self.count("the number of ranges")?;
        self.header = count;
        self.numbers = 0;
        Ok(count)
    }

    pub fn count(&mut self, field: &str) -> Result<usize, LineFault> {
        let text = self.next_field()?;
        let count: u64 = text.parse().map_err(|_| not_a_number(field.to_owned(), text))?;
        match usize::try_from(count) {
            Ok(n) if n <= MAX_BEAMS => Ok(n),
            _ => Err(LineFault::Beams {
                header: count,
                limit: MAX_BEAMS,
            }),
        }
    }

    /// `count` ranges, as they stand.
    pub fn ranges_m(&mut self, count: usize) -> Result<Vec<f64>, LineFault> {
        if count == 0 {
            return Err(LineFault::Beams {
                header: 0,
                limit: MAX_BEAMS,
            });
        }
        let mut ranges_m = Vec::with_capacity(count);
        for k in 0..count {
            let text = self.next_field()?;
            let range = number(text).ok_or_else(|| not_a_number(format!("range {}", k + 1), text))?;
            ranges_m.push(range);
            self.numbers += 1;
        }
        Ok(ranges_m)
    }

    /// Everything that is left.
    pub fn remaining(self) -> SplitAsciiWhitespace<'a> {
        self.rest
    }
}

pub(super) fn not_a_number(field: String, found: &str) -> LineFault {
    LineFault::NotANumber {
        field,
        found: excerpt(found.as_bytes()),
    }
}

/// The number that a field holds. Not-a-number and infinity are read in every spelling that C libraries
/// print (`nan`, `-inf`, `-nan(ind)`, `1.#QNAN`).
pub(super) fn number(text: &str) -> Option<f64> {
    text.parse().ok().or_else(|| {
        let unsigned = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
        (unsigned.starts_with("nan(") || unsigned.starts_with("1.#")).then_some(f64::NAN)
    })
}

/// A stamp that is a usable number.
pub(super) fn stamp_s(text: &str) -> Option<f64> {
    number(text).filter(|s| s.is_finite())
}

/// The pose of three fields; `None` unless all are finite.
pub(super) fn pose(fields: &[&str]) -> Option<Pose> {
    let [x, y, theta] = fields else { return None };
    let (x, y, theta) = (number(x)?, number(y)?, number(theta)?);
    (x.is_finite() && y.is_finite() && theta.is_finite()).then(|| Pose::new(x, y, theta))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_of_no_number_is_read() {
        for text in ["nan", "NaN", "-nan", "-nan(ind)", "1.#QNAN", "-1.#IND"] {
            assert!(number(text).unwrap().is_nan(), "{text}");
        }
        for text in ["inf", "Inf", "-inf", "Infinity"] {
            assert!(number(text).unwrap().is_infinite(), "{text}");
        }
        for text in ["", "1.2.3", "pippo", "0x10", "1,5"] {
            assert_eq!(number(text), None, "{text}");
        }
    }
}
