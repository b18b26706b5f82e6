//! Symmetric 3×3 matrices over (x, y, θ): information and covariance of a pose.

use crate::geometry::Point;
use crate::geometry::matrix::make_symmetric;

/// Information (inverse covariance) of a pose: x and y in metres, θ in radians, all in the frame and about the
/// origin that the holder says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Information {
    /// Row by row; symmetric.
    pub rows: [[f64; 3]; 3],
}

impl Information {
    /// Independent standard deviations turned into information.
    #[must_use]
    pub fn from_sigmas(x_m: f64, y_m: f64, theta_rad: f64) -> Self {
        let mut rows = [[0.0; 3]; 3];
        for (k, sigma) in [x_m, y_m, theta_rad].into_iter().enumerate() {
            rows[k][k] = 1.0 / (sigma * sigma);
        }
        Self { rows }
    }

    /// Adds `weight · j jᵀ`, the information of one residual with Jacobian `j`.
    pub fn add_residual(&mut self, j: [f64; 3], weight: f64) {
        for (row, a) in self.rows.iter_mut().zip(j) {
            for (cell, b) in row.iter_mut().zip(j) {
                *cell += weight * a * b;
            }
        }
    }

    /// The sum of two independent pieces of information.
    #[must_use]
    pub fn plus(mut self, other: &Self) -> Self {
        for (row, add) in self.rows.iter_mut().zip(other.rows) {
            for (cell, a) in row.iter_mut().zip(add) {
                *cell += a;
            }
        }
        self
    }

