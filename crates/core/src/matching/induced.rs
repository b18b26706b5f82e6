//! The pose that a correspondence induces (paper section 3.3: "any correspondence of polylines induces an
//! alignment").
//!
//! In: pairs of straight pieces that lie on each other. Out: `reference_from_scan` as a Gaussian in information
//! form. Each piece of the scan lies on the line of its partner, `n · (R q + t − p) = 0`, and nothing is said
//! about where along it: walls are cut by occlusion. So a straight wall fixes heading and normal offset and
//! leaves an infinite variance along it, and a polyline with a corner fixes everything.
//!
//! The paper gives no formula for agreement of alignments; we take the Mahalanobis distance, which counts only
//! what both sides know.

use super::gaussian::PoseGaussian;
use crate::align::Information;
use crate::geometry::{Point, Pose, Segment, wrap_rad};
use crate::shape::{PartPair, Shape, tangent};

/// Standard deviation across a wall of the distance between two fitted pictures of it, metres: 1 to 2 cm from
/// the sensor's noise in each and about as much from simplifying what is not quite straight.
pub const WALL_SIGMA_M: f64 = 0.03;
/// Length of wall that counts as one independent measurement, metres. Errors of neighbouring beams go together
/// (bias of range, skirting, the fit), so that more beams a metre do not make a better metre.
pub const INDEPENDENT_WALL_M: f64 = 0.25;
/// A wall counts as no more than this length of it, metres. Its place and direction are off by what no number of
/// beams averages out (bow, skirting, the fit); otherwise two corridor walls that are parallel to 2° would seem to fix the place along them.
pub const WALL_WORTH_M: f64 = 0.5;
/// Pieces whose heading difference is further than this from the mean one do not lie on each other: a corner
/// that arc lengths put a little too early or late.
const SAME_HEADING_RAD: f64 = 20.0 * std::f64::consts::PI / 180.0;

/// A straight piece of the scan and the straight piece of the reference that it lies on, each in its own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PiecePair {
    /// Piece of a side of the scan.
    pub scan: Segment,
    /// Piece of a side of the reference.
    pub reference: Segment,
}

impl PiecePair {
    /// Heading of the pose that turns the one into the other, in (−π, π].
    #[must_use]
    pub fn heading_rad(&self) -> f64 {
        let (scan, reference) = (self.scan.b - self.scan.a, self.reference.b - self.reference.a);
        wrap_rad(reference.bearing_rad() - scan.bearing_rad())
    }

    /// Length that is matched for certain: that of the shorter piece, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.scan.length_m().min(self.reference.length_m())
    }
}

/// How many independent measurements a wall of this length is worth.
#[must_use]
pub fn measurements(length_m: f64) -> f64 {
    length_m.min(WALL_WORTH_M) / INDEPENDENT_WALL_M
}

/// The straight pieces that a correspondence of parts lays on each other.
#[must_use]
pub fn piece_pairs(scan: &Shape, reference: &Shape, parts: &[PartPair]) -> Vec<PiecePair> {
    let mut pieces = Vec::new();
    for parts in parts {
        tangent::common_stretches(scan.tangent(), parts.c, reference.tangent(), parts.d, |s| {
            let stretch = |part: crate::shape::Part| {
                let at = |share: f64| part.from_m + share * part.length_m();
                crate::shape::Part::new(at(s.from), at(s.to))
            };
            let scan = scan.piece(s.c_side, stretch(parts.c));
            let reference = reference.piece(s.d_side, stretch(parts.d));
            if let (Some(scan), Some(reference)) = (scan, reference) {
                pieces.push(PiecePair { scan, reference });
            }
        });
    }
    pieces
}

/// The pose induced by pieces that lie on each other; along what they leave open it stays closest to `near`.
///
/// `None` if there is no piece with a length.
#[must_use]
pub fn induced_pose(pieces: &[PiecePair], near: Pose) -> Option<PoseGaussian> {
    let all_rad = mean_heading_rad(pieces.iter())?;
    let alike = |p: &&PiecePair| wrap_rad(p.heading_rad() - all_rad).abs() < SAME_HEADING_RAD;
    let heading_rad = mean_heading_rad(pieces.iter().filter(alike))?;
    let mut mean = Pose::new(near.x, near.y, heading_rad);
    let mut information = Information::default();
    // The equations are linear but for the turn, which the mean heading gives to a few degrees: two rounds.
    for _ in 0..2 {
        information = Information::default();
        let mut gradient = [0.0; 3];
        for piece in pieces.iter().filter(alike) {
            add_piece(piece, mean, &mut information, &mut gradient);
        }
        // Too weak to move what a wall fixes (0.03 m), it holds what no wall fixes where it is.
        let held = information.plus(&Information::from_sigmas(100.0, 100.0, 100.0));
        let [dx, dy, dtheta] = held.solve(gradient)?;
        mean = Pose::new(mean.x + dx, mean.y + dy, mean.theta_rad + dtheta);
    }
    Some(PoseGaussian { mean, information })
}

