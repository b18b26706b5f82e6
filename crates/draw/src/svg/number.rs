//! Numbers and paths, with as few characters as SVG allows.

use std::fmt::Write as _;

use crate::plate::Px;

/// A line as moves in hundredths of a pixel.
pub(super) fn path(points: &[Px], closed: bool) -> String {
    let mut text = String::new();
    let mut at = (0, 0);
    for (k, p) in points.iter().enumerate() {
        let next = (grains(p.x, 100.0), grains(p.y, 100.0));
        match k {
            0 => text.push('M'),
            1 => text.push('l'),
            _ => {}
        }
        pair(&mut text, next.0 - at.0, next.1 - at.1, 100, k > 1);
        at = next;
    }
    if closed {
        text.push('z');
    }
    text
}

/// Dots as lines of no length with round ends, in tenths of a pixel.
pub(super) fn dots(centres: &[Px]) -> String {
    let mut text = String::new();
    let mut at = (0, 0);
    for (k, p) in centres.iter().enumerate() {
        let next = (grains(p.x, 10.0), grains(p.y, 10.0));
        text.push(if k == 0 { 'M' } else { 'm' });
        pair(&mut text, next.0 - at.0, next.1 - at.1, 10, false);
        text.push_str("h0");
        at = next;
    }
    text
}

fn grains(value: f64, a_px: f64) -> i64 {
    (value * a_px).round() as i64
}

/// Writes two numbers with as few characters as SVG allows: a minus sign separates as well as a space does.
fn pair(text: &mut String, x: i64, y: i64, a_px: i64, after_number: bool) {
    if after_number && x >= 0 {
        text.push(' ');
    }
    grained(text, x, a_px);
    if y >= 0 {
        text.push(' ');
    }
    grained(text, y, a_px);
}

fn grained(text: &mut String, value: i64, a_px: i64) {
    let digits = if a_px == 100 { 2 } else { 1 };
    if value < 0 {
        text.push('-');
    }
    let (whole, rest) = (
        value.unsigned_abs() / a_px.unsigned_abs(),
        value.unsigned_abs() % a_px.unsigned_abs(),
    );
    if whole > 0 || rest == 0 {
        let _ = write!(text, "{whole}");
    }
    if rest > 0 {
        let fraction = format!("{rest:0digits$}");
        let _ = write!(text, ".{}", fraction.trim_end_matches('0'));
    }
}

/// A number with at most two decimals.
pub(super) fn number(value: f64) -> String {
    let mut text = String::new();
    grained(&mut text, grains(value, 100.0), 100);
    text
}

/// A number with seven significant digits.
pub(super) fn significant(value: f64) -> String {
    if !value.is_normal() {
        return "0".to_owned();
    }
    let decimals = (6.0 - value.abs().log10().floor()).clamp(0.0, 17.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_short_and_do_not_drift() {
        let points: Vec<Px> = (0..1000).map(|k| Px::new(f64::from(k) / 3.0, 0.005)).collect();
        let text = path(&points, false);
        let moves: Vec<&str> = text.trim_start_matches('M').split(['l', ' ']).collect();
        let end: f64 = moves.iter().step_by(2).map(|x| x.parse::<f64>().unwrap()).sum();
        assert!((end - 333.0).abs() < 1e-6, "{end}");
        assert_eq!(
            path(&[Px::new(1.0, 2.5), Px::new(0.5, 2.0), Px::new(3.0, 4.0)], true),
            "M1 2.5l-.5-.5 2.5 2z"
        );
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [0.0, 0.5, -0.004, -0.25, 12.0, 3.456].map(number),
            ["0", ".5", "0", "-.25", "12", "3.46"]
        );
        assert_eq!(
            [0.012_345_678_9, -1_234.5, 0.0].map(significant),
            ["0.01234568", "-1234.5", "0"]
        );
    }
}