    /// Every entry multiplied.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.rows.iter_mut().flatten().for_each(|cell| *cell *= factor);
        self
    }

    /// The same information by the axes of a frame that is turned: x′ = R(`by_rad`) x.
    #[must_use]
    pub fn turned(&self, by_rad: f64) -> Self {
        let (sin, cos) = by_rad.sin_cos();
        let turn = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
        let mut rows = [[0.0; 3]; 3];
        for (r, row) in rows.iter_mut().enumerate() {
            for (c, cell) in row.iter_mut().enumerate() {
                let times = self.times(turn[c]);
                *cell = (0..3).map(|k| turn[r][k] * times[k]).sum();
            }
        }
        Self { rows }
    }

    /// The information that is left when independent noise is added to the pose.
    #[must_use]
    pub fn with_noise(&self, sigma_m: f64, sigma_rad: f64) -> Self {
        self.doubted(&Self::from_sigmas(sigma_m, sigma_m, sigma_rad))
    }

    /// The information that is left when independent noise is added to the pose, of covariance N: (Ω⁻¹ + N)⁻¹, computed
    /// as Ω − Ω (Ω + N⁻¹)⁻¹ Ω, which needs no inverse of Ω. `noise` is N⁻¹.
    #[must_use]
    pub fn doubted(&self, noise: &Self) -> Self {
        let sum = self.plus(noise);
        let mut rows = self.rows;
        for c in 0..3 {
            let column = [self.rows[0][c], self.rows[1][c], self.rows[2][c]];
            let Some(solved) = sum.solve(column) else {
                return *self;
            };
            let times = self.times(solved);
            for r in 0..3 {
                rows[r][c] -= times[r];
            }
        }
        make_symmetric(&mut rows);
        Self { rows }
    }

    /// The information that is left when the pose may be off along `way` as well, with standard deviation `sigma` of it: noise of rank
    /// one, (Ω⁻¹ + σ² v vᵀ)⁻¹, by the formula of Sherman and Morrison.
    #[must_use]
    pub fn with_noise_along(mut self, way: [f64; 3], sigma: f64) -> Self {
        let told = self.times(way);
        let variance = sigma * sigma;
        self.add_residual(told, -variance / (1.0 + variance * self.quadratic(way)));
        self
    }

    /// What is left of the information Ω and of a `gradient` where `seeming` S may have been taken for it:
    /// Ω (Ω + S)⁻¹ Ω and Ω (Ω + S)⁻¹ g. The pose that they ask for is the same; where Ω is large against S they are kept,
    /// where it is not hardly anything is. `None` when something is not determined.
    #[must_use]
    pub fn discounted_by(&self, seeming: &Self, gradient: [f64; 3]) -> Option<(Self, [f64; 3])> {
        let sum = self.plus(seeming);
        let mut rows = [[0.0; 3]; 3];
        for (r, row) in rows.iter_mut().enumerate() {
            *row = self.times(sum.solve(self.rows[r])?);
        }
        make_symmetric(&mut rows);
        Some((Self { rows }, self.times(sum.solve(gradient)?)))
    }

    /// jᵀ · self · j.
    #[must_use]
    pub fn quadratic(&self, j: [f64; 3]) -> f64 {
        let times = self.times(j);
        (0..3).map(|k| times[k] * j[k]).sum()
    }

    /// self · v.
    #[must_use]
    pub fn times(&self, v: [f64; 3]) -> [f64; 3] {
        self.rows.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    /// The v with self · v = `rhs`, by LDLᵀ; `None` when a pivot vanishes, that is when something is not determined.
    #[must_use]
    pub fn solve(&self, rhs: [f64; 3]) -> Option<[f64; 3]> {
        let a = &self.rows;
        let tiny = 1e-12 * (a[0][0] + a[1][1] + a[2][2]);
        let d0 = a[0][0];
        if d0 <= tiny {
            return None;
        }
        let (l10, l20) = (a[1][0] / d0, a[2][0] / d0);
        let d1 = a[1][1] - l10 * l10 * d0;
        if d1 <= tiny {
            return None;
        }
        let l21 = (a[2][1] - l20 * l10 * d0) / d1;
        let d2 = a[2][2] - l20 * l20 * d0 - l21 * l21 * d1;
        if d2 <= tiny {
            return None;
        }
        let y0 = rhs[0];
        let y1 = rhs[1] - l10 * y0;
        let y2 = rhs[2] - l20 * y0 - l21 * y1;
        let z2 = y2 / d2;
        let z1 = y1 / d1 - l21 * z2;
        let z0 = y0 / d0 - l10 * z1 - l20 * z2;
        let z = [z0, z1, z2];
        z.iter().all(|v| v.is_finite()).then_some(z)
    }

    /// The covariance; `None` when something is not determined.
    #[must_use]
    pub fn covariance(&self) -> Option<[[f64; 3]; 3]> {
        let columns = [
            self.solve([1.0, 0.0, 0.0])?,
            self.solve([0.0, 1.0, 0.0])?,
            self.solve([0.0, 0.0, 1.0])?,
        ];
        let mut out = [[0.0; 3]; 3];
        for (r, row) in out.iter_mut().enumerate() {
            for (c, cell) in row.iter_mut().enumerate() {
                *cell = 0.5 * (columns[c][r] + columns[r][c]);
            }
        }
        Some(out)
    }

    /// In how many directions of (x, y, θ), 0 to 3, this tells the pose to within `sigma_m` and `sigma_rad`: the eigenvalues above 1
    /// of Ω in units of these. In a corridor it is 2, and in a round room as well, wherever the scanner is: what is left open is a turn
    /// about the middle, which moves a scanner that is not there.
    #[must_use]
    pub fn rank(&self, sigma_m: f64, sigma_rad: f64) -> u8 {
        let unit = [sigma_m, sigma_m, sigma_rad];
        let mut a = self.rows;
        for (r, row) in a.iter_mut().enumerate() {
            for (c, cell) in row.iter_mut().enumerate() {
                *cell *= unit[r] * unit[c];
            }
            row[r] -= 1.0;
        }
        // As many pivots as eigenvalues are positive (Sylvester's law of inertia). A pivot of 0 is one that hardly is not.
        let pivot = |d: f64| if d == 0.0 { -1e-12 } else { d };
        let d0 = pivot(a[0][0]);
        let (l10, l20) = (a[1][0] / d0, a[2][0] / d0);
        let d1 = pivot(a[1][1] - l10 * a[0][1]);
        let l21 = (a[2][1] - l20 * a[0][1]) / d1;
        let d2 = a[2][2] - l20 * a[0][2] - l21 * (a[1][2] - l10 * a[0][2]);
        [d0, d1, d2].iter().map(|&d| u8::from(d > 0.0)).sum()
    }

    /// The direction of the plane about which this says least, and how much it says there (1/m²) when the
    /// heading is left free: smallest eigenvalue of the Schur complement of θ.
    #[must_use]
    pub fn weakest_direction(&self) -> (Point, f64) {
        let (xx, xy, yy) = self.of_place();
        // Axis of the larger eigenvalue is at half the angle of (xx − yy, 2 xy); the weak one is across.
        let strong_rad = 0.5 * (2.0 * xy).atan2(xx - yy);
        (Point::from_polar(1.0, strong_rad).left(), self.least_told())
    }

    /// Variance of the heading when the place is left free, rad²; `None` when something is not determined.
    #[must_use]
    pub fn heading_variance_rad2(&self) -> Option<f64> {
        self.solve([0.0, 0.0, 1.0]).map(|covariance| covariance[2])
    }

    /// How much it says in its weakest direction, 1/m² (see [`Self::weakest_direction`]).
    #[must_use]
    pub fn least_told(&self) -> f64 {
        let (xx, xy, yy) = self.of_place();
        let spread = (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
        (0.5 * (xx + yy) - spread).max(0.0)
    }

    /// What it says of the place when the heading is left free: the Schur complement of θ (xx, xy, yy).
    fn of_place(&self) -> (f64, f64, f64) {
        let a = &self.rows;
        let t = if a[2][2] > 0.0 { 1.0 / a[2][2] } else { 0.0 };
        (
            a[0][0] - a[0][2] * a[2][0] * t,
            a[0][1] - a[0][2] * a[2][1] * t,
            a[1][1] - a[1][2] * a[2][1] * t,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner_and_corridor() -> Information {
        let mut information = Information::default();
        for k in 0..50 {
            information.add_residual([0.0, 1.0, f64::from(k) * 0.1], 4.0);
        }
        information.add_residual([1.0, 0.0, 0.0], 0.5);
        information
    }

    #[test]
    fn noise_along_a_way_adds_to_the_covariance_there_and_nowhere_else() {
        let information = Information::from_sigmas(0.1, 0.2, 0.01);
        let left = information.with_noise_along([0.3, 0.0, 0.05], 0.5);
        let covariance = left.covariance().unwrap();
        let expected = [
            [0.01 + 0.0225, 0.0, 0.003_75],
            [0.0, 0.04, 0.0],
            [0.003_75, 0.0, 0.000_1 + 0.000_625],
        ];
        for (row, wanted) in covariance.iter().flatten().zip(expected.iter().flatten()) {
            assert!((row - wanted).abs() < 1e-12, "{covariance:?}");
        }
    }

    #[test]
    fn solving_undoes_multiplying() {
        let information = corner_and_corridor();
        let v = [0.3, -0.2, 0.05];
        let back = information.solve(information.times(v)).unwrap();
        for (a, b) in v.iter().zip(back) {
            assert!((a - b).abs() < 1e-9);
        }
        let covariance = information.covariance().unwrap();
        let unit = information.times([covariance[0][0], covariance[1][0], covariance[2][0]]);
        assert!((unit[0] - 1.0).abs() < 1e-9 && unit[1].abs() < 1e-9 && unit[2].abs() < 1e-9);
    }

    #[test]
    fn what_only_seems_to_be_told_is_taken_out_and_the_rest_is_kept() {
        let mut information = Information::from_sigmas(0.1, 0.001, 0.001);
        information.rows[0][1] = 50.0;
        information.rows[1][0] = 50.0;
        let mut seeming = Information::default();
        seeming.rows[0][0] = 900.0;
        let asked = [0.02, -0.001, 0.003];
        let (left, gradient) = information
            .discounted_by(&seeming, information.times(asked))
            .unwrap();
        assert!((left.rows[0][0] - 10.0).abs() < 0.1 && left.rows[1][1] > 0.99e6);
        for (a, b) in asked.iter().zip(left.solve(gradient).unwrap()) {
            assert!((a - b).abs() < 1e-9, "the pose asked for is the same");
        }
    }

    #[test]
    fn added_noise_adds_to_the_covariance() {
        let noisy = corner_and_corridor().with_noise(0.1, 0.05).covariance().unwrap();
        let clean = corner_and_corridor().covariance().unwrap();
        for (k, variance) in [0.01, 0.01, 0.0025].into_iter().enumerate() {
            assert!((noisy[k][k] - clean[k][k] - variance).abs() < 1e-9);
        }
    }

    #[test]
    fn a_turned_corridor_is_weak_along_the_turned_axis() {
        let (direction, _) = corner_and_corridor().turned(0.5).weakest_direction();
        assert!(
            direction.cross(Point::from_polar(1.0, 0.5)).abs() < 0.05,
            "{direction:?}"
        );
    }

    #[test]
    fn a_corridor_is_weak_along_itself() {
        let (direction, information) = corner_and_corridor().weakest_direction();
        assert!(direction.x.abs() > 0.999, "{direction:?}");
        assert!((information - 0.5).abs() < 1e-6);
    }

    #[test]
    fn the_rank_is_two_in_a_corridor_and_in_a_round_room_wherever_the_scanner_is() {
        let rank = |information: &Information| information.rank(0.04, 0.02);
        assert_eq!(rank(&Information::default()), 0);
        assert_eq!(rank(&Information::from_sigmas(0.01, 0.01, 0.005)), 3);
        assert_eq!(rank(&Information::from_sigmas(0.01, 0.05, 0.03)), 1);
        for by_rad in [0.0, 0.5, 1.5] {
            let corridor = Information::from_sigmas(0.3, 0.005, 0.002).turned(by_rad);
            assert_eq!(rank(&corridor), 2, "turned by {by_rad}");
        }
        // Walls 3 m round the middle, which the scanner is 0 to 2 m away from.
        for off_m in [0.0, 0.5, 2.0] {
            let mut round = Information::default();
            for k in 0..60 {
                let normal = Point::from_polar(1.0, 0.1 * f64::from(k));
                let arm = normal * 3.0 - Point::new(off_m, 0.0);
                round.add_residual([normal.x, normal.y, normal.dot(arm.left())], 1e3);
            }
            assert_eq!(rank(&round), 2, "{off_m} m from the middle");
        }
    }

    #[test]
    fn what_is_not_determined_is_not_solved() {
        let mut wall = Information::default();
        wall.add_residual([0.0, 1.0, 0.0], 1.0);
        assert_eq!(wall.solve([0.0, 1.0, 0.0]), None);
    }
}
