//! The `d` of an SVG path (SVG 1.1, section 8.3) → polylines.
//!
//! Lines, horizontals, verticals, closed pieces and Bézier curves; curves become lines that keep within the
//! tolerance. Elliptic arcs are refused.

use polymapper_core::geometry::Point;

/// The most sides of one curve.
const MOST_SIDES: f64 = 256.0;

/// The pieces of a path. A closed piece ends with its first point.
///
/// # Errors
/// A command that is not known, numbers that are none or too few, more than `left` points; those that came are
/// taken off it.
pub(super) fn pieces(data: &str, tolerance: f64, left: &mut usize) -> Result<Vec<Vec<Point>>, String> {
    let mut path = Path {
        tokens: Tokens(data.trim_start()),
        pieces: Vec::new(),
        start: Point::new(0.0, 0.0),
        at: Point::new(0.0, 0.0),
        control: None,
        tolerance,
        left,
    };
    let mut command = None;
    while !path.tokens.is_empty() {
        if let Some(letter) = path.tokens.letter() {
            path.run(letter)?;
            // Numbers that follow a move are lines.
            command = match letter {
                'M' => Some('L'),
                'm' => Some('l'),
                'Z' | 'z' => None,
                other => Some(other),
            };
        } else {
            let again = command.ok_or_else(|| path.tokens.fault("a command"))?;
            path.run(again)?;
        }
    }
    path.pieces.retain(|piece| piece.len() > 1);
    Ok(path.pieces)
}

struct Path<'a> {
    tokens: Tokens<'a>,
    pieces: Vec<Vec<Point>>,
    /// Where the piece began.
    start: Point,
    at: Point,
    /// The last control point and whether it was that of a cubic curve, for `S` and `T`.
    control: Option<(Point, bool)>,
    tolerance: f64,
    /// Points that may still come, of this path and all others of the drawing.
    left: &'a mut usize,
}

impl Path<'_> {
    fn run(&mut self, command: char) -> Result<(), String> {
        let relative = command.is_ascii_lowercase();
        let base = if relative { self.at } else { Point::new(0.0, 0.0) };
        let before = self.control.take();
        match command.to_ascii_uppercase() {
            'M' => {
                self.at = base + self.tokens.point()?;
                self.start = self.at;
                self.pieces.push(Vec::new());
                self.go(self.at)
            }
            'L' => {
                let to = base + self.tokens.point()?;
                self.go(to)
            }
            'H' => {
                let x = base.x + self.tokens.number()?;
                self.go(Point::new(x, self.at.y))
            }
            'V' => {
                let y = base.y + self.tokens.number()?;
                self.go(Point::new(self.at.x, y))
            }
            'Z' => {
                self.go(self.start)?;
                self.pieces.push(vec![self.start]);
                Ok(())
            }
            'C' | 'S' => {
                let first = if command.eq_ignore_ascii_case(&'S') {
                    self.mirrored(before, true)
                } else {
                    base + self.tokens.point()?
                };
                let second = base + self.tokens.point()?;
                let to = base + self.tokens.point()?;
                self.control = Some((second, true));
                self.curve(first, second, to)
            }
            'Q' | 'T' => {
                let middle = if command.eq_ignore_ascii_case(&'T') {
                    self.mirrored(before, false)
                } else {
                    base + self.tokens.point()?
                };
                let to = base + self.tokens.point()?;
                self.control = Some((middle, false));
                let third = 2.0 / 3.0;
                self.curve(
                    self.at + (middle - self.at) * third,
                    to + (middle - to) * third,
                    to,
                )
            }
            'A' => Err("an elliptic arc; only lines and Bézier curves are read".to_owned()),
            _ => Err(format!("path command {command:?} is not known")),
        }
    }

    fn mirrored(&self, before: Option<(Point, bool)>, cubic: bool) -> Point {
        match before {
            Some((control, was_cubic)) if was_cubic == cubic => self.at + (self.at - control),
            _ => self.at,
        }
    }

    fn go(&mut self, to: Point) -> Result<(), String> {
        *self.left = self.left.checked_sub(1).ok_or("a path of too many points")?;
        self.at = to;
        match self.pieces.last_mut() {
            Some(piece) => piece.push(to),
            None => return Err("a path that does not begin with a move".to_owned()),
        }
        Ok(())
    }

    /// A cubic curve as lines: with n sides it is off by at most ¾ · (largest second difference) / n², halved
    /// again here by taking the ceiling.
    fn curve(&mut self, first: Point, second: Point, to: Point) -> Result<(), String> {
        let from = self.at;
        let bend = |a: Point, b: Point, c: Point| (a - b + (c - b)).norm();
        let most = bend(from, first, second).max(bend(first, second, to));
        let sides = (0.75 * most / self.tolerance)
            .sqrt()
            .ceil()
            .clamp(1.0, MOST_SIDES) as u32;
        for k in 1..=sides {
            let t = f64::from(k) / f64::from(sides);
            let s = 1.0 - t;
            let p = from * (s * s * s)
                + first * (3.0 * s * s * t)
                + second * (3.0 * s * t * t)
                + to * (t * t * t);
            self.go(if k == sides { to } else { p })?;
        }
        Ok(())
    }
}

