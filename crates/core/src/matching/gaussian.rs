//! Poses with an uncertainty, as Gaussians in information form.
//!
//! The inverse of a covariance does not exist for what a straight wall tells (nothing along it), but its
//! information matrix does: it is singular.

use crate::align::Information;
use crate::geometry::{Pose, wrap_rad};

/// A pose and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseGaussian {
    /// The most likely pose.
    pub mean: Pose,
    /// Information on its error: x and y in the frame that the pose leads to, the turn about its origin. Singular along what
    /// is not known.
    pub information: Information,
}

impl PoseGaussian {
    /// How far `pose` is from the mean in (x, y, theta), heading wrapped.
    #[must_use]
    pub fn error_of(&self, pose: Pose) -> [f64; 3] {
        let turn_rad = wrap_rad(pose.theta_rad - self.mean.theta_rad);
        [pose.x - self.mean.x, pose.y - self.mean.y, turn_rad]
    }

    /// Squared Mahalanobis distance between two uncertain poses, counted only along what both know; 0 if they know
    /// nothing in common.
    ///
    /// With the covariances A⁻¹ and B⁻¹ it is δᵀ (A⁻¹ + B⁻¹)⁻¹ δ, and (A⁻¹ + B⁻¹)⁻¹ = A − A (A + B)⁻¹ A needs neither
    /// of them.
    #[must_use]
    pub fn mahalanobis2(&self, other: &Self) -> f64 {
        let (a, b) = (&self.information, &other.information);
        let error = self.error_of(other.mean);
        let told = a.times(error);
        // A hair of information on everything: what neither knows cancels, but the sum can be solved.
        let hair = 1e-9 * (0..3).map(|k| a.rows[k][k] + b.rows[k][k]).sum::<f64>();
        let sum = a
            .plus(b)
            .plus(&Information::from_sigmas(1.0, 1.0, 1.0).scaled(hair));
        let Some(shared) = sum.solve(told) else { return 0.0 };
        let overlap: f64 = told.iter().zip(shared).map(|(t, s)| t * s).sum();
        (a.quadratic(error) - overlap).max(0.0)
    }

    /// The pose that several independent Gaussians give together, linearised at `near`; where they know nothing it
    /// stays there.
    #[must_use]
    pub fn fused<'a>(gaussians: impl IntoIterator<Item = &'a Self>, near: Pose) -> Self {
        let mut information = Information::default();
        let mut gradient = [0.0; 3];
        for g in gaussians {
            information = information.plus(&g.information);
            for (sum, pull) in gradient.iter_mut().zip(g.information.times(g.error_of(near))) {
                *sum -= pull;
            }
        }
        let held = information.plus(&Information::from_sigmas(100.0, 100.0, 100.0));
        let [dx, dy, dtheta] = held.solve(gradient).unwrap_or_default();
        Self {
            mean: Pose::new(near.x + dx, near.y + dy, near.theta_rad + dtheta),
            information,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, sigmas: (f64, f64, f64)) -> PoseGaussian {
        let information = Information::from_sigmas(sigmas.0, sigmas.1, sigmas.2);
        PoseGaussian {
            mean: Pose::new(x, y, 0.0),
            information,
        }
    }

    #[test]
    fn covariances_add() {
        let (a, b) = (at(0.0, 0.0, (3.0, 0.1, 0.2)), at(10.0, 0.0, (4.0, 0.1, 0.1)));
        assert!((a.mahalanobis2(&b) - 4.0).abs() < 1e-4, "10 m at 3-4-5 m");
        assert!((b.mahalanobis2(&a) - 4.0).abs() < 1e-4);
    }

    #[test]
    fn what_one_does_not_know_does_not_count() {
        let wall = at(0.0, 0.0, (f64::INFINITY, 0.1, 0.2));
        assert!(wall.mahalanobis2(&at(50.0, 0.0, (0.1, 0.1, 0.1))) < 1e-3);
        assert!(wall.mahalanobis2(&at(50.0, 1.0, (0.1, 0.1, 0.1))) > 40.0);
    }

    #[test]
    fn headings_count_though_no_place_is_known() {
        let mut wall = at(0.0, 0.0, (f64::INFINITY, 0.1, 0.1));
        let heading = at(3.0, 3.0, (f64::INFINITY, f64::INFINITY, 0.1));
        assert!(wall.mahalanobis2(&heading) < 1e-4);
        wall.mean.theta_rad = 1.0;
        assert!(wall.mahalanobis2(&heading) > 40.0);
    }

    #[test]
    fn two_walls_fix_what_each_leaves_open() {
        let across_x = at(1.0, -7.0, (0.1, f64::INFINITY, 0.1));
        let across_y = at(9.0, 2.0, (f64::INFINITY, 0.1, 0.1));
        let both = PoseGaussian::fused([&across_x, &across_y], Pose::IDENTITY).mean;
        assert!(
            (both.x - 1.0).abs() < 1e-3 && (both.y - 2.0).abs() < 1e-3,
            "{both:?}"
        );
    }
}
