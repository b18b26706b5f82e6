//! New points into ordered polylines (paper section 4, joining rules 1 to 3 and bifurcations).
//!
//! A polyline of the scan, cut into runs, is threaded through the map's polylines: a run that lies on a map polyline
//! takes the place of that stretch of it, new runs stand between, and what lies before the first and behind the last
//! stretch stays joined. Points that were neighbours in the scan or in the map so end up in one polyline. Where scan
//! and map part ways (an open door), the map's branch becomes a polyline of its own.

use super::MergeSettings;
use super::growing_map::{Evidence, GrowingMap, Vertex};
use super::link::{Link, Run};
use super::sharp::without_sharp_vertices;
use super::simulate::ScanPoint;
use crate::geometry::{Point, Segment};

/// A stretch of one map polyline that the chain has taken over.
struct Taken {
    slot: u32,
    /// Place on the map's polyline up to which it is taken.
    upto: f64,
}

/// A polyline in the making.
struct Chain<'a> {
    map: &'a GrowingMap,
    settings: &'a MergeSettings,
    /// Number of the scan.
    number: u32,
    vertices: Vec<Vertex>,
    taken: Vec<Taken>,
    branches: Vec<Vec<Vertex>>,
}

/// Threads the runs of one scan polyline into the map; returns how many runs it could take. Fewer than all when the
/// scan's polyline comes back to a stretch of the map before one it has already taken (it closes a loop): the caller
/// goes on with the rest.
pub(crate) fn splice(map: &mut GrowingMap, runs: &[Run], number: u32, settings: &MergeSettings) -> usize {
    let mut chain = Chain {
        map: &*map,
        settings,
        number,
        vertices: Vec::new(),
        taken: Vec::new(),
        branches: Vec::new(),
    };
    let mut done: usize = 0;
    for run in runs {
        if !chain.push(run, done == 0) {
            break;
        }
        done += 1;
    }
    let last = done.checked_sub(1).and_then(|k| runs[k].slot);
    chain.finish(last);
    let Chain {
        vertices,
        taken,
        branches,
        ..
    } = chain;
    let vertices = without_sharp_vertices(vertices, settings.sharp_angle_rad);
    match taken.first() {
        Some(first) => map.replace(first.slot, vertices),
        None => {
            map.add(vertices);
        }
    }
    for taken in taken.iter().skip(1) {
        map.remove(taken.slot);
    }
    for branch in branches {
        map.add(branch);
    }
    done
}

impl Chain<'_> {
    fn push(&mut self, run: &Run, is_first: bool) -> bool {
        let (Some(slot), Some((from, to))) = (run.slot, run.reach()) else {
            self.extend_apart(run.points.iter().map(|(p, _)| p.vertex));
            return true;
        };
        let Some(old) = self.map.polyline(slot) else {
            return true;
        };
        let old = &old.vertices;
        let before_run = from.ceil() as usize;
        match self.taken.iter().position(|t| t.slot == slot) {
            Some(k) => {
                let upto = self.taken[k].upto;
                if from < upto {
                    return false;
                }
                // The stretch between two runs, which the scan went past on another way.
                let between = old.get(upto.floor() as usize + 1..before_run).unwrap_or(&[]);
                self.branch(between);
                self.taken[k].upto = to;
                self.extend_apart(merged(old, run, self.number, self.settings));
            }
            None => {
                let head = &old[..before_run.min(old.len())];
                if is_first {
                    self.vertices.extend_from_slice(head);
                    self.vertices.extend(merged(old, run, self.number, self.settings));
                } else {
                    self.branch(head);
                    self.extend_apart(merged(old, run, self.number, self.settings));
                }
                self.taken.push(Taken { slot, upto: to });
            }
        }
        true
    }

    /// Adds vertices that were not neighbours of the last one in the map: the side to them is new.
    fn extend_apart(&mut self, vertices: impl IntoIterator<Item = Vertex>) {
        if let Some(last) = self.vertices.last_mut() {
            last.onward = Evidence::of(1, self.number);
        }
        self.vertices.extend(vertices);
    }

    /// The polyline goes on with what is left of the map polyline that its last run lies on, which may have been taken up before
    /// others.
    fn finish(&mut self, last: Option<u32>) {
        for k in 0..self.taken.len() {
            let Taken { slot, upto } = self.taken[k];
            let Some(old) = self.map.polyline(slot) else {
                continue;
            };
            let tail = old.vertices.get(upto.floor() as usize + 1..).unwrap_or(&[]);
            if last == Some(slot) {
                self.vertices.extend_from_slice(tail);
            } else {
                self.branch(tail);
            }
        }
    }

    /// Keeps a branch of the map as a polyline of its own, unless it is a stub no longer than the gate.
    fn branch(&mut self, vertices: &[Vertex]) {
        let length_m: f64 = vertices.windows(2).map(|w| w[0].point.distance(w[1].point)).sum();
        if length_m > self.settings.gate_m {
            self.branches.push(vertices.to_vec());
        }
    }
}

