//! Matching of two sets of polylines without knowing where the scanner went (paper section 3.3).
//!
//! In: the polylines of a scan, those of the reference (the last scan, or the part of the map it was merged into,
//! in the frame of the last pose), and an estimate of `reference_from_scan`, by default "has not moved" with a
//! wide covariance. Out: correspondences, and poses `reference_from_scan` ranked by how well they explain both.
//!
//! The steps:
//! 1. similarity of every polyline with every other, groups included ([`crate::shape`]);
//! 2. headings at which walls run alike, from correlated direction histograms;
//! 3. for each heading a dynamic programming over the cyclic vectors ([`cyclic`]) with the alignment that each pair
//!    induces ([`induced`]), and votes of pairs of walls for the place;
//! 4. poses on which correspondences or votes agree are refined and judged by fit and two-way visibility;
//! 5. the correspondences that belong to the best pose.
//!
//! The paper stops at one matching around one estimate. We keep several poses, because corridors and orthogonal
//! rooms have several that a single pair of scans cannot tell apart, and one wrong step ruins a map.

pub mod cyclic;
pub mod induced;

mod correspondence;
mod gaussian;
mod headings;
mod hypotheses;
mod judge;
mod outline;
mod votes;
mod walls;

use crate::align::Information;
use crate::geometry::{Point, Polyline, Pose};
pub use correspondence::Correspondence;
pub use gaussian::PoseGaussian;
pub use induced::{PiecePair, induced_pose};

/// A pose and what speaks for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Where the scan lies in the reference.
    pub reference_from_scan: Pose,
    /// How well the walls fix it: errors of (x, y, theta) in the frame of the reference.
    pub information: Information,
    /// Share of the scan's wall that lies on walls of the reference, 0..=1.
    pub explained_ratio: f64,
    /// Share of the walls of both that the other looked through, 0..=1.
    pub contradicted_ratio: f64,
    /// What hypotheses are ranked by; higher is better. Only differences within one matching mean something.
    pub score: f64,
    /// Unit vector along which the walls do not fix the place (a corridor), in the frame of the reference.
    pub unobservable: Option<Point>,
}

/// What matching two sets of polylines gives.
#[derive(Clone, Debug, Default)]
pub struct Matching {
    /// Which polylines belong together, in the scan's order, at the best hypothesis.
    pub correspondences: Vec<Correspondence>,
    /// Poses at least 0.25 m or 5° apart, best first, 12 at most; none if there is nothing to match.
    pub hypotheses: Vec<Hypothesis>,
}

/// The estimate when nothing is known: "has not moved" (paper section 3.3), give or take 1.5 m and 45°.
///
/// Two scans further apart than that see too little in common to be matched by shape.
#[must_use]
pub fn unmoved() -> PoseGaussian {
    PoseGaussian {
        mean: Pose::IDENTITY,
        information: Information::from_sigmas(1.5, 1.5, std::f64::consts::FRAC_PI_4),
    }
}

/// Matches the polylines of a scan to those of a reference.
///
/// Both run with free space on their left and are in cyclic order around the origin of their frame, from where they
/// are taken to be seen.
#[must_use]
pub fn match_polylines(scan: &[Polyline], reference: &[Polyline], estimate: &PoseGaussian) -> Matching {
    let judge = judge::Judge::new(scan, reference, *estimate);
    let candidates = correspondence::Candidates::anywhere(scan, reference, estimate.mean);
    let hypotheses = hypotheses::ranked(scan, estimate, &candidates, &judge);
    let correspondences = match hypotheses.first() {
        Some(best) => correspondences_at(scan, reference, best.reference_from_scan),
        None => Vec::new(),
    };
    Matching {
        correspondences,
        hypotheses,
    }
}

/// Which polylines belong together if the scan lies at a pose: the matching of [`cyclic`] among polylines that lie together,
/// with induced poses that agree with it.
#[must_use]
pub fn correspondences_at(
    scan: &[Polyline],
    reference: &[Polyline],
    reference_from_scan: Pose,
) -> Vec<Correspondence> {
    let candidates = correspondence::Candidates::at(reference_from_scan, scan, reference);
    candidates.matching(&correspondence::at_hypothesis(reference_from_scan))
}

