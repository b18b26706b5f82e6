//! How well a scan was placed, as fields of `trajectory.csv`.
//!
//! Fields are by the axes of the map, which the row's pose gives; in memory they are by those of the laser. Variances are rounded up
//! and covariances towards 0, so that rounding leaves no direction with a variance below 0.

use std::f64::consts::{FRAC_PI_2, PI};

use polymapper_core::align::Covariance;
use polymapper_core::mapper::{Origin, Quality};

use super::decimals::rounded_3;

/// The columns, in order.
pub(super) const QUALITY_COLUMNS: [&str; 15] = [
    "won",
    "lead",
    "hypotheses",
    "fit",
    "known",
    "through",
    "matched",
    "rank",
    "open_rad",
    "var_x_m2",
    "cov_xy_m2",
    "var_y_m2",
    "cov_xt_m_rad",
    "cov_yt_m_rad",
    "var_t_rad2",
];
/// Where the covariance begins among them.
const COVARIANCE: usize = 9;

/// The fields of a scan with this heading in the map; without one, what has a direction is not known.
pub(super) fn fields(quality: &Quality, heading_rad: Option<f64>) -> [String; QUALITY_COLUMNS.len()] {
    let share = |value: Option<f64>| value.map_or(String::new(), |v| rounded_3(v).to_string());
    let open_rad = quality
        .open_rad
        .zip(heading_rad)
        .map(|(open, by)| along(open + by));
    let covariance = quality
        .covariance
        .zip(heading_rad)
        .map(|(c, by)| c.turned(by).rows);
    let cell = |r: usize, c: usize| {
        let value = covariance.map(|rows| rows[r][c]);
        value.map_or(String::new(), if r == c { variance } else { no_larger })
    };
    [
        quality.won.map_or("", Origin::name).to_owned(),
        share(quality.lead),
        quality.hypotheses.map_or(String::new(), |n| n.to_string()),
        share(quality.fit),
        share(quality.known),
        share(quality.through),
        share(quality.matched),
        quality.rank.map_or(String::new(), |rank| rank.to_string()),
        share(open_rad),
        cell(0, 0),
        cell(0, 1),
        cell(1, 1),
        cell(0, 2),
        cell(1, 2),
        cell(2, 2),
    ]
}

/// Which field is wrong, and what is expected there.
pub(super) type Fault = (usize, &'static str);

/// The quality in `fields`, "" for one that is not there, of a scan with this heading in the map. An origin that is not known is one of a
/// later version, and left out.
///
/// # Errors
/// A field that is no number.
pub(super) fn read<'a>(field: impl Fn(usize) -> &'a str, heading_rad: Option<f64>) -> Result<Quality, Fault> {
    let number = |k: usize| match field(k) {
        "" => Ok(None),
        text => match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err((k, "a number")),
        },
    };
    let hypotheses = match field(2) {
        "" => None,
        text => Some(text.parse().map_err(|_| (2, "a number of poses"))?),
    };
    let rank = match field(7) {
        "" => None,
        text => Some(text.parse().ok().filter(|&rank| rank <= 3).ok_or((7, "0 to 3"))?),
    };
    let mut cells = [None; 6];
    for (k, cell) in cells.iter_mut().enumerate() {
        *cell = number(COVARIANCE + k)?;
    }
    let covariance = match cells {
        [Some(xx), Some(xy), Some(yy), Some(xt), Some(yt), Some(tt)] => Some(Covariance {
            rows: [[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]],
        }),
        _ => None,
    };
    let open_rad = number(8)?;
    Ok(Quality {
        won: Origin::named(field(0)),
        lead: number(1)?,
        hypotheses,
        fit: number(3)?,
        known: number(4)?,
        through: number(5)?,
        matched: number(6)?,
        rank,
        open_rad: open_rad.zip(heading_rad).map(|(open, by)| open - by),
        covariance: covariance.zip(heading_rad).map(|(c, by)| c.turned(-by)),
    })
}

/// A direction that is the same the other way round, in (−π/2, π/2].
fn along(direction_rad: f64) -> f64 {
    FRAC_PI_2 - (FRAC_PI_2 - direction_rad).rem_euclid(PI)
}

/// Digits of a variance or covariance. Of a corridor that lies askew in the map, both variances are of the place along it, and what is known
/// across is their difference from the covariance.
const DIGITS: i32 = 4;

