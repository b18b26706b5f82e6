//! What ties one keyframe to the next, and how firmly.
//!
//! In: how the scan was placed. Out: an edge of the pose graph. It is no firmer than what was known: where the walls leave a
//! direction open, the motion holds it, and where other places came near, the step may have led there.

use crate::align::{Alignment, Information};
use crate::geometry::{Pose, wrap_rad};
use crate::loops::graph::Edge;
use crate::mapper::Step;
use crate::mapper::step::Hypothesis;
use crate::place::PlaceSettings;

/// Poses nearer than this, metres and radians, are the same place.
const SAME_M: f64 = 0.25;
const SAME_RAD: f64 = 0.07;
/// A place that leads the others by less is doubtful.
const CLEAR_LEAD: f64 = 0.25;

/// Whether other places came near when a scan was placed: where the predicted pose settled it, none was looked at.
pub(super) fn is_doubtful(step: &Step) -> bool {
    let is_settled = step.alignment.is_some() && step.hypotheses.len() == 1;
    !is_settled && step.lead.is_none_or(|lead| lead < CLEAR_LEAD)
}

/// The edge between two keyframes in a row. Where the walls leave a direction open, the motion model holds it: without,
/// a closed loop would pull a corridor out like a drawer at the one keyframe that saw least.
pub(super) fn edge_to_next(from: usize, last: Pose, pose: Pose, alignment: Option<&Alignment>) -> Edge {
    let motion = last.inverse() * pose;
    let walls = alignment.map_or_else(Information::default, |a| a.information.turned(-last.theta_rad));
    let sigma_m = 0.03 + 0.2 * motion.translation().norm();
    let sigma_rad = 0.03 + 0.2 * motion.theta_rad.abs();
    let kept_going = Information::from_sigmas(sigma_m, sigma_m, sigma_rad);
    Edge {
        from,
        to: from + 1,
        motion,
        information: loosened(&walls).plus(&kept_going),
        is_loop: false,
    }
}

/// An edge as firm as it is when other places came near: its covariance is that of all places that were looked at, each weighed
/// by how likely it was against the one taken. A place in a corridor that won by a hair is then moved by what is seen later, and
/// places seen before are looked for as far off as it may be.
pub(super) fn doubted(edge: Edge, last: Pose, pose: Pose, step: &Step, settings: &PlaceSettings) -> Edge {
    let is_same = |h: &Hypothesis, place: Pose| h.map_from_scan.is_within(SAME_M, SAME_RAD, place);
    let Some(taken) = step.hypotheses.iter().find(|h| is_same(h, pose)) else {
        return edge;
    };
    let mut others: Vec<&Hypothesis> = Vec::new();
    for h in &step.hypotheses {
        if !is_same(h, pose) && !others.iter().any(|o| is_same(h, o.map_from_scan)) {
            others.push(h);
        }
    }
    // The one taken may have been second, and have explained the scans since better.
    let likelihood = |h: &Hypothesis| {
        let nats = (h.merit - taken.merit) / settings.merit_per_nat;
        nats.min(0.0).exp()
    };
    let sum = 1.0 + others.iter().map(|h| likelihood(h)).sum::<f64>();
    let information = others.into_iter().fold(edge.information, |information, other| {
        let there = other.map_from_scan;
        let way = last.inverse().rotate(there.translation() - pose.translation());
        let turn_rad = wrap_rad(there.theta_rad - pose.theta_rad);
        information.with_noise_along([way.x, way.y, turn_rad], (likelihood(other) / sum).sqrt())
    });
    Edge { information, ..edge }
}

/// What the walls say is more than they know: the map they are compared with has errors of its own. Standard
/// deviations of 5 mm and 0.1° are added.
pub(super) fn loosened(information: &Information) -> Information {
    information.with_noise(0.005, 0.002)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extract::Extraction;
    use crate::mapper::NotPlaced;
    use crate::place::{Agreement, Origin};
    use std::sync::Arc;

    /// A step of 1 m along x, the walls sure of it, when places so far on and so good came near as well.
    fn edge_with(others: &[(f64, f64)]) -> Edge {
        let reason = NotPlaced::SeparateSubmap;
        let mut step = Step::new(1, Arc::new(Extraction::default()), reason);
        let hypothesis = |&(x, merit): &(f64, f64)| Hypothesis {
            origin: Origin::Search,
            map_from_scan: Pose::new(x, 0.0, 0.0),
            agreement: Agreement::default(),
            merit,
        };
        step.hypotheses = std::iter::once(&(1.0, 0.8))
            .chain(others)
            .map(hypothesis)
            .collect();
        let (last, pose) = (Pose::IDENTITY, Pose::new(1.0, 0.0, 0.0));
        let edge = Edge {
            information: Information::from_sigmas(0.01, 0.01, 0.01),
            ..edge_to_next(0, last, pose, None)
        };
        doubted(edge, last, pose, &step, &PlaceSettings::default())
    }

    fn sigmas_m(edge: &Edge) -> (f64, f64) {
        let covariance = edge.information.covariance().unwrap();
        (covariance[0][0].sqrt(), covariance[1][1].sqrt())
    }

    #[test]
    fn a_step_that_won_by_a_hair_is_loose_towards_the_other_place() {
        let (along_m, across_m) = sigmas_m(&edge_with(&[(2.0, 0.8)]));
        assert!((along_m - 0.5_f64.sqrt()).abs() < 0.01, "{along_m}");
        assert!((across_m - 0.01).abs() < 1e-9, "{across_m}");
    }

    #[test]
    fn places_that_are_much_worse_or_the_same_do_not_loosen_it() {
        let (along_m, _) = sigmas_m(&edge_with(&[(2.0, 0.3), (1.1, 0.8)]));
        assert!((along_m - 0.01).abs() < 1e-5, "{along_m}");
    }
}
