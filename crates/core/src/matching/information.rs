//! Gaussians over poses in information form, 3x3.
//!
//! The inverse of a covariance does not exist for what a straight wall tells (nothing along it), but its
//! information matrix does: it is singular. Order of rows is (x, y, theta), in metres and radians, of the
//! additive error of a pose.

use crate::geometry::{Point, Pose, wrap_rad};

/// An information matrix (inverse covariance) over (x, y, theta); symmetric, positive semi-definite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Information {
    rows: [[f64; 3]; 3],
}

impl Information {
    /// Knowing nothing.
    pub const NONE: Self = Self { rows: [[0.0; 3]; 3] };

    /// Independent standard deviations: metres, metres, radians. One that is not positive is taken as unknown.
    #[must_use]
    pub fn from_sigmas(x_m: f64, y_m: f64, theta_rad: f64) -> Self {
        let mut information = Self::NONE;
        for (k, sigma) in [x_m, y_m, theta_rad].into_iter().enumerate() {
            if sigma > 0.0 && sigma.is_finite() {
                information.rows[k][k] = 1.0 / (sigma * sigma);
            }
        }
        information
    }

    /// The matrix, row by row.
    #[must_use]
    pub fn rows(&self) -> &[[f64; 3]; 3] {
        &self.rows
    }

    /// Adds what one measurement tells: `weight · jacobianᵀ · jacobian`, weight = 1/σ².
    pub fn add(&mut self, jacobian: [f64; 3], weight: f64) {
        for (row, a) in self.rows.iter_mut().zip(jacobian) {
            for (cell, b) in row.iter_mut().zip(jacobian) {
                *cell += weight * a * b;
            }
        }
    }

    /// What two independent sources tell together.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        for (row, other) in sum.rows.iter_mut().zip(other.rows) {
            for (cell, value) in row.iter_mut().zip(other) {
                *cell += value;
            }
        }
        sum
    }

    /// The matrix times a vector.
    #[must_use]
    pub fn times(&self, v: [f64; 3]) -> [f64; 3] {
        self.rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    /// Solves `self · x = b` by Cholesky; `None` if a direction is not known.
    #[must_use]
    pub fn solve(&self, b: [f64; 3]) -> Option<[f64; 3]> {
        let m = &self.rows;
        // Pivots are compared with the diagonal they come from: rounding leaves 1e-16 of it in a singular matrix.
        let pivot = |value: f64, diagonal: f64| (value > 1e-11 * diagonal).then(|| value.sqrt());
        let l00 = pivot(m[0][0], m[0][0])?;
        let (l10, l20) = (m[1][0] / l00, m[2][0] / l00);
        let l11 = pivot(m[1][1] - l10 * l10, m[1][1])?;
        let l21 = (m[2][1] - l20 * l10) / l11;
        let l22 = pivot(m[2][2] - l20 * l20 - l21 * l21, m[2][2])?;
        let y0 = b[0] / l00;
        let y1 = (b[1] - l10 * y0) / l11;
        let y2 = (b[2] - l20 * y0 - l21 * y1) / l22;
        let x2 = y2 / l22;
        let x1 = (y1 - l21 * x2) / l11;
        Some([(y0 - l10 * x1 - l20 * x2) / l00, x1, x2])
    }

    /// The covariance; `None` if a direction is not known.
    #[must_use]
    pub fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        let columns = [
            self.solve([1.0, 0.0, 0.0])?,
            self.solve([0.0, 1.0, 0.0])?,
            self.solve([0.0, 0.0, 1.0])?,
        ];
        Some(columns)
    }

    /// `vᵀ · self · v`.
    #[must_use]
    pub fn quadratic(&self, v: [f64; 3]) -> f64 {
        let w = self.times(v);
        v[0] * w[0] + v[1] * w[1] + v[2] * w[2]
    }

    /// Inverse of the sum of the two covariances, without needing either:
    /// `(A⁻¹ + B⁻¹)⁻¹ = A − A (A + B)⁻¹ A`. `None` if even both together leave a direction unknown.
    #[must_use]
    pub fn parallel(&self, other: &Self) -> Option<Self> {
        let sum = self.plus(other);
        let mut result = Self::NONE;
        for k in 0..3 {
            let column = self.rows.map(|row| row[k]);
            let correction = self.times(sum.solve(column)?);
            for i in 0..3 {
                result.rows[i][k] = self.rows[i][k] - correction[i];
            }
        }
        Some(result)
    }

    /// The direction of the plane along which the place is known least, and the standard deviation along it,
    /// metres (infinite if nothing is known), with heading left free.
    #[must_use]
    pub fn weakest_direction(&self) -> (Point, f64) {
        let m = &self.rows;
        // Marginal over x, y: the Schur complement of the heading.
        let by_theta = |i: usize, j: usize| if m[2][2] > 0.0 { m[i][2] * m[j][2] / m[2][2] } else { 0.0 };
        let (a, b, c) = (m[0][0] - by_theta(0, 0), m[0][1] - by_theta(0, 1), m[1][1] - by_theta(1, 1));
        let half_gap = (0.5 * (a - c)).hypot(b);
        let smaller = (0.5 * (a + c) - half_gap).max(0.0);
        // The eigenvector of the larger value has angle ½ atan2(2b, a − c); the weakest is across it.
        let strongest_rad = 0.5 * (2.0 * b).atan2(a - c);
        let direction = Point::from_polar(1.0, strongest_rad).left();
        (direction, 1.0 / smaller.sqrt())
    }
}