fn mean_heading_rad<'a>(pieces: impl Iterator<Item = &'a PiecePair>) -> Option<f64> {
    let sum = pieces
        .map(|p| Point::from_polar(p.length_m(), p.heading_rad()))
        .fold(Point::default(), |a, b| a + b);
    (sum.norm() > 1e-9).then(|| sum.bearing_rad())
}

/// Normal equations of one piece: two points at ±l/√12 of its middle have its mean and its second moment.
fn add_piece(piece: &PiecePair, pose: Pose, information: &mut Information, gradient: &mut [f64; 3]) {
    let Some(normal) = piece.reference.direction().map(Point::left) else {
        return;
    };
    let length_m = piece.length_m();
    let middle = piece.scan.at(0.5);
    let along = piece.scan.direction().unwrap_or_default() * (length_m / 12f64.sqrt());
    let weight = 0.5 * measurements(length_m) / (WALL_SIGMA_M * WALL_SIGMA_M);
    for q in [middle + along, middle - along] {
        let turned = pose.rotate(q);
        let residual_m = normal.dot(turned + pose.translation() - piece.reference.a);
        let jacobian = [normal.x, normal.y, normal.dot(turned.left())];
        information.add_residual(jacobian, weight);
        for (g, j) in gradient.iter_mut().zip(jacobian) {
            *g -= weight * j * residual_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polyline;
    use crate::shape::similarity;

    fn induced(reference: &[(f64, f64)], truth: Pose, cut: usize) -> PoseGaussian {
        let points: Vec<Point> = reference.iter().map(|&(x, y)| Point::new(x, y)).collect();
        let reference = Polyline::new(points.clone()).unwrap();
        let scan = Polyline::new(points[cut..].to_vec())
            .unwrap()
            .transformed(truth.inverse());
        let (c, d) = (Shape::new(&scan).unwrap(), Shape::new(&reference).unwrap());
        let parts = similarity(&c, &d, f64::INFINITY).unwrap().pairs;
        induced_pose(&piece_pairs(&c, &d, &parts), Pose::IDENTITY).unwrap()
    }

    const TRUTH: Pose = Pose {
        x: 0.8,
        y: -0.4,
        theta_rad: 1.1,
    };

    #[test]
    fn a_corner_fixes_the_whole_pose() {
        let corner = [(3.0, -2.0), (3.0, 2.0), (-1.0, 2.5)];
        let gaussian = induced(&corner, TRUTH, 0);
        let [dx, dy, dtheta] = gaussian.error_of(TRUTH);
        assert!(dx.hypot(dy) < 1e-6 && dtheta.abs() < 1e-6, "{:?}", gaussian.mean);
        assert!(gaussian.information.weakest_direction().1 > 400.0, "5 cm");
    }

    #[test]
    fn a_wall_fixes_heading_and_distance_only() {
        let gaussian = induced(&[(3.0, -2.0), (3.0, 2.0)], TRUTH, 0);
        let [dx, dy, dtheta] = gaussian.error_of(TRUTH);
        assert!(dx.abs() < 1e-6 && dtheta.abs() < 1e-6, "the wall is across x");
        assert!(dy.abs() > 0.1, "along the wall the pose stays near the estimate");
        let (direction, along) = gaussian.information.weakest_direction();
        assert!(direction.x.abs() < 1e-6 && along < 1e-6);

        // Moving along the wall agrees with it, moving across does not.
        let known = |x, y| PoseGaussian {
            mean: Pose::new(x, y, TRUTH.theta_rad),
            information: Information::from_sigmas(0.1, 0.1, 0.1),
        };
        assert!(gaussian.mahalanobis2(&known(TRUTH.x, 5.0)) < 1e-6);
        assert!(gaussian.mahalanobis2(&known(TRUTH.x + 1.0, 5.0)) > 20.0);
    }
}