/// Four digits, no smaller than `value`.
fn variance(value: f64) -> String {
    short(value, f64::ceil)
}

/// Four digits, no larger than `value` in size.
fn no_larger(value: f64) -> String {
    short(value, f64::trunc)
}

fn short(value: f64, round: fn(f64) -> f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let scale = 10_f64.powi(DIGITS - 1 - value.abs().log10().floor() as i32);
    // The quotient may be off in its last bit: printed with the digits that count, and those that are 0 left out.
    let text = format!("{:.3e}", round(value * scale) / scale);
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    format!(
        "{}e{exponent}",
        digits.trim_end_matches('0').trim_end_matches('.')
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Along a corridor that lies 0.6 rad to the left of the scanner.
    fn in_a_corridor() -> Quality {
        let rows = [[0.25, 0.0, 0.0], [0.0, 2.5e-5, 1e-6], [0.0, 1e-6, 4e-6]];
        Quality {
            won: Some(Origin::Shape),
            lead: Some(0.25),
            hypotheses: Some(12),
            fit: Some(0.875),
            known: Some(0.75),
            through: Some(0.125),
            matched: Some(1.0),
            rank: Some(2),
            open_rad: Some(0.6),
            covariance: Some(Covariance { rows }.turned(0.6)),
        }
    }

    #[test]
    fn directions_are_those_of_the_map() {
        let ahead = fields(&in_a_corridor(), Some(-0.6));
        assert_eq!(ahead[..9].join(","), "shape,0.25,12,0.875,0.75,0.125,1,2,0");
        let value = |k: usize| ahead[k].parse::<f64>().unwrap();
        assert!((value(9) - 0.25).abs() < 1e-3 && (value(11) - 2.5e-5).abs() < 1e-7);
        assert!(value(10).abs() < 1e-12 && (value(14) - 4e-6).abs() < 1e-8);
        let up = fields(&in_a_corridor(), Some(-0.6 + FRAC_PI_2));
        assert_eq!(up[8], "1.571", "the same the other way round");
    }

    #[test]
    fn what_was_written_is_read_back_and_is_still_a_covariance() {
        let quality = in_a_corridor();
        for heading_rad in [0.0, 0.2, 1.0, -2.0] {
            let written = fields(&quality, Some(heading_rad));
            let back = read(|k| &written[k], Some(heading_rad)).unwrap();
            let rest = Quality {
                open_rad: quality.open_rad,
                covariance: quality.covariance,
                ..back
            };
            assert_eq!(rest, quality);
            assert!((back.open_rad.unwrap() - 0.6).sin().abs() < 1e-3);
            let [[xx, xy, _], [_, yy, _], _] = back.covariance.unwrap().turned(-0.6).rows;
            assert!((xx - 0.25).abs() < 3e-4, "{xx} m² along");
            assert!(yy > 2.4e-5 && yy < 3e-4 && xx * yy > xy * xy, "{yy} m² across");
        }
    }

    #[test]
    fn what_is_not_known_is_empty_and_without_a_place_there_are_no_directions() {
        assert_eq!(
            fields(&Quality::default(), Some(1.0)),
            [const { String::new() }; 15]
        );
        assert_eq!(read(|_| "", Some(1.0)), Ok(Quality::default()));
        let lost = fields(&in_a_corridor(), None);
        assert_eq!(lost[..8].join(","), "shape,0.25,12,0.875,0.75,0.125,1,2");
        assert_eq!(lost[8..], [const { String::new() }; 7]);
    }

    #[test]
    fn numbers_are_short_and_rounded_to_the_safe_side() {
        assert_eq!(
            [variance(0.0), variance(2.5e-5), variance(0.123_401)],
            ["0", "2.5e-5", "1.235e-1"]
        );
        assert_eq!([no_larger(-1.2349e-7), no_larger(100.0)], ["-1.234e-7", "1e2"]);
    }

    #[test]
    fn what_cannot_be_is_named() {
        let with = |at: usize, text: &'static str| read(move |k| if k == at { text } else { "" }, Some(0.0));
        assert_eq!(with(3, "much"), Err((3, "a number")));
        assert_eq!(with(9, "inf"), Err((9, "a number")));
        assert_eq!(with(7, "4"), Err((7, "0 to 3")));
        assert_eq!(with(2, "-1"), Err((2, "a number of poses")));
        assert_eq!(with(0, "of a later version").unwrap().won, None);
    }
}
