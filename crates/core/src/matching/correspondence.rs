//! Which polylines belong together: costs of all pairs of groups, and the matching around an estimate.

use super::cyclic::{Group, GroupCosts, GroupPair, LONGEST_GROUP, cyclic_matching};
use super::gaussian::PoseGaussian;
use super::induced::{PiecePair, induced_pose, piece_pairs};
use crate::align::Information;
use crate::geometry::{Point, Polyline, Pose};
use crate::shape::{PartPair, Shape, similarity};

/// Penalty C for a polyline that stays unmatched, rad². Half of the 95 % quantile of S of true pairs (0.038 to 0.042 in
/// four buildings, see the example `shape_quantiles`): so 95 % of true pairs cost less than leaving both unmatched. S alone
/// does not tell true from false pairs (medians 0.015 to 0.025 and 0.025 to 0.029): most polylines are pieces of wall, and the
/// alignment term has to decide.
const PENALTY_RAD2: f64 = 0.02;
/// A single polyline shorter than this share of a group (with its bridges) cannot be the same object; it is tried
/// against the members one by one.
const LEAST_OF_GROUP: f64 = 0.5;
/// Polylines compared to find poses, the longest. The paper met about 10 a scan; cluttered scans have 60, most
/// of them shorter than a hand, and time grows with the square.
const COMPARED: usize = 16;
/// Polylines further apart than this at a known pose do not belong together, metres.
const TOGETHER_M: f64 = 0.5;
/// Squared Mahalanobis distance at which the alignment of a 1-1 pair alone costs as much as leaving both unmatched:
/// 99 % of true pairs lie below (χ² of 3 degrees of freedom).
const FARTHEST_MAHALANOBIS2: f64 = 11.34;
/// Polylines with a wider gap between them are not tried as one object, metres: a person or a pillar in front of a
/// wall hides less.
const WIDEST_GAP_M: f64 = 1.0;

/// Polylines of the scan and of the reference that belong together; one of the two groups is a single polyline.
#[derive(Clone, Debug, PartialEq)]
pub struct Correspondence {
    /// Indices of the scan's polylines, in order.
    pub scan: Vec<usize>,
    /// Indices of the reference's polylines, in order.
    pub reference: Vec<usize>,
    /// Which parts lie on which (`c`: scan, `d`: reference), by arc length. Along a group arc length runs on from one
    /// polyline to the next, over a straight bridge between them.
    pub parts: Vec<PartPair>,
    /// The straight pieces that lie on each other, each in its own frame.
    pub pieces: Vec<PiecePair>,
    /// S, rad².
    pub shape_cost_rad2: f64,
    /// Cost of the difference between induced and estimated pose, on the scale of S.
    pub alignment_cost_rad2: f64,
    /// `reference_from_scan` as these polylines alone give it.
    pub induced: PoseGaussian,
}

/// The estimate for the matching that belongs to a hypothesis: what refinement leaves open.
pub(super) fn at_hypothesis(reference_from_scan: Pose) -> PoseGaussian {
    PoseGaussian {
        mean: reference_from_scan,
        information: Information::from_sigmas(0.1, 0.1, 0.05),
    }
}

/// All pairs of groups that are alike in shape, whatever the pose.
pub(super) struct Candidates {
    scan: usize,
    reference: usize,
    all: Vec<(Group, Group, Correspondence)>,
}

impl Candidates {
    /// Compares the longest polylines, whatever their places. `near` is where induced poses stay along what
    /// they leave open.
    pub fn anywhere(scan: &[Polyline], reference: &[Polyline], near: Pose) -> Self {
        Self::new(&longest(scan), &longest(reference), near, |_, _| true)
    }

    /// Compares all polylines that lie together at a pose.
    pub fn at(reference_from_scan: Pose, scan: &[Polyline], reference: &[Polyline]) -> Self {
        let moved: Vec<Polyline> = scan.iter().map(|p| p.transformed(reference_from_scan)).collect();
        let together: Vec<bool> = moved
            .iter()
            .flat_map(|s| reference.iter().map(|r| lie_together(s, r)))
            .collect();
        Self::new(scan, reference, reference_from_scan, |s, r| {
            together[s * reference.len() + r]
        })
    }

    /// Compares polylines and groups all of whose pairs `may_pair` allows.
    fn new(
        scan: &[Polyline],
        reference: &[Polyline],
        near: Pose,
        may_pair: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let mut candidates = Self {
            scan: scan.len(),
            reference: reference.len(),
            all: Vec::new(),
        };
        let (scans, references) = (groups(scan, false), groups(reference, true));
        for one in &scans {
            for other in &references {
                let allowed = |s: usize| other.0.indices(reference.len()).all(|r| may_pair(s, r));
                if may_be_one_object(one, other) && one.0.indices(scan.len()).all(allowed) {
                    candidates.compare(one, other, near);
                }
            }
        }
        candidates
    }

