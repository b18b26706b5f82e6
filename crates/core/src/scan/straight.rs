//! A scan taken by a moving scanner, made as if it had been taken at once.
//!
//! In: a scan and the motion of the scanner while its beam goes round. Out: range and bearing of every return, seen from where
//! the scanner was when it looked along the middle beam. At 10 scans a second and a walk of 1 m/s the beams of one scan are
//! taken up to 0.1 m apart.

use super::ScanGeometry;
use crate::geometry::{Point, Pose, wrap_rad};

/// What becomes of the measured ranges and bearings.
#[derive(Clone, Debug)]
pub(super) struct Straight {
    /// Motion while the beam goes round once counter-clockwise, in the scanner's own frame.
    pub turn_motion: Pose,
    pub ranges_m: Vec<f64>,
    /// What is added to the bearings of the geometry, radians.
    pub turned_rad: Vec<f64>,
}

impl Straight {
    pub fn new(geometry: &ScanGeometry, measured_m: &[f64], turn_motion: Pose) -> Self {
        let mut ranges_m = measured_m.to_vec();
        let mut turned_rad = vec![0.0; ranges_m.len()];
        for (beam, (range_m, turned)) in ranges_m.iter_mut().zip(&mut turned_rad).enumerate() {
            let bearing_rad = geometry.bearing_rad(beam);
            let moved = turn_motion.scaled(geometry.turns_from_middle(bearing_rad));
            *turned = moved.theta_rad;
            if range_m.is_finite() {
                let point = moved * Point::from_polar(*range_m, bearing_rad);
                *range_m = point.norm();
                *turned = wrap_rad(point.bearing_rad() - bearing_rad);
            }
        }
        Self {
            turn_motion,
            ranges_m,
            turned_rad,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scan;
    use super::*;

    /// Ranges to a wall at x = 2 m, measured from beam to beam while the scanner moves.
    fn swept(geometry: ScanGeometry, turn_motion: Pose) -> Scan {
        let ranges_m = (0..geometry.beams())
            .map(|beam| {
                let bearing_rad = geometry.bearing_rad(beam);
                let here = turn_motion.scaled(geometry.turns_from_middle(bearing_rad));
                (2.0 - here.x) / (bearing_rad + here.theta_rad).cos()
            })
            .collect();
        Scan::new(geometry, ranges_m).unwrap()
    }

    #[test]
    fn a_wall_seen_on_the_move_is_straight_again() {
        let geometry = ScanGeometry::new(-1.0, 0.01, 201).unwrap();
        let turn_motion = Pose::new(0.12, -0.04, 0.2);
        let scan = swept(geometry, turn_motion);
        let off_m = |scan: &Scan| scan.points().map(|(_, p)| (p.x - 2.0).abs()).fold(0.0, f64::max);
        assert!(off_m(&scan) > 0.05);
        assert!(off_m(&scan.straightened(turn_motion)) < 1e-9);
    }

    #[test]
    fn straightening_begins_with_what_was_measured() {
        let geometry = ScanGeometry::new(-1.0, 0.01, 201).unwrap();
        let scan = swept(geometry, Pose::new(0.1, 0.0, 0.1));
        let twice = scan
            .straightened(Pose::new(0.3, 0.1, -0.2))
            .straightened(Pose::new(0.1, 0.0, 0.1));
        assert_eq!(
            twice.ranges_m(),
            scan.straightened(Pose::new(0.1, 0.0, 0.1)).ranges_m()
        );
        assert_eq!(twice.straightened(Pose::IDENTITY).ranges_m(), scan.ranges_m());
    }
}
