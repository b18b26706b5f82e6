//! DXF as text, R12 and later → lines.
//!
//! `LINE`, `POLYLINE` and `LWPOLYLINE` of the model; ids are the extended data that the export gave them. Units
//! are those of `$INSUNITS`, metres where it says nothing. Group codes: Autodesk, DXF Reference.

use std::iter::Peekable;

use polymapper_core::geometry::Point;

use super::ImportOptions;
use super::shapes::{Line, Role, Shapes};
use crate::out::XDATA_APPLICATION;

/// `$INSUNITS` and what a unit is in metres.
const UNITS: [(i64, f64); 6] = [
    (1, 0.0254),
    (2, 0.3048),
    (4, 0.001),
    (5, 0.01),
    (6, 1.0),
    (14, 0.1),
];

/// Whether the text begins as DXF does: a comment, or a section.
pub(super) fn recognise(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim);
    match (lines.next(), lines.next()) {
        (Some("0"), Some(value)) => value == "SECTION",
        (Some("999"), Some(_)) => true,
        _ => false,
    }
}

pub(super) fn read(text: &str, options: &ImportOptions) -> Result<Shapes, String> {
    let mut tags = Tags::new(text).peekable();
    let mut reader = Reader {
        scale: options.metres_per_unit,
        shapes: Shapes::default(),
    };
    let mut section = "";
    let mut ended = false;
    while let Some(tag) = tags.next() {
        let tag = tag?;
        match (tag.code, tag.value) {
            (0, "EOF") => {
                ended = true;
                break;
            }
            (0, "ENDSEC") => section = "",
            (0, "SECTION") => {
                if let Some(Ok(name)) = tags.next_if(|t| matches!(t, Ok(t) if t.code == 2)) {
                    section = name.value;
                }
            }
            (9, "$INSUNITS") if section == "HEADER" => {
                if let Some(Ok(unit)) = tags.next_if(|t| matches!(t, Ok(t) if t.code == 70)) {
                    reader.unit(unit.value)?;
                }
            }
            (0, kind) if section == "ENTITIES" => reader.entity(kind, &mut tags)?,
            _ => {}
        }
    }
    if !ended {
        return Err("it ends before its EOF: the file is cut".to_owned());
    }
    Ok(reader.shapes)
}

/// A group: a code and its value.
#[derive(Clone, Copy)]
struct Tag<'a> {
    code: i32,
    value: &'a str,
    /// 1-based line of the code.
    line: usize,
}

impl Tag<'_> {
    fn number(&self) -> Result<f64, String> {
        let number = self.value.parse().ok().filter(|v: &f64| v.is_finite());
        number.ok_or_else(|| {
            let found: String = self.value.chars().take(20).collect();
            format!("line {}: {found:?} where a number is expected", self.line + 1)
        })
    }
}

struct Tags<'a> {
    lines: std::str::Lines<'a>,
    line: usize,
}

impl<'a> Tags<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            lines: text.lines(),
            line: 0,
        }
    }
}

impl<'a> Iterator for Tags<'a> {
    type Item = Result<Tag<'a>, String>;

    fn next(&mut self) -> Option<Self::Item> {
        let code = self.lines.next()?.trim();
        let line = self.line + 1;
        let Some(value) = self.lines.next() else {
            let fault = format!("line {line}: a code without a value");
            return (!code.is_empty()).then_some(Err(fault));
        };
        self.line += 2;
        let found: String = code.chars().take(20).collect();
        Some(match code.parse() {
            Ok(code) => Ok(Tag {
                code,
                value: value.trim(),
                line,
            }),
            Err(_) => Err(format!("line {line}: {found:?} where a group code is expected")),
        })
    }
}

/// What the groups of an entity say, as far as it matters.
#[derive(Default)]
struct Entity {
    layer: String,
    flags: i64,
    in_paper_space: bool,
    id: Option<u64>,
    points: Vec<Point>,
    /// The second point of a `LINE`.
    end: Option<Point>,
    has_bulge: bool,
    is_mirrored: bool,
}

struct Reader {
    /// Metres a unit; `None` until something says.
    scale: Option<f64>,
    shapes: Shapes,
}

