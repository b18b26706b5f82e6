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
pub mod information;

mod correspondence;
mod headings;
mod hypotheses;
mod judge;
mod outline;
mod votes;
mod walls;

use crate::geometry::{Point, Polyline, Pose};
pub use correspondence::Correspondence;
pub use induced::{PiecePair, induced_pose};
pub use information::{Information, PoseGaussian};

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
pub fn correspondences_at(scan: &[Polyline], reference: &[Polyline], reference_from_scan: Pose) -> Vec<Correspondence> {
    let candidates = correspondence::Candidates::at(reference_from_scan, scan, reference);
    candidates.matching(&correspondence::at_hypothesis(reference_from_scan))
}

/// Refines and judges a pose that comes from elsewhere (the last motion going on, odometry), on the same scale as the
/// hypotheses of [`match_polylines`].
#[must_use]
pub fn judged(scan: &[Polyline], reference: &[Polyline], estimate: &PoseGaussian, start: Pose) -> Hypothesis {
    hypotheses::refined_one(start, &judge::Judge::new(scan, reference, *estimate))
}
