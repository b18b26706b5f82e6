//! What a drawing holds, and how it becomes a map: ids, evidence, eraser boxes.

use std::collections::{BTreeMap, BTreeSet};

use polymapper_core::geometry::Point;
use polymapper_core::map::{EraserBox, Map, MapPolyline, MapVertex};

use super::Imported;
use crate::out::FARTHEST_M;

/// More vertices than this are no map (curves can unfold a small file to many).
const MOST_VERTICES: usize = 4_000_000;
/// More boxes are no map either; each is compared with all others.
const MOST_BOXES: usize = 10_000;
/// A vertex this near its old place did not move, metres.
const SAME_PLACE_M: f64 = 1e-3;
/// Vertices of a line closer than this are one, metres.
const ONE_POINT_M: f64 = 1e-6;

/// A line of a drawing, map frame.
#[derive(Default)]
pub(super) struct Line {
    pub id: Option<u64>,
    pub points: Vec<Point>,
    /// Observations and standard deviations, where the file has one for every point.
    pub evidence: Vec<(u32, f64)>,
}

/// Everything in a drawing that matters to a map.
#[derive(Default)]
pub(super) struct Shapes {
    lines: Vec<Line>,
    boxes: Vec<EraserBox>,
    vertices: usize,
    skipped: BTreeMap<String, usize>,
    pub notes: Vec<String>,
}

/// What a thing of the drawing is in the map, by its layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Wall,
    EraserBox,
    /// Made by the export to be looked at.
    Nothing,
}

impl Role {
    /// The role of a layer by its name, however a format spells it: eraser boxes, the way and the frame have
    /// theirs, everything else is walls.
    pub fn of_layer(name: &str) -> Self {
        match name.to_lowercase().replace(['_', '-'], " ").as_str() {
            "eraser boxes" => Self::EraserBox,
            "way" | "frame" => Self::Nothing,
            _ => Self::Wall,
        }
    }
}

impl Shapes {
    pub fn of_map(map: Map) -> Self {
        let line = |p: MapPolyline| Line {
            id: Some(p.id),
            points: p.vertices.iter().map(|v| v.point).collect(),
            evidence: p.vertices.iter().map(|v| (v.observations, v.sigma_m)).collect(),
        };
        Self {
            lines: map.polylines.into_iter().map(line).collect(),
            boxes: map.eraser_boxes,
            ..Self::default()
        }
    }

    /// Takes a line in its role.
    ///
    /// # Errors
    /// A coordinate that is none, more vertices than a map can have.
    pub fn add(&mut self, role: Role, line: Line) -> Result<(), String> {
        if let Some(p) = line
            .points
            .iter()
            .find(|p| !(p.x.abs() <= FARTHEST_M && p.y.abs() <= FARTHEST_M))
        {
            return Err(format!(
                "a vertex at ({}, {}) m, at most {FARTHEST_M:e} m are expected: are the units right?",
                p.x, p.y
            ));
        }
        self.vertices += line.points.len();
        if self.vertices > MOST_VERTICES {
            return Err(format!("more than {MOST_VERTICES} vertices"));
        }
        match role {
            Role::Wall => self.lines.push(line),
            Role::EraserBox if self.boxes.len() == MOST_BOXES => {
                return Err(format!("more than {MOST_BOXES} eraser boxes"));
            }
            Role::EraserBox => match box_around(&line.points) {
                Some(b) => self.boxes.push(b),
                None => self.skip("empty eraser box"),
            },
            Role::Nothing => {}
        }
        Ok(())
    }

    /// Counts something that is no line.
    pub fn skip(&mut self, what: &str) {
        const MOST_KINDS: usize = 32;
        let known = self.skipped.len() < MOST_KINDS || self.skipped.contains_key(what);
        let what: String = if known {
            what.chars().take(60).collect()
        } else {
            "other things".to_owned()
        };
        *self.skipped.entry(what).or_insert(0) += 1;
    }