/// A pose and how well it is known, as an additive error of (x, y, theta).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseGaussian {
    /// The most likely pose.
    pub mean: Pose,
    /// Its information; singular along what is not known.
    pub information: Information,
}

impl PoseGaussian {
    /// How far `pose` is from the mean in (x, y, theta), heading wrapped.
    #[must_use]
    pub fn error_of(&self, pose: Pose) -> [f64; 3] {
        [
            pose.x - self.mean.x,
            pose.y - self.mean.y,
            wrap_rad(pose.theta_rad - self.mean.theta_rad),
        ]
    }

    /// Squared Mahalanobis distance between two uncertain poses, counted only along what both know.
    ///
    /// 0 if they know nothing in common.
    #[must_use]
    pub fn mahalanobis2(&self, other: &Self) -> f64 {
        let joint = self.information.parallel(&other.information);
        joint.map_or(0.0, |joint| joint.quadratic(self.error_of(other.mean)).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solving_undoes_multiplying() {
        let mut a = Information::from_sigmas(0.1, 0.2, 0.05);
        a.add([1.0, 2.0, -3.0], 40.0);
        a.add([0.5, -1.0, 2.0], 15.0);
        let x = a.solve(a.times([1.0, -2.0, 0.3])).unwrap();
        for (found, wanted) in x.iter().zip([1.0, -2.0, 0.3]) {
            assert!((found - wanted).abs() < 1e-9);
        }
        assert!(Information::NONE.solve([0.0; 3]).is_none());
    }

    #[test]
    fn covariances_add() {
        let a = Information::from_sigmas(3.0, 0.1, 0.2);
        let b = Information::from_sigmas(4.0, 0.1, 0.1);
        let rows = *a.parallel(&b).unwrap().rows();
        assert!((1.0 / rows[0][0].sqrt() - 5.0).abs() < 1e-9, "3-4-5");
    }

    #[test]
    fn a_corridor_is_weakest_along_itself() {
        let along = Point::from_polar(1.0, 0.7);
        let mut walls = Information::NONE;
        for reach_m in [-3.0, 0.0, 2.0] {
            walls.add([-along.y, along.x, reach_m], 1e4);
        }
        let (direction, sigma_m) = walls.weakest_direction();
        assert!(direction.cross(along).abs() < 1e-6 && sigma_m > 1e3);
        walls.add([along.x, along.y, 0.0], 25.0);
        assert!((walls.weakest_direction().1 - 0.2).abs() < 1e-6);
    }
}