/// Refines and judges a pose that comes from elsewhere (the last motion going on, odometry), on the same scale as the
/// hypotheses of [`match_polylines`].
#[must_use]
pub fn judged(scan: &[Polyline], reference: &[Polyline], estimate: &PoseGaussian, start: Pose) -> Hypothesis {
    hypotheses::refined_one(start, &judge::Judge::new(scan, reference, *estimate))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::wrap_rad;

    fn polyline(points: &[(f64, f64)]) -> Polyline {
        Polyline::new(points.iter().map(|&(x, y)| Point::new(x, y)).collect()).unwrap()
    }

    fn seen_from(world: &[Polyline], reference_from_scan: Pose) -> Vec<Polyline> {
        world
            .iter()
            .map(|p| p.transformed(reference_from_scan.inverse()))
            .collect()
    }

    /// A room with a cupboard and a door to the right; the scanner stands at the origin.
    fn room() -> Vec<Polyline> {
        vec![
            polyline(&[(-2.0, -3.0), (0.5, -3.0)]),
            polyline(&[(1.5, -3.0), (4.0, -3.0), (4.0, 1.0)]),
            polyline(&[
                (4.0, 1.2),
                (4.0, 2.5),
                (1.0, 2.5),
                (1.0, 2.0),
                (-0.5, 2.0),
                (-0.5, 2.5),
                (-2.0, 2.5),
            ]),
        ]
    }

    fn is_near(pose: Pose, truth: Pose) -> bool {
        pose.distance(truth) < 0.05 && wrap_rad(pose.theta_rad - truth.theta_rad).abs() < 0.02
    }

    #[test]
    fn a_metre_and_a_large_turn_are_found_without_odometry() {
        for (x, y, turn_deg) in [
            (1.0, 0.2, 20.0_f64),
            (-0.6, 0.8, -50.0),
            (0.7, -0.9, 80.0),
            (0.0, 0.0, -80.0),
        ] {
            let truth = Pose::new(x, y, turn_deg.to_radians());
            let matching = match_polylines(&seen_from(&room(), truth), &room(), &unmoved());
            let best = &matching.hypotheses[0];
            assert!(is_near(best.reference_from_scan, truth), "{truth:?}: {best:?}");
            assert!(best.unobservable.is_none() && best.explained_ratio > 0.95);
            let pairs: Vec<_> = matching
                .correspondences
                .iter()
                .map(|c| (c.scan.clone(), c.reference.clone()))
                .collect();
            assert_eq!(
                pairs,
                [(vec![0], vec![0]), (vec![1], vec![1]), (vec![2], vec![2])]
            );
        }
    }

    #[test]
    fn a_wall_cut_in_two_is_matched_as_one() {
        let truth = Pose::new(0.5, 0.3, 0.4);
        let mut cut = room();
        cut[1] = polyline(&[(1.5, -3.0), (4.0, -3.0), (4.0, -1.5)]);
        cut.insert(2, polyline(&[(4.0, -1.2), (4.0, 1.0)]));
        let matching = match_polylines(&seen_from(&cut, truth), &room(), &unmoved());
        assert!(is_near(matching.hypotheses[0].reference_from_scan, truth));
        let of_wall: Vec<usize> = matching
            .correspondences
            .iter()
            .filter(|c| c.reference == [1])
            .flat_map(|c| c.scan.clone())
            .collect();
        assert_eq!(of_wall, [1, 2], "both pieces belong to the wall");
    }

    #[test]
    fn a_corridor_tells_nothing_along_itself_and_says_so() {
        let corridor = [
            polyline(&[(-6.0, -1.0), (6.0, -1.0)]),
            polyline(&[(6.0, 1.0), (-6.0, 1.0)]),
        ];
        let truth = Pose::new(0.8, 0.3, 0.35);
        let matching = match_polylines(&seen_from(&corridor, truth), &corridor, &unmoved());
        let best = &matching.hypotheses[0];
        let along = best.unobservable.unwrap();
        assert!(along.y.abs() < 0.01, "{along:?}");
        assert!((best.reference_from_scan.y - truth.y).abs() < 0.02);
        assert!((best.reference_from_scan.theta_rad - truth.theta_rad).abs() < 0.01);
    }

    #[test]
    fn a_room_without_a_mark_leaves_its_other_heading_among_the_hypotheses() {
        let hall = [polyline(&[
            (3.0, -2.0),
            (3.0, 2.0),
            (-3.0, 2.0),
            (-3.0, -2.0),
            (2.9, -2.0),
        ])];
        let truth = Pose::new(0.4, 0.1, 1.5);
        let matching = match_polylines(&seen_from(&hall, truth), &hall, &unmoved());
        let twin = Pose::new(0.0, 0.0, std::f64::consts::PI) * truth;
        let has = |pose| {
            matching
                .hypotheses
                .iter()
                .any(|h| is_near(h.reference_from_scan, pose))
        };
        assert!(has(truth) && has(twin), "{:?}", matching.hypotheses);
    }

    #[test]
    fn the_estimate_decides_where_shape_cannot() {
        let hall = [polyline(&[
            (3.0, -2.0),
            (3.0, 2.0),
            (-3.0, 2.0),
            (-3.0, -2.0),
            (2.9, -2.0),
        ])];
        for turn_rad in [0.3, 0.3 + std::f64::consts::PI] {
            let truth = Pose::new(0.4, 0.1, turn_rad);
            let estimate = PoseGaussian {
                mean: Pose::new(0.0, 0.0, turn_rad + 0.2),
                information: Information::from_sigmas(1.0, 1.0, 0.5),
            };
            let matching = match_polylines(&seen_from(&hall, truth), &hall, &estimate);
            assert!(
                is_near(matching.hypotheses[0].reference_from_scan, truth),
                "{turn_rad}"
            );
        }
    }

    #[test]
    fn a_place_far_off_is_found_when_the_estimate_allows_it() {
        let truth = Pose::new(7.0, -5.0, 2.5);
        let anywhere = PoseGaussian {
            mean: Pose::IDENTITY,
            information: Information::from_sigmas(5.0, 5.0, f64::INFINITY),
        };
        let matching = match_polylines(&seen_from(&room(), truth), &room(), &anywhere);
        assert!(
            is_near(matching.hypotheses[0].reference_from_scan, truth),
            "{:?}",
            matching.hypotheses[0]
        );
    }

    #[test]
    fn nothing_to_match_gives_nothing() {
        for (scan, reference) in [(vec![], room()), (room(), vec![]), (vec![], vec![])] {
            let matching = match_polylines(&scan, &reference, &unmoved());
            assert!(matching.hypotheses.is_empty() && matching.correspondences.is_empty());
        }
        let dot = vec![polyline(&[(1.0, 1.0), (1.0, 1.0)])];
        assert!(match_polylines(&dot, &dot, &unmoved()).hypotheses.is_empty());
    }
}