impl Reader {
    fn unit(&mut self, value: &str) -> Result<(), String> {
        let code: Option<i64> = value.parse().ok();
        match UNITS.iter().find(|(unit, _)| Some(*unit) == code) {
            Some(&(_, metres)) => self.scale = self.scale.or(Some(metres)),
            None if code == Some(0) => {}
            None if self.scale.is_some() => {}
            None => {
                let value: String = value.chars().take(20).collect();
                return Err(format!(
                    "$INSUNITS is {value}, which is not known: give --metres-per-unit"
                ));
            }
        }
        Ok(())
    }

    fn entity<'a>(
        &mut self,
        kind: &'a str,
        tags: &mut Peekable<impl Iterator<Item = Result<Tag<'a>, String>>>,
    ) -> Result<(), String> {
        let mut entity = Entity::default();
        groups(&mut entity, tags)?;
        if kind == "POLYLINE" {
            // Its own point is a dummy; the vertices follow until SEQEND.
            entity.points.clear();
            loop {
                let next = tags.next_if(
                    |t| matches!(t, Ok(t) if t.code == 0 && ["VERTEX", "SEQEND"].contains(&t.value)),
                );
                let Some(Ok(next)) = next else { break };
                let mut part = Entity::default();
                groups(&mut part, tags)?;
                if next.value == "SEQEND" {
                    break;
                }
                entity.has_bulge |= part.has_bulge;
                entity.points.extend(part.points.first());
            }
        }
        self.take(kind, entity)
    }

    fn take(&mut self, kind: &str, mut entity: Entity) -> Result<(), String> {
        const CLOSED: i64 = 1;
        const MESH: i64 = 16 | 64;
        let role = Role::of_layer(&entity.layer);
        if role == Role::Nothing || entity.in_paper_space {
            return Ok(());
        }
        match kind {
            "LINE" => entity.points.extend(entity.end),
            "POLYLINE" if entity.flags & MESH != 0 => {
                self.shapes.skip("POLYLINE that is a mesh");
                return Ok(());
            }
            "POLYLINE" | "LWPOLYLINE" if entity.flags & CLOSED != 0 => {
                entity.points.extend(entity.points.first().copied());
            }
            "POLYLINE" | "LWPOLYLINE" => {}
            other => {
                self.shapes.skip(other);
                return Ok(());
            }
        }
        if entity.has_bulge {
            self.shapes.skip("arc in a polyline (taken as straight)");
        }
        if entity.is_mirrored {
            self.shapes.skip(&format!("{kind} seen from below"));
            return Ok(());
        }
        let scale = self.scale.unwrap_or_else(|| {
            self.shapes
                .notes
                .push("the file does not say its unit: taken as metres".to_owned());
            1.0
        });
        self.scale = Some(scale);
        let line = Line {
            id: entity.id,
            points: entity.points.iter().map(|&p| p * scale).collect(),
            ..Line::default()
        };
        self.shapes.add(role, line)
    }
}

/// Reads the groups up to the next entity.
fn groups<'a>(
    entity: &mut Entity,
    tags: &mut Peekable<impl Iterator<Item = Result<Tag<'a>, String>>>,
) -> Result<(), String> {
    let mut application = "";
    while let Some(tag) = tags.next_if(|t| !matches!(t, Ok(t) if t.code == 0)) {
        let tag = tag?;
        let whole = || tag.value.parse().unwrap_or(0);
        match tag.code {
            8 => entity.layer = tag.value.to_owned(),
            10 => entity.points.push(Point::new(tag.number()?, 0.0)),
            20 => {
                if let Some(last) = entity.points.last_mut() {
                    last.y = tag.number()?;
                }
            }
            11 => entity.end = Some(Point::new(tag.number()?, 0.0)),
            21 => {
                if let Some(end) = &mut entity.end {
                    end.y = tag.number()?;
                }
            }
            42 => entity.has_bulge |= tag.number()?.abs() > 1e-9,
            67 => entity.in_paper_space = whole() == 1,
            70 => entity.flags = whole(),
            230 => entity.is_mirrored = tag.number()? < 0.0,
            1001 => application = tag.value,
            1000 if application == XDATA_APPLICATION => {
                entity.id = tag.value.strip_prefix("id=").and_then(|id| id.parse().ok());
            }
            _ => {}
        }
    }
    Ok(())
}
