//! Numbers in text, as the C programs that write logs print them.

use polymapper_core::geometry::Pose;

use super::LineFault;
use super::error::excerpt;

/// The number that a field holds. Not-a-number and infinity are read in every spelling that C libraries
/// print (`nan`, `-inf`, `-nan(ind)`, `1.#QNAN`).
pub(super) fn number(text: &str) -> Option<f64> {
    short_decimal(text.as_bytes()).or_else(|| long_number(text))
}

fn long_number(text: &str) -> Option<f64> {
    text.parse().ok().or_else(|| {
        let unsigned = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
        (unsigned.starts_with("nan(") || unsigned.starts_with("1.#")).then_some(f64::NAN)
    })
}

/// The value of `123.45`: at most 15 digits, no sign, no exponent. Digits and power of ten are exact in `f64`, so that
/// their quotient is the nearest number, as `parse` gives it (Clinger 1990), three times as fast.
fn short_decimal(text: &[u8]) -> Option<f64> {
    const POWERS: [f64; 16] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
    ];
    if text.len() > POWERS.len() {
        return None;
    }
    let (mut digits, mut value) = (0, 0_u64);
    let mut decimals = None;
    for &byte in text {
        match byte {
            b'0'..=b'9' => {
                value = value * 10 + u64::from(byte - b'0');
                digits += 1;
                decimals = decimals.map(|d| d + 1);
            }
            b'.' if decimals.is_none() => decimals = Some(0_usize),
            _ => return None,
        }
    }
    if digits == 0 || digits >= POWERS.len() {
        return None;
    }
    Some(value as f64 / POWERS[decimals.unwrap_or(0)])
}

/// The fault of a field that holds no number.
pub(super) fn not_a_number(field: String, found: &str) -> LineFault {
    LineFault::NotANumber {
        field,
        found: excerpt(found.as_bytes()),
    }
}

/// A stamp that is a usable number.
pub(super) fn stamp_s(text: &str) -> Option<f64> {
    number(text).filter(|s| s.is_finite())
}

/// The pose of three fields; `None` unless all are finite.
pub(super) fn pose(fields: &[&str]) -> Option<Pose> {
    let [x, y, theta] = fields else { return None };
    finite_pose(number(x)?, number(y)?, number(theta)?)
}

/// The pose of three numbers; `None` unless all are finite.
pub(super) fn finite_pose(x_m: f64, y_m: f64, theta_rad: f64) -> Option<Pose> {
    (x_m.is_finite() && y_m.is_finite() && theta_rad.is_finite()).then(|| Pose::new(x_m, y_m, theta_rad))
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
        for text in ["", ".", "1.2.3", "pippo", "0x10", "1,5"] {
            assert_eq!(number(text), None, "{text}");
        }
    }

    #[test]
    fn the_fast_way_gives_the_same_bits() {
        let mut state = 1_u64;
        for _ in 0..100_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let (whole, decimals) = ((state >> 40) % 100_000, (state >> 20) as usize % 8);
            let value = (whole * 7919) as f64 / 10_f64.powi(decimals as i32 + 2);
            let text = format!("{value:.decimals$}");
            let parsed: f64 = text.parse().unwrap();
            assert_eq!(number(&text).unwrap().to_bits(), parsed.to_bits(), "{text}");
        }
        assert_eq!(number("81.").map(f64::to_bits), Some(81_f64.to_bits()));
        assert_eq!(number(".5").map(f64::to_bits), Some(0.5_f64.to_bits()));
    }
}
