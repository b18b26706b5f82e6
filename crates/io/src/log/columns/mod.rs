//! Text with a scan in a line, by a declared layout: CSV, and what small scanners are logged with.
//!
//! In go lines, out come scans. The layout ([`Layout`]) is the one that was asked for, the one that the file declares
//! in its head ([`header`]), or one of the table of known files ([`known`]) that fits the first lines. Lines that
//! begin with `#` are comments.

mod header;
mod known;
mod layout;
mod line;
mod uneven;

use polymapper_core::geometry::Pose;
use polymapper_core::scan::{NoReturnCode, ScanGeometry};

use super::keeper::{Keeper, Reading};
use super::text::{TextLines, as_text};
use super::{Entry, LineFault, LogError, ReadOptions, ScanReader, Tally, Unit};
use crate::input::Input;
use known::KNOWN;
pub use layout::{Layout, LayoutError};
pub(super) use uneven::EvenBearings;

/// Lines of scans that must fit a known layout.
const LINES_TRIED: usize = 3;

pub(super) fn recognise(head: &[u8]) -> bool {
    whole_lines(head).is_some_and(|text| known_layout(text).is_some() || header::layout(text).is_some())
}

/// The head as text without its last line, which may be cut; `None` for binary data.
fn whole_lines(head: &[u8]) -> Option<&str> {
    let end = head
        .iter()
        .rposition(|&b| b == b'\n')
        .map_or(head.len(), |end| end + 1);
    let text = std::str::from_utf8(&head[..end]).ok()?;
    (!text.contains('\0')).then_some(text)
}

/// The known layout that the first lines fit, and its name.
fn known_layout(head: &str) -> Option<(Layout, &'static str)> {
    KNOWN.iter().find_map(|known| {
        let layout: Layout = known.layout.parse().ok()?;
        fits(head, &layout).then_some((layout, known.name))
    })
}

fn fits(head: &str, layout: &Layout) -> bool {
    let is_pose = |line: &&str| layout.pose_keyword.as_deref() == Some(first_word(line));
    let has_keyword = |line: &str| layout.keyword.as_deref().is_none_or(|k| first_word(line) == k);
    let mut lines = head
        .lines()
        .map(str::trim)
        .filter(|l| !l.is_empty() && !l.starts_with('#'))
        .filter(|l| !is_pose(l))
        .take(LINES_TRIED)
        .peekable();
    lines.peek().is_some() && lines.all(|line| has_keyword(line) && line::parse(line, layout).is_ok())
}

fn first_word(line: &str) -> &str {
    line.split_ascii_whitespace().next().unwrap_or_default()
}

pub(super) fn open(input: Input, options: &ReadOptions) -> Result<Box<dyn ScanReader>, LogError> {
    let mut keeper = Keeper::new(Unit::Line, options);
    let layout = match &options.layout {
        Some(layout) => layout.clone(),
        None => {
            let head = String::from_utf8_lossy(&input.head);
            let head = whole_lines(&input.head).unwrap_or(&head);
            if let Some((layout, name)) = known_layout(head) {
                keeper.note(format!("taken as {name}; --layout says otherwise"));
                layout
            } else {
                header::layout(head).ok_or_else(|| LogError::unrecognised(input.name.clone(), &input.head))?
            }
        }
    };
    if !layout.bearings.are_known() && !layout.has_bearings() {
        return Err(LogError::NoBearings {
            name: input.name.clone(),
        });
    }
    Ok(Box::new(ColumnsReader {
        lines: TextLines::new(input),
        use_odometry: options.use_odometry,
        layout,
        pose: None,
        no_return: NoReturnCode::default(),
        even: EvenBearings::default(),
        keeper,
    }))
}

struct ColumnsReader {
    lines: TextLines,
    use_odometry: bool,
    layout: Layout,
    /// Of the last line with a pose.
    pose: Option<Pose>,
    no_return: NoReturnCode,
    even: EvenBearings,
    keeper: Keeper,
}

