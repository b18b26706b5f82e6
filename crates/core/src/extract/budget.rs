//! Polylines under a vertex budget.
//!
//! 1. The heap of the discrete curve evolution thins the whole scan out to a moderate number of candidates, by the
//!    likelihood of the scan: the cost of a vertex is what its removal adds to the squared range residuals (Schaefer et al., IROS 2018).
//! 2. [`Plan`] chooses the best vertices among them for the whole scan at once.
//! 3. [`Refine`] moves the vertices.

use super::ends::draw_out;
use super::evolve::{Stop, evolve_by};
use super::fit::Sums;
use super::front::Front;
use super::group::Groups;
use super::plan::{Chain, Plan};
use super::refine::Refine;
use super::{Extraction, ScanPolyline};
use crate::geometry::{Point, Polyline};
use crate::scan::ScanGeometry;

/// A return that no polyline explains counts like a residual of this many metres. Without a cost, leaving out is always best;
/// with a large one, walls are bent to reach stray returns.
const UNUSED_M: f64 = 0.35;

/// A beam without a return that a side crosses counts like a residual of this many metres: there is free space or glass.
const CROSSED_M: f64 = 0.7;

/// With this many holes per beam the scanner loses beams at random, and they mean nothing.
const DROPOUT_SHARE: f64 = 0.05;

/// Candidates for vertices: so many, and so many times the budget.
const CANDIDATES: (usize, usize) = (40, 2);

/// Polylines with at most `vertices` vertices together.
pub(super) fn extract(groups: Groups, geometry: &ScanGeometry, noise_m: f64, vertices: usize) -> Extraction {
    let mut out = Extraction {
        noise_m,
        returns: groups.points.len(),
        ..Extraction::default()
    };
    let work = Work::new(groups, geometry);
    let mut explained = vec![false; out.returns];
    for (polyline, first, last) in work.polylines(vertices) {
        explained[first..=last].fill(true);
        out.polylines.push(ScanPolyline {
            polyline,
            first_beam: work.groups.beams[first],
            last_beam: work.groups.beams[last],
        });
    }
    out.returns_unused = explained.iter().filter(|&&e| !e).count();
    out
}

/// The returns of a scan, ready for planning.
struct Work {
    groups: Groups,
    sums: Sums,
    front: Front,
    step_rad: f64,
    bearings_rad: Vec<f64>,
    crossing_m2: Vec<f64>,
    breaks: Vec<bool>,
}

impl Work {
    fn new(groups: Groups, geometry: &ScanGeometry) -> Self {
        let sums = Sums::new(groups.points.iter().map(|&p| (p, p.dot(p))));
        let front = Front::new(&groups.points, &sums);
        let beams = &groups.beams;
        let mut bearings_rad: Vec<f64> = Vec::with_capacity(beams.len());
        let mut crossing_m2 = vec![0.0; beams.len()];
        for &beam in beams {
            let turn = if beam < beams[0] {
                std::f64::consts::TAU
            } else {
                0.0
            };
            bearings_rad.push(geometry.bearing_rad(beam) + turn);
        }
        let mut breaks = vec![false; beams.len()];
        for group in &groups.groups {
            breaks[group.start] = true;
        }
        let missing =
            |k: usize| ((bearings_rad[k] - bearings_rad[k - 1]) / geometry.step_rad()).round() - 1.0;
        let holes = (1..beams.len()).filter(|&k| missing(k) > 0.5).count();
        let meaning = (1.0 - holes as f64 / (DROPOUT_SHARE * geometry.beams() as f64)).max(0.0);
        for k in 1..beams.len() {
            crossing_m2[k] = crossing_m2[k - 1] + missing(k) * meaning * CROSSED_M * CROSSED_M;
        }
        Self {
            step_rad: geometry.step_rad(),
            groups,
            sums,
            front,
            bearings_rad,
            crossing_m2,
            breaks,
        }
    }

    /// Polylines with the first and last return of each.
    fn polylines(&self, vertices: usize) -> Vec<(Polyline, usize, usize)> {
        let points = &self.groups.points;
        if points.len() < 2 {
            return Vec::new();
        }
        let candidates = self.candidates(CANDIDATES.0 + CANDIDATES.1 * vertices);
        let plan = Plan {
            points,
            sums: &self.sums,
            front: &self.front,
            bearings_rad: &self.bearings_rad,
            candidates: &candidates,
            breaks: &self.breaks,
            unused_m2: UNUSED_M * UNUSED_M,
            crossing_m2: &self.crossing_m2,
        };
        self.finish(&plan.solve(vertices))
    }

    /// The returns whose removal as vertices would cost most; those beside a hole that means something always stay.
    fn candidates(&self, count: usize) -> Vec<usize> {
        let points = &self.groups.points;
        let cost = |a: usize, b: usize| self.sums.chord_cost(points[a], points[b], &(a + 1..b));
        let kept = evolve_by(points.len(), Stop::AtVertices(count), |u, v, w| {
            cost(u, w) - cost(u, v) - cost(v, w)
        });
        let mut candidate = vec![false; points.len()];
        for k in kept {
            candidate[k] = true;
        }
        for k in 1..points.len() {
            let hole = self.crossing_m2[k] > self.crossing_m2[k - 1];
            candidate[k - 1] |= hole;
            candidate[k] |= hole;
        }
        (0..points.len()).filter(|&k| candidate[k]).collect()
    }

    /// Refined polylines of the chains and of the things in front of them.
    fn finish(&self, chains: &[Chain]) -> Vec<(Polyline, usize, usize)> {
        let mut out = Vec::new();
        for chain in chains {
            out.extend(self.polyline(chain));
            for &thing in &chain.things {
                let thing = &self.front.things[thing];
                out.extend(self.thing(thing.start, thing.end - 1));
            }
        }
        out.sort_by_key(|&(_, first, _)| first);
        out
    }

    fn polyline(&self, chain: &Chain) -> Option<(Polyline, usize, usize)> {
        let points = &self.groups.points;
        let (&first, &last) = (chain.vertices.first()?, chain.vertices.last()?);
        let mut hidden = vec![false; last + 1 - first];
        for &thing in &chain.things {
            let thing = &self.front.things[thing];
            hidden[thing.start - first..thing.end - first].fill(true);
        }
        let seen: Vec<Point> = (first..=last)
            .filter(|k| !hidden[k - first])
            .map(|k| points[k])
            .collect();
        let refine = Refine { points: &seen };
        let mut vertices = refine.run(chain.vertices.iter().map(|&k| points[k]).collect());
        draw_out(&mut vertices, self.step_rad);
        Some((Polyline::new(vertices).ok()?, first, last))
    }

    /// One side through a thing in front; a thing of one return is drawn as wide as its beam.
    fn thing(&self, first: usize, last: usize) -> Option<(Polyline, usize, usize)> {
        let points = &self.groups.points;
        let vertices = if first == last {
            let half_m = points[first].left() * (0.45 * self.step_rad);
            vec![points[first] - half_m, points[first] + half_m]
        } else {
            let refine = Refine {
                points: &points[first..=last],
            };
            let mut vertices = refine.run(vec![points[first], points[last]]);
            draw_out(&mut vertices, self.step_rad);
            vertices
        };
        Some((Polyline::new(vertices).ok()?, first, last))
    }
}
