//! Groups → polylines as fine as the noise supports.
//!
//! The variance of a range is σ² plus (share of the beam step, in range)²: on a grazing wall a small error of the
//! bearing is a large one of the range.

use std::ops::Range;

use super::divide::divide;
use super::ends::draw_out;
use super::fit::{Line, Sums};
use super::group::Groups;
use super::{Extraction, ScanPolyline};
use crate::geometry::{Point, Polyline};

/// Error of the bearing as a share of the beam step: width of the beam, and quantised angles.
const BEARING_ERROR_STEPS: f64 = 0.1;

/// Polylines of all groups of two returns or more.
pub(super) fn extract(groups: &Groups, step_rad: f64, noise_m: f64, side_penalty: f64) -> Extraction {
    let mut out = Extraction {
        noise_m,
        returns: groups.points.len(),
        ..Extraction::default()
    };
    for group in &groups.groups {
        let points = &groups.points[group.clone()];
        let ranges_m = &groups.ranges_m[group.clone()];
        let polyline = (group.len() >= 2)
            .then(|| polyline(points, ranges_m, step_rad, noise_m, side_penalty))
            .flatten();
        match polyline {
            Some(polyline) => out.polylines.push(ScanPolyline {
                polyline,
                first_beam: groups.beams[group.start],
                last_beam: groups.beams[group.end - 1],
            }),
            None => out.returns_unused += group.len(),
        }
    }
    out
}

/// The polyline of one group.
fn polyline(
    points: &[Point],
    ranges_m: &[f64],
    step_rad: f64,
    noise_m: f64,
    side_penalty: f64,
) -> Option<Polyline> {
    let sums = Sums::new(points.iter().enumerate().map(|(k, &p)| {
        let (r, slope_m) = (ranges_m[k], slope_m(ranges_m, k));
        let bearing_m = BEARING_ERROR_STEPS * slope_m;
        (p, r * r / (noise_m * noise_m + bearing_m * bearing_m))
    }));
    let sides = divide(points.len(), side_penalty, |run| sums.range_cost(run));
    let end = |line: Line, p: Point| end_on_ray(line, p, noise_m);
    let mut vertices = join(points, &sides, |run| sums.range_line(run), end);
    draw_out(&mut vertices, step_rad);
    Polyline::new(vertices).ok()
}

/// Change of range from beam to beam at return `k`: the smaller of the two sides, so that an edge is not a slope.
fn slope_m(ranges_m: &[f64], k: usize) -> f64 {
    let before = k.checked_sub(1).map(|j| (ranges_m[k] - ranges_m[j]).abs());
    let after = ranges_m.get(k + 1).map(|r| (r - ranges_m[k]).abs());
    match (before, after) {
        (Some(a), Some(b)) => a.min(b),
        (a, b) => a.or(b).unwrap_or(0.0),
    }
}

/// Vertices of a chain of sides: ends by `end` (side, its last point), corners where lines meet, both ends of a step.
pub(super) fn join(
    points: &[Point],
    sides: &[Range<usize>],
    line: impl Fn(&Range<usize>) -> Option<Line>,
    end: impl Fn(Line, Point) -> Point,
) -> Vec<Point> {
    let lines: Vec<Option<Line>> = sides
        .iter()
        .map(|run| if run.len() >= 3 { line(run) } else { None })
        .collect();
    let end = |side: usize, at: usize| lines[side].map_or(points[at], |line| end(line, points[at]));
    let mut vertices = vec![end(0, 0)];
    for (k, run) in sides.iter().enumerate() {
        if lines[k].is_none() && run.len() == 2 && k > 0 {
            vertices.push(points[run.start]);
        }
        let last = run.end - 1;
        let Some(next) = sides.get(k + 1) else {
            if sides.len() > 1 || points.len() > 1 {
                vertices.push(end(k, last));
            }
            break;
        };
        let corner = match (lines[k], lines[k + 1]) {
            (Some(a), Some(b)) => corner(a, b, points[last], points[next.start]),
            _ => None,
        };
        match corner {
            Some(p) => vertices.push(p),
            None => {
                vertices.push(end(k, last));
                if lines[k + 1].is_some() {
                    vertices.push(end(k + 1, next.start));
                }
            }
        }
    }
    vertices.dedup_by(|a, b| a.distance(*b) < 1e-9);
    vertices
}

/// The end `p` of a side moved onto its line along the ray; the point itself where the line leads elsewhere.
fn end_on_ray(line: Line, p: Point, noise_m: f64) -> Point {
    line.on_ray_of(p)
        .filter(|q| q.distance(p) <= 6.0 * noise_m + 0.05 * p.norm())
        .unwrap_or(p)
}

/// Where two sides meet, when that is between (or near) the last point of one and the first of the next.
fn corner(a: Line, b: Line, last: Point, first: Point) -> Option<Point> {
    let p = a.cross(b)?;
    let step = first - last;
    let reach_m = step.norm();
    let middle = last.lerp(first, 0.5);
    (p.distance(middle) <= 1.5 * reach_m).then_some(p)
}
