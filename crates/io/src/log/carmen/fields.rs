//! The fields of a line, separated by white space.

use std::str::SplitAsciiWhitespace;

use super::MAX_BEAMS;
use crate::log::LineFault;
use crate::log::number::{not_a_number, number};

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
