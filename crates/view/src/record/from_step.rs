//! From the core's [`Step`] to the lines of a record: the only place that knows both.

use polymapper_core::align::Alignment;
use polymapper_core::extract::ScanPolyline;
use polymapper_core::geometry::{Pose, wrap_rad};
use polymapper_core::mapper::{Hypothesis, NotPlaced, Outcome, Step};
use polymapper_core::matching::Correspondence;
use polymapper_core::scan::Scan;

use super::points::millimetres;
use super::{Chain, Detail, Frame, HypothesisRecord, PairRecord, Search, Walls, chain, pose_record, rounded};

/// Standard deviations beyond this say no more than "open", metres.
const WIDEST_M: f64 = 9.0;
/// Poses that are kept of a search; those behind them had no chance.
const MOST_HYPOTHESES: usize = 12;
/// Poses nearer to each other are the same one: a step of the alignment away, metres and radians.
const SAME_M: f64 = 0.05;
const SAME_RAD: f64 = 0.02;

/// The light part. `scan_index` is the place in the log.
pub fn frame(step: &Step, scan_index: usize, stamp_s: Option<f64>) -> Frame {
    let (pose, reason) = match step.outcome {
        Outcome::Placed { map_from_scan } => (Some(pose_record(map_from_scan)), None),
        Outcome::NotPlaced { reason } => (None, Some(words(reason).to_owned())),
    };
    let (alignment, agreement) = (step.alignment.as_ref(), step.agreement.as_ref());
    let share = |part: usize, of: usize| rounded(part as f64 / of.max(1) as f64, 1e3);
    Frame {
        scan: scan_index,
        stamp_s: stamp_s.map(|s| rounded(s, 1e3)),
        pose,
        reason,
        returns: step.extraction.returns,
        fit: agreement.map(|a| rounded(a.fit(), 1e3)),
        known: agreement.map(|a| rounded(a.known_share(), 1e3)),
        through: agreement.map(|a| share(a.through, a.beams)),
        matched: alignment.map(|a| rounded(a.matched_share(), 1e3)),
        rms_mm: alignment.map(|a| rounded(a.rms_m * 1e3, 10.0)),
        ellipse: alignment.and_then(ellipse),
        open_rad: alignment
            .and_then(|a| a.unobservable)
            .map(|d| rounded(d.y.atan2(d.x), 1e3)),
        lead: step.lead.map(|l| rounded(l, 1e3)),
        merged: step.merged.is_some(),
        searched: step.matching.is_some(),
        recognised: step.recognised,
    }
}

/// Axes of the ellipse of one standard deviation of the place; `None` where the walls leave a direction open.
fn ellipse(alignment: &Alignment) -> Option<[f64; 3]> {
    let c = alignment.information.covariance()?;
    let half = 0.5 * (c[0][0] + c[1][1]);
    let spread = (0.25 * (c[0][0] - c[1][1]).powi(2) + c[0][1] * c[0][1]).sqrt();
    let sigma_m = |variance: f64| variance.max(0.0).sqrt().min(WIDEST_M);
    let along_rad = 0.5 * (2.0 * c[0][1]).atan2(c[0][0] - c[1][1]);
    Some([
        rounded(sigma_m(half + spread), 1e4),
        rounded(sigma_m(half - spread), 1e4),
        rounded(along_rad, 1e2),
    ])
}

/// The polylines of a merged scan; `None` for others.
pub fn walls(step: &Step) -> Option<Walls> {
    step.merged.as_ref().map(|_| Walls {
        n: step.scan,
        polylines: chains(&step.extraction.polylines),
        moving: step.moving.clone(),
    })
}

/// The heavy part. `last` is the number and pose of the scan placed before.
pub fn detail(step: &Step, scan: &Scan, last: Option<(usize, Pose)>) -> Detail {
    let geometry = scan.geometry();
    Detail {
        n: step.scan,
        bearings_rad: [
            rounded(geometry.bearing_rad(0), 1e7),
            rounded(geometry.step_rad(), 1e9),
        ],
        returns: returns(scan),
        polylines: chains(&step.extraction.polylines),
        moving: step.moving.clone(),
        search: search(step, last),
    }
}

