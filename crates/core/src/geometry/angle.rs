use std::f64::consts::{PI, TAU};

/// The angle brought into (−π, π].
#[must_use]
pub fn wrap_rad(angle_rad: f64) -> f64 {
    if angle_rad > -PI && angle_rad <= PI {
        return angle_rad;
    }
    let turned = angle_rad.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_more_or_less_does_not_matter() {
        for k in -3..=3 {
            let wrapped = wrap_rad(0.5 + f64::from(k) * TAU);
            assert!((wrapped - 0.5).abs() < 1e-12, "{k} turns gave {wrapped}");
        }
        assert!((wrap_rad(-PI) - PI).abs() < 1e-15, "−π is given as π");
    }
}
