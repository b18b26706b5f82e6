//! The parts of a log that is a folder: a ROS 2 recording, or one log cut into files.
//!
//! In goes the folder, out come its files in the natural order of their names (`run_2` before `run_10`), as far
//! as they are of the format of the first that is a log. Other files are left out and said, but for the
//! `metadata.yaml` of a ROS 2 recording, which tells nothing that the files do not.

use std::cmp::Ordering;
use std::collections::VecDeque;
use std::fs;
use std::path::{Path, PathBuf};

use super::{Format, LogError, MAX_NAMES, ReadOptions, format_of};
use crate::input::Input;

/// The first part, opened, and what follows.
pub(super) struct Found {
    pub input: Input,
    pub rest: VecDeque<PathBuf>,
    pub notes: Vec<String>,
}

/// Opens the first file of the folder that is a log.
///
/// # Errors
/// A folder that cannot be read or has no log in it.
pub(super) fn first_part(folder: &Path, options: &ReadOptions) -> Result<Found, LogError> {
    let mut parts = files(folder).map_err(|source| LogError::Unreadable {
        name: folder.display().to_string(),
        source,
    })?;
    let mut notes = Vec::new();
    while let Some(path) = parts.pop_front() {
        match Input::open(&path) {
            Ok(input) if format_of(&input.head, options).is_some() => {
                let rest = parts;
                return Ok(Found { input, rest, notes });
            }
            Ok(_) => left_out(&mut notes, &path, "it is no laser log that is known here"),
            Err(error) => left_out(&mut notes, &path, &error.to_string()),
        }
    }
    Err(LogError::Directory {
        name: folder.display().to_string(),
    })
}

/// Opens a part that is to be of `format`; the error says why it is left out.
pub(super) fn open_part(path: &Path, format: &Format, options: &ReadOptions) -> Result<Input, String> {
    let input = Input::open(path).map_err(|error| error.to_string())?;
    match format_of(&input.head, options) {
        Some(found) if found.name == format.name => Ok(input),
        Some(found) => Err(format!(
            "it is {}, the files before it are {}",
            found.name, format.name
        )),
        None => Err("it is no laser log that is known here".to_owned()),
    }
}

/// Notes that a file of the folder is not read.
pub(super) fn left_out(notes: &mut Vec<String>, path: &Path, why: &str) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if name != "metadata.yaml" && notes.len() < MAX_NAMES {
        notes.push(format!("{name} in the folder is left out: {why}"));
    }
}

/// The files of the folder, without those that hide, in natural order.
fn files(folder: &Path) -> std::io::Result<VecDeque<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let hides = path
            .file_name()
            .is_some_and(|n| n.as_encoded_bytes().starts_with(b"."));
        if path.is_file() && !hides {
            files.push(path);
        }
    }
    files.sort_by(|a, b| natural_order(&a.to_string_lossy(), &b.to_string_lossy()).then_with(|| a.cmp(b)));
    Ok(files.into())
}

/// Compares names with the numbers in them taken as numbers.
fn natural_order(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a, b);
    loop {
        let (number_a, number_b) = (leading_digits(a), leading_digits(b));
        if !number_a.is_empty() && !number_b.is_empty() {
            let (value_a, value_b) = (number_a.trim_start_matches('0'), number_b.trim_start_matches('0'));
            let order = value_a
                .len()
                .cmp(&value_b.len())
                .then_with(|| value_a.cmp(value_b));
            if order.is_ne() {
                return order;
            }
            (a, b) = (&a[number_a.len()..], &b[number_b.len()..]);
            continue;
        }
        let (mut chars_a, mut chars_b) = (a.chars(), b.chars());
        match (chars_a.next(), chars_b.next()) {
            (Some(x), Some(y)) if x == y => (a, b) = (chars_a.as_str(), chars_b.as_str()),
            (x, y) => return x.cmp(&y),
        }
    }
}

fn leading_digits(text: &str) -> &str {
    let end = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
    &text[..end]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = ["run_10.bag", "run_9.bag", "run_1.bag", "run.bag", "run_01.bag"];
        names.sort_by(|a, b| natural_order(a, b).then_with(|| a.cmp(b)));
        assert_eq!(
            names,
            ["run.bag", "run_01.bag", "run_1.bag", "run_9.bag", "run_10.bag"]
        );
    }
}