/// How the place was searched; `None` when it was not.
fn search(step: &Step, last: Option<(usize, Pose)>) -> Option<Search> {
    let matching = step.matching.as_ref()?;
    let (last, map_from_last) = last?;
    let pair = |c: &Correspondence| PairRecord {
        scan: c.scan.clone(),
        reference: c.reference.clone(),
        cost_rad2: rounded(c.shape_cost_rad2, 1e4),
    };
    Some(Search {
        last,
        virtual_scan: step
            .virtual_scan
            .iter()
            .flatten()
            .map(|p| chain(p.vertices().iter().copied()))
            .collect(),
        hypotheses: hypotheses(step, map_from_last),
        pairs: matching.correspondences.iter().map(pair).collect(),
    })
}

/// The best of the poses that were looked at. Several guesses lead to the same place; the best of them stands for all.
fn hypotheses(step: &Step, map_from_last: Pose) -> Vec<HypothesisRecord> {
    let last_from_map = map_from_last.inverse();
    let record = |h: &Hypothesis| HypothesisRecord {
        pose: pose_record(last_from_map * h.map_from_scan),
        score: rounded(h.merit, 1e3),
        fit: rounded(h.agreement.fit(), 1e3),
        through: rounded(h.agreement.through as f64 / h.agreement.beams.max(1) as f64, 1e3),
    };
    different(&step.hypotheses, MOST_HYPOTHESES)
        .into_iter()
        .map(record)
        .collect()
}

/// The first `most` that are not the same pose as one before.
fn different(all: &[Hypothesis], most: usize) -> Vec<&Hypothesis> {
    let mut kept: Vec<&Hypothesis> = Vec::new();
    for next in all {
        let pose = next.map_from_scan;
        let is_known = kept.iter().any(|k| {
            k.map_from_scan.distance(pose) < SAME_M
                && wrap_rad(k.map_from_scan.theta_rad - pose.theta_rad).abs() < SAME_RAD
        });
        if !is_known {
            kept.push(next);
        }
        if kept.len() == most {
            break;
        }
    }
    kept
}

fn chains(polylines: &[ScanPolyline]) -> Vec<Chain> {
    polylines
        .iter()
        .map(|p| chain(p.polyline.vertices().iter().copied()))
        .collect()
}

fn returns(scan: &Scan) -> Vec<Vec<i64>> {
    let mut runs: Vec<Vec<i64>> = Vec::new();
    let mut last: Option<(usize, i64)> = None;
    for (beam, range_m) in scan.ranges_m().iter().enumerate() {
        if !range_m.is_finite() {
            continue;
        }
        let now = millimetres(*range_m);
        match (last, runs.last_mut()) {
            (Some((before, range)), Some(run)) if before + 1 == beam => run.push(now - range),
            _ => runs.push(vec![beam as i64, now]),
        }
        last = Some((beam, now));
    }
    runs
}

fn words(reason: NotPlaced) -> &'static str {
    match reason {
        NotPlaced::TooFewReturns => "too few returns on polylines",
        NotPlaced::SeparateSubmap => "in a map of its own, not recognised in the main one yet",
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use polymapper_core::mapper::Origin;
    use polymapper_core::place::Agreement;
    use polymapper_core::scan::ScanGeometry;

    use super::*;

    #[test]
    fn poses_that_are_the_same_are_told_once() {
        let at = |x, theta_rad, merit| Hypothesis {
            origin: Origin::Shape,
            map_from_scan: Pose::new(x, 0.0, theta_rad),
            agreement: Agreement::default(),
            merit,
        };
        let all = [
            at(0.0, PI - 0.001, 0.9),
            at(0.01, 0.001 - PI, 0.8),
            at(0.0, 3.0, 0.7),
            at(1.0, 3.1, 0.6),
            at(1.02, 3.1, 0.5),
            at(2.0, 3.1, 0.4),
        ];
        let merits = |most| -> Vec<f64> { different(&all, most).iter().map(|h| h.merit).collect() };
        assert_eq!(merits(9), [0.9, 0.7, 0.6, 0.4]);
        assert_eq!(merits(2), [0.9, 0.7]);
    }

    #[test]
    fn runs_of_returns_break_where_nothing_returned() {
        let geometry = ScanGeometry::new(0.0, 0.1, 5).unwrap();
        let scan = Scan::new(geometry, vec![1.0, 1.002, f64::NAN, 3.0, 2.5]).unwrap();
        assert_eq!(returns(&scan), [vec![0, 1000, 2], vec![3, 3000, -500]]);
    }
}
