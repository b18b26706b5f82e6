//! What the head of a CSV file says about its columns.
//!
//! In go the lines before the first line of numbers: comments, which may hold a `layout:`, or name the first bearing
//! and the step with their units, and a row of column names. Out comes a layout, as far as it can be told.

use super::layout::{Bearings, Column, Layout};
use super::line::fields;
use crate::log::number::number;

/// Fewer readings are no scan of a laser, but a table of something else.
pub(super) const LEAST_READINGS: usize = 16;

/// The layout that the first lines of a file tell; `None` when they are no lines of readings. The bearings may be
/// unknown.
pub(super) fn layout(head: &str) -> Option<Layout> {
    let mut comments = String::new();
    let mut names: Option<Vec<&str>> = None;
    for line in head.lines().map(str::trim) {
        if line.is_empty() {
            continue;
        }
        if let Some(comment) = line.strip_prefix('#') {
            comments.push_str(comment);
            comments.push('\n');
            continue;
        }
        let fields: Vec<&str> = fields(line).collect();
        if fields.iter().all(|f| f.is_empty() || number(f).is_some()) {
            return of_first_line(&comments, names.as_deref(), fields.len());
        }
        if names.is_some() || fields.len() < LEAST_READINGS {
            return None;
        }
        names = Some(fields);
    }
    None
}

fn of_first_line(comments: &str, names: Option<&[&str]>, columns: usize) -> Option<Layout> {
    let declared = comments.lines().find_map(|c| c.trim().strip_prefix("layout:"));
    if let Some(declared) = declared {
        return declared.parse().ok();
    }
    if columns < LEAST_READINGS {
        return None;
    }
    let comments = comments.to_ascii_lowercase();
    let scale_m = match () {
        () if comments.contains("ranges in mm") => 1e-3,
        () if comments.contains("ranges in cm") => 1e-2,
        () => 1.0,
    };
    let columns = match names {
        Some(names) => named_columns(names, scale_m)?,
        None => vec![Column::Ranges {
            scale_m,
            bearing_rad: None,
            readings: None,
        }],
    };
    Some(Layout {
        keyword: None,
        pose_keyword: None,
        columns,
        bearings: Bearings {
            first_rad: angle_rad(
                &comments,
                &["first bearing", "first_bearing", "angle_min", "start angle"],
            ),
            step_rad: angle_rad(&comments, &["step", "angle_increment", "resolution"]),
            width_rad: None,
        },
        max_m: None,
    })
}

/// The angle that stands behind the first of the names that is there, with its unit: `step 0.5 deg`.
fn angle_rad(comments: &str, names: &[&str]) -> Option<f64> {
    let behind = names
        .iter()
        .find_map(|name| Some(&comments[comments.find(name)? + name.len()..]))?;
    let is_word_end = |c: char| c.is_whitespace() || [',', ';', ':', '='].contains(&c);
    let mut words = behind.split(is_word_end).filter(|w| !w.is_empty());
    let value = words.next()?;
    let (value, unit) = match value.strip_suffix('°') {
        Some(value) => (value, "deg"),
        None => (value, words.next().unwrap_or("rad")),
    };
    let angle = number(value).filter(|a| a.is_finite())?;
    let is_degrees = unit.starts_with("deg") || unit.starts_with('°');
    Some(if is_degrees { angle.to_radians() } else { angle })
}

/// Columns by their names: ranges are `r0`, `range_1`, `d[2]`; stamps `stamp`, `time_ms`; poses `x`, `y`, `theta`.
fn named_columns(names: &[&str], scale_m: f64) -> Option<Vec<Column>> {
    let mut columns: Vec<Column> = Vec::new();
    let mut readings = 0;
    for name in names {
        let name = name.trim_matches('"').to_ascii_lowercase();
        if is_range(&name) {
            readings += 1;
            if readings > 1 && !matches!(columns.last(), Some(Column::Ranges { .. })) {
                // Ranges in several groups are not told apart here.
                return None;
            }
            if readings == 1 {
                columns.push(Column::Ranges {
                    scale_m,
                    bearing_rad: None,
                    readings: None,
                });
            }
            continue;
        }
        columns.push(match name.as_str() {
            "stamp" | "stamp_s" | "time" | "time_s" | "timestamp" | "timestamp_s" | "t" => Column::Stamp(1.0),
            "stamp_ms" | "time_ms" | "timestamp_ms" => Column::Stamp(1e-3),
            "stamp_us" | "time_us" | "timestamp_us" => Column::Stamp(1e-6),
            "stamp_ns" | "time_ns" | "timestamp_ns" => Column::Stamp(1e-9),
            "x" | "x_m" => Column::X,
            "y" | "y_m" => Column::Y,
            "theta" | "theta_rad" | "yaw" => Column::Theta(1.0),
            "theta_deg" | "yaw_deg" => Column::Theta(1_f64.to_radians()),
            _ => Column::Skip(Some(1)),
        });
    }
    if readings < LEAST_READINGS {
        return None;
    }
    for column in &mut columns {
        if let Column::Ranges { readings: all, .. } = column {
            *all = Some(readings);
        }
    }
    Some(columns)
}

fn is_range(name: &str) -> bool {
    let stem = name
        .trim_end_matches(']')
        .trim_end_matches(|c: char| c.is_ascii_digit());
    let stem = stem.trim_end_matches(['_', '[']);
    stem.len() < name.len() && ["r", "range", "ranges", "range_m", "d", "distance"].contains(&stem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(count: usize) -> String {
        "1,".repeat(count)
    }

    #[test]
    fn a_comment_with_bearings_is_understood() {
        let text = format!(
            "# ranges in mm; first bearing -90 deg, step 0.5 deg\n{}\n",
            numbers(20)
        );
        let layout = layout(&text).unwrap();
        let (geometry, _) = layout.bearings.geometry(20).unwrap();
        assert!((geometry.bearing_rad(0).to_degrees() + 90.0).abs() < 1e-9);
        assert!((geometry.step_rad().to_degrees() - 0.5).abs() < 1e-9);
        assert!(matches!(layout.columns[..], [Column::Ranges { scale_m, .. }] if scale_m < 0.01));
    }

    #[test]
    fn names_of_columns_are_understood() {
        let names: Vec<String> = (0..18).map(|k| format!("range_{k}")).collect();
        let text = format!("time_ms,battery,{}\n{}\n", names.join(","), numbers(20));
        let layout = layout(&text).unwrap();
        assert_eq!(layout.columns.len(), 3);
        assert!(!layout.bearings.are_known());
    }

    #[test]
    fn tables_of_something_else_are_not_taken() {
        assert_eq!(layout("scan_index,x,y,theta\n1,2,3,4\n"), None);
        assert_eq!(layout("1.5 2.5 0.1 0.2 0 0 0 0.3\n"), None);
        assert_eq!(layout("hello there\n"), None);
    }
}