    fn compare(
        &mut self,
        (scan, scan_shape): &(Group, Shape),
        (reference, shape): &(Group, Shape),
        near: Pose,
    ) {
        let limit_rad2 = PENALTY_RAD2 * (scan.len + reference.len) as f64;
        let Some(found) = similarity(scan_shape, shape, limit_rad2) else {
            return;
        };
        let pieces = piece_pairs(scan_shape, shape, &found.pairs);
        if let Some(induced) = induced_pose(&pieces, near) {
            let correspondence = Correspondence {
                scan: scan.indices(self.scan).collect(),
                reference: reference.indices(self.reference).collect(),
                parts: found.pairs,
                pieces,
                shape_cost_rad2: found.cost_rad2,
                alignment_cost_rad2: 0.0,
                induced,
            };
            self.all.push((*scan, *reference, correspondence));
        }
    }

    /// The best matching whose induced poses agree with an estimate.
    pub fn matching(&self, estimate: &PoseGaussian) -> Vec<Correspondence> {
        let mut costs = GroupCosts::new(self.scan, self.reference);
        for (scan, reference, c) in &self.all {
            let alignment = alignment_cost_rad2(&c.induced, estimate);
            let limit_rad2 = PENALTY_RAD2 * (scan.len + reference.len) as f64;
            let cost = c.shape_cost_rad2 + alignment;
            if cost < limit_rad2 {
                costs.offer(GroupPair {
                    scan: *scan,
                    reference: *reference,
                    cost,
                });
            }
        }
        let (pairs, _) = cyclic_matching(&costs, PENALTY_RAD2);
        pairs
            .into_iter()
            .filter_map(|pair| {
                let found = self
                    .all
                    .iter()
                    .find(|(s, r, _)| (*s, *r) == (pair.scan, pair.reference));
                found.map(|(_, _, c)| Correspondence {
                    alignment_cost_rad2: pair.cost - c.shape_cost_rad2,
                    ..c.clone()
                })
            })
            .collect()
    }
}

/// The alignment term: squared Mahalanobis distance between induced and estimated pose, on the scale of C.
fn alignment_cost_rad2(induced: &PoseGaussian, estimate: &PoseGaussian) -> f64 {
    2.0 * PENALTY_RAD2 / FARTHEST_MAHALANOBIS2 * induced.mahalanobis2(estimate)
}

/// One of the two is a single polyline, and long enough to be all of the other.
fn may_be_one_object((one, one_shape): &(Group, Shape), (other, other_shape): &(Group, Shape)) -> bool {
    match (one.len, other.len) {
        (1, 1) => true,
        (1, _) => one_shape.length_m() >= LEAST_OF_GROUP * other_shape.length_m(),
        (_, 1) => other_shape.length_m() >= LEAST_OF_GROUP * one_shape.length_m(),
        _ => false,
    }
}

/// The longest polylines, in their order.
fn longest(polylines: &[Polyline]) -> Vec<Polyline> {
    let mut order: Vec<usize> = (0..polylines.len()).collect();
    order.sort_by(|&a, &b| polylines[b].length_m().total_cmp(&polylines[a].length_m()));
    order.truncate(COMPARED);
    order.sort_unstable();
    order.into_iter().map(|k| polylines[k].clone()).collect()
}

/// Whether a vertex of one is near the other: of two polylines that lie on each other, one ends first.
fn lie_together(a: &Polyline, b: &Polyline) -> bool {
    let near = |vertices: &Polyline, sides: &Polyline| {
        let near = |p: &Point| sides.sides().any(|side| side.distance(*p) < TOGETHER_M);
        vertices.vertices().iter().any(near)
    };
    near(a, b) || near(b, a)
}

/// Single polylines, and runs of neighbours with narrow gaps, joined.
fn groups(polylines: &[Polyline], cyclic: bool) -> Vec<(Group, Shape)> {
    let n = polylines.len();
    let mut groups = Vec::new();
    for first in 0..n {
        for len in 1..=LONGEST_GROUP.min(n) {
            if !cyclic && first + len > n {
                break;
            }
            let run = || (0..len).map(|k| &polylines[(first + k) % n]);
            if len > 1 {
                let (before, last) = (
                    &polylines[(first + len - 2) % n],
                    &polylines[(first + len - 1) % n],
                );
                if before.last().distance(last.first()) > WIDEST_GAP_M {
                    break;
                }
            }
            if let Some(shape) = Shape::joined(run()) {
                groups.push((Group { first, len }, shape));
            }
        }
    }
    groups
}
