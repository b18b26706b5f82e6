//! Numbers for text files: rounded, so that files stay small and the same on every machine.

/// `value` rounded to 3 decimals.
pub(super) fn rounded_3(value: f64) -> f64 {
    rounded(value, 1e3)
}

/// `value` rounded to 4 decimals (0.1 mm); printed with the fewest digits that give the same number.
pub(super) fn rounded_4(value: f64) -> f64 {
    rounded(value, 1e4)
}

/// `value` rounded to 5 decimals.
pub(super) fn rounded_5(value: f64) -> f64 {
    rounded(value, 1e5)
}

/// `value` rounded to 6 decimals.
pub(super) fn rounded_6(value: f64) -> f64 {
    rounded(value, 1e6)
}

fn rounded(value: f64, scale: f64) -> f64 {
    // Adding 0 turns −0 into 0.
    (value * scale).round() / scale + 0.0
}