/// The stretch of the map that a run covers, averaged with the scan.
///
/// Every vertex v of the stretch is averaged with the point of the scan closest to it (the vertex rule, the paper's
/// Fig. 4). A scan point becomes a new vertex, averaged with its closest point of the map, where no vertex is near.
fn merged(old: &[Vertex], run: &Run, number: u32, settings: &MergeSettings) -> Vec<Vertex> {
    let Some((from, to)) = run.reach() else {
        return Vec::new();
    };
    let mut out: Vec<(f64, Vertex)> = Vec::new();
    let mut search = 0;
    for k in from.ceil() as usize..=(to.floor() as usize).min(old.len() - 1) {
        let closest = closest_on_scan(&run.points, &mut search, k as f64, old[k].point);
        let moved = match closest {
            Some((p, hits)) if p.distance(old[k].point) <= settings.gate_m => {
                old[k].averaged(p, hits, settings.most_hits)
            }
            _ => old[k],
        };
        out.push((k as f64, moved));
    }
    let mut last: Option<Point> = None;
    for (p, link) in &run.points {
        let Some(link) = link else { continue };
        let (a, b) = around(old, link);
        let spacing_m = if p.is_vertex {
            0.5 * settings.spacing_m
        } else {
            settings.spacing_m
        };
        let far = |q: Point| q.distance(link.point) >= spacing_m;
        if far(a.point) && far(b.point) && last.is_none_or(far) {
            last = Some(link.point);
            out.push((
                link.at,
                between(a, b, link.point).averaged(p.vertex.point, p.vertex.hits, settings.most_hits),
            ));
        }
    }
    out.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out: Vec<Vertex> = out.into_iter().map(|(_, v)| v).collect();
    // The scan saw every side between two vertices of the stretch.
    let hits = run.points.iter().map(|(p, _)| p.vertex.hits).min().unwrap_or(1);
    let inner = out.len().saturating_sub(1);
    for vertex in &mut out[..inner] {
        vertex.onward.hits += hits;
        vertex.onward.since = vertex.onward.since.min(number);
    }
    out
}

fn around<'a>(old: &'a [Vertex], link: &Link) -> (&'a Vertex, &'a Vertex) {
    let k = (link.at.floor() as usize).min(old.len() - 1);
    (&old[k], &old[(k + 1).min(old.len() - 1)])
}

/// A vertex on the side between two others, resting on as much as the weaker of them.
fn between(a: &Vertex, b: &Vertex, point: Point) -> Vertex {
    let weaker = if a.hits <= b.hits { a } else { b };
    Vertex {
        point,
        onward: a.onward,
        ..*weaker
    }
}

/// The point of the scan closest to map vertex `v` (number `at`), among the sides between the scan points that are
/// linked before and behind it, and the observations it rests on. `search` moves forward from vertex to vertex.
fn closest_on_scan(
    points: &[(ScanPoint, Option<Link>)],
    search: &mut usize,
    at: f64,
    v: Point,
) -> Option<(Point, u32)> {
    while *search + 2 < points.len() && points[*search + 1].1.is_some_and(|l| l.at < at) {
        *search += 1;
    }
    let sides = search.saturating_sub(1)..(*search + 2).min(points.len().saturating_sub(1));
    sides
        .map(|k| {
            let (a, b) = (&points[k].0.vertex, &points[k + 1].0.vertex);
            let side = Segment::new(a.point, b.point);
            (side.at(side.closest_share(v)), a.hits.min(b.hits))
        })
        .min_by(|p, q| p.0.distance(v).total_cmp(&q.0.distance(v)))
}

#[cfg(test)]
mod tests {
    use super::super::link::runs;
    use super::*;

    /// Vertices every 5 cm along straight sides between corners.
    fn drawn(corners: &[(f64, f64)]) -> Vec<ScanPoint> {
        let corner = |k: usize| Point::new(corners[k].0, corners[k].1);
        let sides = (1..corners.len()).map(|k| Segment::new(corner(k - 1), corner(k)));
        sides
            .flat_map(|side| {
                let count = (side.length_m() / 0.05).round() as u32;
                (0..=count).map(move |k| ScanPoint {
                    vertex: Vertex::new(side.at(f64::from(k) / f64::from(count)), 0),
                    direction: side.direction().unwrap(),
                    is_vertex: false,
                })
            })
            .collect()
    }

    #[test]
    fn a_wall_that_is_left_for_another_and_come_back_to_goes_on() {
        let settings = MergeSettings::default();
        let mut map = GrowingMap::default();
        for wall in [[(0.0, 0.0), (6.0, 0.0)], [(2.0, 0.2), (3.0, 0.2)]] {
            map.add(drawn(&wall).iter().map(|p| p.vertex).collect());
        }
        let scan = drawn(&[
            (0.5, 0.0),
            (2.0, 0.0),
            (2.1, 0.2),
            (2.3, 0.2),
            (2.4, 0.0),
            (5.0, 0.0),
        ]);
        let runs = runs(&map, &scan, settings.gate_m);
        assert_eq!(splice(&mut map, &runs, 1, &settings), runs.len());
        let has = |x_m: f64, y_m: f64| {
            let mut vertices = map.polylines().flat_map(|(_, p)| &p.vertices);
            vertices.any(|v| v.point.distance(Point::new(x_m, y_m)) < 0.1)
        };
        let lost: Vec<f64> = (0..60)
            .map(|k| 0.1 * f64::from(k))
            .filter(|&x| !has(x, 0.0))
            .collect();
        assert!(lost.is_empty(), "the wall ends on {lost:?}");
        assert!(has(2.8, 0.2), "and so does the other");
    }
}