    /// The map. Vertices that did not move since `base` keep what they rest on there.
    ///
    /// # Errors
    /// Nothing in the drawing makes a line.
    pub fn into_map(mut self, format: &'static str, base: Option<&Map>) -> Result<Imported, String> {
        let base: BTreeMap<u64, &MapPolyline> = base
            .map(|map| map.polylines.iter().map(|p| (p.id, p)).collect())
            .unwrap_or_default();
        let lines = std::mem::take(&mut self.lines);
        let mut ids = Ids::new(&lines, &base);
        let mut polylines = Vec::new();
        for line in lines {
            let vertices = vertices(&line, line.id.and_then(|id| base.get(&id).copied()));
            if vertices.len() < 2 {
                self.skip("line of a single point");
                continue;
            }
            let id = ids.give(line.id);
            polylines.push(MapPolyline { id, vertices });
        }
        if polylines.is_empty() && self.boxes.is_empty() && !self.skipped.is_empty() {
            let found: Vec<String> = self
                .skipped
                .iter()
                .map(|(what, n)| format!("{n} × {what}"))
                .collect();
            return Err(format!(
                "no line in it that could be a wall; it has {}",
                found.join(", ")
            ));
        }
        Ok(Imported {
            map: Map {
                polylines,
                eraser_boxes: disjoint(self.boxes),
            },
            format,
            kept_ids: ids.kept,
            new_ids: ids.new,
            skipped: self.skipped,
            notes: self.notes,
        })
    }
}

fn vertices(line: &Line, old: Option<&MapPolyline>) -> Vec<MapVertex> {
    let mut vertices: Vec<MapVertex> = Vec::new();
    for (k, &point) in line.points.iter().enumerate() {
        if vertices
            .last()
            .is_some_and(|v| v.point.distance(point) < ONE_POINT_M)
        {
            continue;
        }
        let unmoved = old.and_then(|old| {
            let near = |v: &&MapVertex| v.point.distance(point) < SAME_PLACE_M;
            old.vertices
                .iter()
                .find(near)
                .map(|v| (v.observations, v.sigma_m))
        });
        let written = (line.evidence.len() == line.points.len()).then(|| line.evidence[k]);
        // A vertex drawn by hand rests on no observation, and nobody knows how well it stands.
        let (observations, sigma_m) = unmoved.or(written).unwrap_or((0, f64::NAN));
        vertices.push(MapVertex {
            point,
            observations,
            sigma_m,
        });
    }
    vertices
}

/// Gives every line an id of its own: what it brought, unless another was first; otherwise the next one free.
struct Ids {
    given: BTreeSet<u64>,
    /// Ids that some line brings or the base has: new lines do not take them.
    taken: BTreeSet<u64>,
    next: u64,
    kept: usize,
    new: usize,
}

impl Ids {
    fn new(lines: &[Line], base: &BTreeMap<u64, &MapPolyline>) -> Self {
        let taken: BTreeSet<u64> = lines
            .iter()
            .filter_map(|l| l.id)
            .chain(base.keys().copied())
            .collect();
        Self {
            given: BTreeSet::new(),
            next: taken.last().map_or(0, |&last| last.wrapping_add(1)),
            taken,
            kept: 0,
            new: 0,
        }
    }

    fn give(&mut self, brought: Option<u64>) -> u64 {
        if let Some(id) = brought.filter(|&id| self.given.insert(id)) {
            self.kept += 1;
            return id;
        }
        while self.taken.contains(&self.next) {
            self.next = self.next.wrapping_add(1);
        }
        self.taken.insert(self.next);
        self.given.insert(self.next);
        self.new += 1;
        self.next
    }
}

fn box_around(points: &[Point]) -> Option<EraserBox> {
    let first = *points.first()?;
    let around = |b: EraserBox, p: &Point| b.joined(&EraserBox { min: *p, max: *p });
    Some(points.iter().fold(
        EraserBox {
            min: first,
            max: first,
        },
        around,
    ))
}

/// Boxes that overlap become one, as in every map.
fn disjoint(boxes: Vec<EraserBox>) -> Vec<EraserBox> {
    let mut disjoint: Vec<EraserBox> = Vec::new();
    for mut b in boxes {
        while let Some(k) = disjoint.iter().position(|other| other.overlaps(&b)) {
            b = b.joined(&disjoint.remove(k));
        }
        disjoint.push(b);
    }
    disjoint
}
