//! How far off a pose may be.

use crate::geometry::matrix::{Matrix, product, transposed};

/// Covariance of a pose: x and y in metres, θ in radians, all in the frame and about the origin that the holder says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Covariance {
    /// Row by row; symmetric. m², m rad, rad².
    pub rows: [[f64; 3]; 3],
}

impl Covariance {
    /// The same by the axes of a frame that is turned: x′ = R(`by_rad`) x.
    #[must_use]
    pub fn turned(&self, by_rad: f64) -> Self {
        let (sin, cos) = by_rad.sin_cos();
        let turn: Matrix = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
        Self {
            rows: product(&product(&turn, &self.rows), &transposed(&turn)),
        }
    }

    /// Standard deviation of the place in the direction about which least is known, metres.
    #[must_use]
    pub fn widest_m(&self) -> f64 {
        let [[xx, xy, _], [_, yy, _], _] = self.rows;
        let spread = (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
        (0.5 * (xx + yy) + spread).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_widest_direction_is_as_wide_however_it_lies() {
        let rows = [[0.09, 0.0, 0.003], [0.0, 0.0001, 0.0], [0.003, 0.0, 0.0004]];
        let along = Covariance { rows };
        assert!((along.widest_m() - 0.3).abs() < 1e-12);
        let turned = along.turned(0.7);
        assert!((turned.widest_m() - 0.3).abs() < 1e-12);
        assert!(turned.rows[0][1] > 0.04, "x and y go together: {turned:?}");
        let back = turned.turned(-0.7);
        for (a, b) in along.rows.iter().flatten().zip(back.rows.iter().flatten()) {
            assert!((a - b).abs() < 1e-15);
        }
    }
}