impl ScanReader for ColumnsReader {
    fn next_entry(&mut self) -> Option<Result<Entry, LogError>> {
        loop {
            let line = match self.lines.next_line()? {
                Ok(line) => line,
                Err(broken) => return Some(Err(broken)),
            };
            let number = line.number;
            let text = match as_text(&line) {
                Ok(text) => text,
                Err(fault) => return Some(Ok(self.keeper.entry(number, Err(fault)))),
            };
            match kind(text, &self.layout) {
                Kind::Nothing => {}
                Kind::Pose => {
                    if self.use_odometry {
                        let fields: Vec<&str> = line::fields(text).skip(1).take(3).collect();
                        self.pose = super::number::pose(&fields);
                    }
                    self.keeper.count_other(first_word(text).as_bytes());
                }
                Kind::Other => self.keeper.count_other(first_word(text).as_bytes()),
                Kind::Scan => {
                    let parsed = line::parse(text, &self.layout);
                    let pose = self.pose.take();
                    let reading = parsed.and_then(|mut p| {
                        p.pose = p.pose.or(pose).filter(|_| self.use_odometry);
                        let (geometry, ranges_m) = if p.bearings_rad.is_empty() {
                            with_bearings(p.ranges_m, &self.layout)?
                        } else {
                            let note = "readings with a bearing each, put onto evenly spaced bearings";
                            self.keeper.note(note.to_owned());
                            self.even
                                .scan(p.bearings_rad.into_iter().zip(p.ranges_m).collect())?
                        };
                        let max_m = self.layout.max_m.or_else(|| {
                            self.no_return.observe(&ranges_m);
                            self.no_return.from_m()
                        });
                        Ok(Reading {
                            geometry: max_m.map_or(geometry, |m| geometry.with_limits(0.0, m)),
                            ranges_m,
                            stamp_s: p.stamp_s,
                            odometry: p.pose,
                        })
                    });
                    return Some(Ok(self.keeper.entry(number, reading)));
                }
            }
        }
    }

    fn continue_with(&mut self, input: Input) -> Result<(), LogError> {
        self.lines.continue_with(input);
        Ok(())
    }

    fn tally(&self) -> Tally {
        let mut tally = self.lines.tally(&self.keeper);
        tally.laser.clone_from(&self.layout.keyword);
        if let (Some(from_m), None) = (self.no_return.from_m(), self.layout.max_m) {
            tally.notes.push(format!(
                "no range limit in the log: {from_m:.3} m and more taken as no return, since that recurs and nothing is longer"
            ));
        }
        tally
    }
}

enum Kind {
    /// A comment, an empty line, names of columns.
    Nothing,
    Pose,
    Scan,
    Other,
}

fn kind(line: &str, layout: &Layout) -> Kind {
    let word = first_word(line);
    if word.is_empty() || word.starts_with('#') {
        return Kind::Nothing;
    }
    if layout.pose_keyword.as_deref() == Some(word) {
        return Kind::Pose;
    }
    match &layout.keyword {
        Some(keyword) if keyword == word => Kind::Scan,
        Some(_) => Kind::Other,
        None if line.starts_with(|c: char| c.is_ascii_alphabetic()) && is_names(line) => Kind::Nothing,
        None => Kind::Scan,
    }
}

/// Whether a line holds names of columns: nothing in it is a number.
fn is_names(line: &str) -> bool {
    line::fields(line).all(|f| super::number::number(f).is_none())
}

/// Ranges with the bearings that the layout gives them.
fn with_bearings(mut ranges_m: Vec<f64>, layout: &Layout) -> Result<(ScanGeometry, Vec<f64>), LineFault> {
    let (geometry, turned) = layout.bearings.geometry(ranges_m.len())?;
    if turned {
        ranges_m.reverse();
    }
    Ok((geometry, ranges_m))
}
