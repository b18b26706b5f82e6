//! Planned chains → polylines: vertices refined, ends drawn out, things in front drawn as sides of their own.

use std::ops::Range;

use super::ends::draw_out;
use super::front::Front;
use super::plan::Chain;
use super::refine::Refine;
use crate::geometry::{Point, Polyline};

/// Half the width of a thing that one beam hit, in beam steps: as wide as the beam, and clear of its neighbours.
const HALF_BEAM: f64 = 0.45;

/// What chains are turned into polylines with.
pub(super) struct Finish<'a> {
    /// All returns, counter-clockwise.
    pub(super) points: &'a [Point],
    /// Things in front of others.
    pub(super) front: &'a Front,
    /// Beam step, radians.
    pub(super) step_rad: f64,
}

/// A polyline with the first and the last of its returns.
pub(super) type Finished = (Polyline, usize, usize);

impl Finish<'_> {
    /// Polylines of the chains and of the things in front of them, counter-clockwise.
    pub(super) fn run(&self, chains: &[Chain]) -> Vec<Finished> {
        let mut out = Vec::new();
        for chain in chains {
            let things: Vec<Range<usize>> = chain
                .things
                .iter()
                .map(|&k| self.front.things[k].clone())
                .collect();
            out.extend(self.chain(&chain.vertices, &things));
            out.extend(things.iter().filter_map(|thing| self.thing(thing)));
        }
        out.sort_by_key(|&(_, first, _)| first);
        out
    }

    /// The polyline with vertices near the returns `at`; returns of things in front do not count.
    fn chain(&self, at: &[usize], things: &[Range<usize>]) -> Option<Finished> {
        let (&first, &last) = (at.first()?, at.last()?);
        let seen: Vec<Point> = (first..=last)
            .filter(|k| !things.iter().any(|thing| thing.contains(k)))
            .map(|k| self.points[k])
            .collect();
        let refine = Refine { points: &seen };
        self.finished(
            refine.run(at.iter().map(|&k| self.points[k]).collect()),
            first,
            last,
        )
    }

    /// One side through a thing in front.
    fn thing(&self, thing: &Range<usize>) -> Option<Finished> {
        let (first, last) = (thing.start, thing.end - 1);
        if first == last {
            let p = self.points[first];
            let half_m = p.left() * (HALF_BEAM * self.step_rad);
            return Some((Polyline::new(vec![p - half_m, p + half_m]).ok()?, first, last));
        }
        let refine = Refine {
            points: &self.points[first..=last],
        };
        self.finished(
            refine.run(vec![self.points[first], self.points[last]]),
            first,
            last,
        )
    }

    fn finished(&self, mut vertices: Vec<Point>, first: usize, last: usize) -> Option<Finished> {
        draw_out(&mut vertices, self.step_rad);
        Some((Polyline::new(vertices).ok()?, first, last))
    }
}
