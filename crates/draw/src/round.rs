//! Round lengths for scale bars and grids.

/// The largest of …, 0.1, 0.2, 0.5, 1, 2, 5, … that is not above `limit_m`; 1 when `limit_m` is no positive number.
pub(crate) fn at_most_m(limit_m: f64) -> f64 {
    if limit_m <= 0.0 || !limit_m.is_finite() {
        return 1.0;
    }
    let decade = 10f64.powf(limit_m.log10().floor());
    [5.0, 2.0]
        .into_iter()
        .map(|f| f * decade)
        .find(|step| *step <= limit_m * (1.0 + 1e-9))
        .unwrap_or(decade)
}

/// The smallest round length that is not below `limit_m`.
pub(crate) fn at_least_m(limit_m: f64) -> f64 {
    let below = at_most_m(limit_m);
    if below >= limit_m * (1.0 - 1e-9) {
        return below;
    }
    [2.0, 2.5, 10.0]
        .into_iter()
        .map(|f| at_most_m(below * f * (1.0 + 1e-9)))
        .find(|s| *s >= limit_m)
        .unwrap_or(10.0 * below)
}

/// A length as a reader says it: "20 m", "0.5 m", "5 cm", "2 mm", "1 km"; the space does not break.
pub(crate) fn spoken(length_m: f64) -> String {
    let tidy = |value: f64| {
        let text = format!("{value:.3}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    match length_m {
        l if l >= 1000.0 => format!("{}\u{a0}km", tidy(l / 1000.0)),
        l if l >= 0.5 => format!("{}\u{a0}m", tidy(l)),
        l if l >= 0.01 => format!("{}\u{a0}cm", tidy(l * 100.0)),
        l => format!("{}\u{a0}mm", tidy(l * 1000.0)),
    }
}

/// A count with thin spaces between thousands: "1 234 567".
pub(crate) fn count(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) && digits.len() > 4 {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// A count and its noun, in the plural where needed: "1 polyline", "12 polylines".
pub(crate) fn counted(n: usize, noun: &str) -> String {
    let ending = match (n, noun) {
        (1, _) => "",
        (_, "vertex") => return format!("{} vertices", count(n)),
        (_, noun) if noun.ends_with('x') => "es",
        _ => "s",
    };
    format!("{} {noun}{ending}", count(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round() {
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        for (limit, below, above) in [
            (7.0, 5.0, 10.0),
            (5.0, 5.0, 5.0),
            (0.19, 0.1, 0.2),
            (1.0, 1.0, 1.0),
            (3.0, 2.0, 5.0),
        ] {
            assert!(
                near(at_most_m(limit), below),
                "at most {limit}: {}",
                at_most_m(limit)
            );
            assert!(
                near(at_least_m(limit), above),
                "at least {limit}: {}",
                at_least_m(limit)
            );
        }
    }

    #[test]
    fn lengths_are_spoken_in_a_fitting_unit() {
        let said: Vec<String> = [2000.0, 20.0, 0.5, 0.05, 0.002].map(spoken).into();
        assert_eq!(
            said.join(", ").replace('\u{a0}', " "),
            "2 km, 20 m, 0.5 m, 5 cm, 2 mm"
        );
    }

    #[test]
    fn counts_read_well() {
        assert_eq!(counted(1, "vertex"), "1 vertex");
        assert_eq!(counted(2, "eraser box"), "2 eraser boxes");
        assert_eq!(counted(1_234_567, "point"), "1\u{2009}234\u{2009}567 points");
    }
}