/// Letters and numbers; commas and white space between them mean nothing.
struct Tokens<'a>(&'a str);

impl Tokens<'_> {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn letter(&mut self) -> Option<char> {
        let letter = self.0.chars().next().filter(char::is_ascii_alphabetic)?;
        self.skip(1);
        Some(letter)
    }

    fn point(&mut self) -> Result<Point, String> {
        Ok(Point::new(self.number()?, self.number()?))
    }

    /// `-.5e3`, ended by whatever cannot go on: `1.5.5` and `1-2` are two numbers.
    fn number(&mut self) -> Result<f64, String> {
        let bytes = self.0.as_bytes();
        let digits = |mut k: usize| {
            while bytes.get(k).is_some_and(u8::is_ascii_digit) {
                k += 1;
            }
            k
        };
        let sign = |k: usize| k + usize::from(matches!(bytes.get(k), Some(b'+' | b'-')));
        let mut end = digits(sign(0));
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) && digits(sign(end + 1)) > sign(end + 1) {
            end = digits(sign(end + 1));
        }
        let number = self.0.get(..end).and_then(|text| text.parse().ok());
        let number = number.ok_or_else(|| self.fault("a number"))?;
        self.skip(end);
        Ok(number)
    }

    fn skip(&mut self, bytes: usize) {
        let separator = |c: char| c == ',' || c.is_ascii_whitespace();
        self.0 = self.0.get(bytes..).unwrap_or("").trim_start_matches(separator);
    }

    fn fault(&self, expected: &str) -> String {
        let found: String = self.0.chars().take(12).collect();
        format!("path data has {found:?} where {expected} is expected")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(data: &str) -> Vec<Vec<(f64, f64)>> {
        let pieces = pieces(data, 0.01, &mut 10_000).unwrap();
        pieces
            .iter()
            .map(|p| p.iter().map(|p| (p.x, p.y)).collect())
            .collect()
    }

    #[test]
    fn lines_absolute_relative_and_run_together() {
        let expected = vec![vec![(1.0, 2.0), (4.0, 2.0), (4.0, 6.0)]];
        for data in [
            "M1,2 L4,2 L4,6",
            "m1 2 3 0 0 4",
            "M1 2H4V6",
            "M1 2h3v4",
            "M1,2 4,2 4,6",
            "M1 2l3-0 0+4",
        ] {
            assert_eq!(read(data), expected, "{data}");
        }
        assert_eq!(read("M.5.5-1e0.25"), [vec![(0.5, 0.5), (-1.0, 0.25)]]);
    }

    #[test]
    fn a_closed_piece_ends_where_it_began_and_another_may_follow() {
        let square = vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0)];
        assert_eq!(read("M0 0H1V1z"), std::slice::from_ref(&square));
        assert_eq!(read("M0 0H1V1Z m5 0 h1"), [square, vec![(5.0, 0.0), (6.0, 0.0)]]);
    }

    #[test]
    fn curves_keep_within_the_tolerance() {
        // A quarter of a circle of radius 10, to 0.03 as a Bézier curve.
        let arc = &read("M10 0C10 5.5228 5.5228 10 0 10")[0];
        assert!(arc.len() > 10 && arc.len() < 60, "{}", arc.len());
        for pair in arc.windows(2) {
            let middle = ((pair[0].0 + pair[1].0) / 2.0, (pair[0].1 + pair[1].1) / 2.0);
            assert!((middle.0.hypot(middle.1) - 10.0).abs() < 0.03 + 0.01);
        }
        assert_eq!(arc.last(), Some(&(0.0, 10.0)));
    }

    #[test]
    fn what_is_no_path_is_told() {
        let fault = |data| pieces(data, 1.0, &mut 100).unwrap_err();
        assert!(fault("M1 2 L3").contains("a number is expected"));
        assert!(fault("L1 2").contains("does not begin with a move"));
        assert!(fault("M0 0 A1 1 0 0 0 2 2").contains("elliptic arc"));
        assert!(fault("M0 0 ☃").contains("a number is expected"));
        assert!(fault("3 4").contains("a command is expected"));
        assert!(fault(&"M0 0".repeat(101)).contains("too many points"));
    }
}
