//! A trajectory against the true one.
//!
//! In: poses of scans in the map frame, and the true poses in the world frame. Out: the motion that lays the map
//! over the world, and what the poses are still off by. The best rigid fit of two sets of points in the plane has
//! a closed form: the mean goes to the mean, and the turn is atan2(Σ cross, Σ dot) of the points about them.

use polymapper_core::geometry::{Point, Pose, wrap_rad};

/// How far a trajectory is off, over the scans that were placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryError {
    /// Scans compared.
    pub scans: usize,
    /// Mean distance, metres.
    pub mean_translation_m: f64,
    /// Largest distance, metres.
    pub max_translation_m: f64,
    /// Mean turn, radians.
    pub mean_rotation_rad: f64,
    /// Largest turn, radians.
    pub max_rotation_rad: f64,
}

/// The motion `world_from_map` that brings the placed scans closest to the true poses (least squares over their
/// places). `placed` names each scan by its number in `truth`. Scans that all stand in one place (within 0.1 m) are
/// laid over by their headings. `None` without a scan that both hold.
#[must_use]
pub fn fit_trajectory(placed: &[(usize, Pose)], truth: &[Pose]) -> Option<Pose> {
    let pairs: Vec<(Pose, Pose)> = placed
        .iter()
        .filter_map(|&(k, map)| Some((map, *truth.get(k)?)))
        .collect();
    if pairs.is_empty() {
        return None;
    }
    let mean = |of: fn(&(Pose, Pose)) -> Point| {
        let sum = pairs.iter().fold(Point::default(), |sum, pair| sum + of(pair));
        sum / pairs.len() as f64
    };
    let (map_mean, world_mean) = (mean(|p| p.0.translation()), mean(|p| p.1.translation()));
    let (mut dot, mut cross, mut spread) = (0.0, 0.0, 0.0);
    for (map, world) in &pairs {
        let (m, w) = (map.translation() - map_mean, world.translation() - world_mean);
        dot += m.dot(w);
        cross += m.cross(w);
        spread += w.dot(w);
    }
    if spread / (pairs.len() as f64) < 0.1 * 0.1 {
        let turns = pairs.iter().map(|(map, world)| world.theta_rad - map.theta_rad);
        (cross, dot) = turns.fold((0.0, 0.0), |(s, c), turn: f64| (s + turn.sin(), c + turn.cos()));
    }
    let turn = Pose::new(0.0, 0.0, cross.atan2(dot));
    let shift = world_mean - turn.rotate(map_mean);
    Some(Pose::new(shift.x, shift.y, turn.theta_rad))
}

/// What the placed scans are off by once the map lies on the world by `world_from_map`; `None` without a scan that
/// both hold.
#[must_use]
pub fn trajectory_error(
    placed: &[(usize, Pose)],
    truth: &[Pose],
    world_from_map: Pose,
) -> Option<TrajectoryError> {
    let mut error = TrajectoryError {
        scans: 0,
        mean_translation_m: 0.0,
        max_translation_m: 0.0,
        mean_rotation_rad: 0.0,
        max_rotation_rad: 0.0,
    };
    for &(k, map_from_scan) in placed {
        let Some(&world_from_scan) = truth.get(k) else {
            continue;
        };
        let here = world_from_map * map_from_scan;
        let off_m = here.distance(world_from_scan);
        let off_rad = wrap_rad(here.theta_rad - world_from_scan.theta_rad).abs();
        error.scans += 1;
        error.mean_translation_m += off_m;
        error.mean_rotation_rad += off_rad;
        error.max_translation_m = error.max_translation_m.max(off_m);
        error.max_rotation_rad = error.max_rotation_rad.max(off_rad);
    }
    if error.scans == 0 {
        return None;
    }
    error.mean_translation_m /= error.scans as f64;
    error.mean_rotation_rad /= error.scans as f64;
    Some(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk() -> Vec<Pose> {
        (0..20)
            .map(|k| f64::from(k) * 0.3)
            .map(|s| Pose::new(s, (0.5 * s).sin(), 0.2 * s))
            .collect()
    }

    #[test]
    fn a_moved_trajectory_is_laid_back() {
        let world_from_map = Pose::new(3.0, -2.0, 2.8);
        let truth = walk();
        let placed: Vec<(usize, Pose)> = truth
            .iter()
            .enumerate()
            .step_by(2)
            .map(|(k, &w)| (k, world_from_map.inverse() * w))
            .collect();
        let fit = fit_trajectory(&placed, &truth).unwrap();
        assert!(fit.distance(world_from_map) < 1e-9 && (fit.theta_rad - 2.8).abs() < 1e-9);
        let error = trajectory_error(&placed, &truth, fit).unwrap();
        assert_eq!(error.scans, 10);
        assert!(error.max_translation_m < 1e-9 && error.max_rotation_rad < 1e-9);
    }

    #[test]
    fn one_scan_off_shows_in_maximum_and_mean() {
        let truth = walk();
        let mut placed: Vec<(usize, Pose)> = truth.iter().copied().enumerate().collect();
        placed[5].1 = truth[5] * Pose::new(0.0, 0.4, 0.1);
        let error = trajectory_error(&placed, &truth, Pose::IDENTITY).unwrap();
        assert!(
            (error.max_translation_m - 0.4).abs() < 1e-9 && (error.mean_translation_m - 0.02).abs() < 1e-9
        );
        assert!(
            (error.max_rotation_rad - 0.1).abs() < 1e-9 && (error.mean_rotation_rad - 0.005).abs() < 1e-9
        );
    }

    #[test]
    fn a_standing_scanner_is_laid_over_by_its_heading() {
        let truth = vec![Pose::new(1.0, 2.0, 0.7); 5];
        let placed: Vec<(usize, Pose)> = (0..5).map(|k| (k, Pose::IDENTITY)).collect();
        let fit = fit_trajectory(&placed, &truth).unwrap();
        assert!(fit.distance(truth[0]) < 1e-9 && (fit.theta_rad - 0.7).abs() < 1e-9);
    }

    #[test]
    fn without_a_common_scan_there_is_nothing_to_say() {
        assert_eq!(fit_trajectory(&[(7, Pose::IDENTITY)], &walk()[..3]), None);
        assert_eq!(trajectory_error(&[], &walk(), Pose::IDENTITY), None);
    }
}
