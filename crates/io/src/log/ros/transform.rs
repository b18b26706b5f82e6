//! Rigid transforms in space, as far as it takes to know how a scanner is mounted.

use polymapper_core::geometry::Pose;

use super::super::number::finite_pose;

/// `parent_from_child`: `p ↦ R p + t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::log) struct Transform {
    rotation: [[f64; 3]; 3],
    translation_m: [f64; 3],
}

impl Transform {
    pub const IDENTITY: Self = Self {
        rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        translation_m: [0.0; 3],
    };

    /// Of a place and a quaternion x y z w, which need not have length 1 (all zeros, as drivers write for "not
    /// filled in", is no rotation).
    pub fn new(translation_m: [f64; 3], [x, y, z, w]: [f64; 4]) -> Self {
        let length2 = x * x + y * y + z * z + w * w;
        let rotation = if length2 > 1e-12 && length2.is_finite() {
            let s = 2.0 / length2;
            [
                [
                    1.0 - s * (y * y + z * z),
                    s * (x * y - z * w),
                    s * (x * z + y * w),
                ],
                [
                    s * (x * y + z * w),
                    1.0 - s * (x * x + z * z),
                    s * (y * z - x * w),
                ],
                [
                    s * (x * z - y * w),
                    s * (y * z + x * w),
                    1.0 - s * (x * x + y * y),
                ],
            ]
        } else {
            Self::IDENTITY.rotation
        };
        Self {
            rotation,
            translation_m,
        }
    }

    /// Of a place and a rotation matrix.
    pub fn of_matrix(translation_m: [f64; 3], rotation: [[f64; 3]; 3]) -> Self {
        Self {
            rotation,
            translation_m,
        }
    }

    /// `self` after `inner`: `a_from_c` of `a_from_b` and `b_from_c`.
    pub fn after(&self, inner: &Self) -> Self {
        let mut rotation = [[0.0; 3]; 3];
        let mut translation_m = self.translation_m;
        for i in 0..3 {
            for k in 0..3 {
                translation_m[i] += self.rotation[i][k] * inner.translation_m[k];
                for j in 0..3 {
                    rotation[i][j] += self.rotation[i][k] * inner.rotation[k][j];
                }
            }
        }
        Self {
            rotation,
            translation_m,
        }
    }

    pub fn is_finite(&self) -> bool {
        self.translation_m
            .iter()
            .chain(self.rotation.as_flattened())
            .all(|v| v.is_finite())
    }

    /// How far the child's z axis points up: 1 upright, −1 upside down.
    pub fn up(&self) -> f64 {
        self.rotation[2][2]
    }

    /// The transform in the plane: where the child is, and where its x axis points. `None` unless finite.
    pub fn planar(&self) -> Option<Pose> {
        let theta_rad = self.rotation[1][0].atan2(self.rotation[0][0]);
        finite_pose(self.translation_m[0], self.translation_m[1], theta_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_turn_about_x_is_upside_down_and_looks_ahead() {
        let mount = Transform::new([0.2, 0.0, 0.1], [1.0, 0.0, 0.0, 0.0]);
        assert!((mount.up() + 1.0).abs() < 1e-12);
        assert!(mount.planar().unwrap().theta_rad.abs() < 1e-12);
    }

    #[test]
    fn transforms_one_after_another_add_up() {
        let quarter = Transform::new([1.0, 0.0, 0.0], [0.0, 0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()]);
        let twice = quarter.after(&quarter).planar().unwrap();
        assert!((twice.x - 1.0).abs() < 1e-12 && (twice.y - 1.0).abs() < 1e-12);
        assert!((twice.theta_rad.abs() - std::f64::consts::PI).abs() < 1e-12);
    }
}
