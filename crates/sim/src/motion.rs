//! How the scanner is carried through a plan.
//!
//! In: a [`Plan`] and a [`Motion`]. Out: times and poses of the scans. The vehicle calls at the plan's stops in
//! order, looks where it goes, bends round corners, and turns on the spot where it has to turn back. Scanner and
//! vehicle have the same frame.

use std::f64::consts::TAU;

use polymapper_core::geometry::{Point, Pose, wrap_rad};

use crate::dice::bearing_rad;
use crate::error::SimError;
use crate::plan::Plan;
use crate::terrain::{Terrain, WAY_STEP_M};

/// How fast the scanner moves, and which scans are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Speed along straight ways, m/s. 0.5: an indoor robot; gives 5 cm between scans at 10 Hz.
    pub speed_mps: f64,
    /// Fastest turn, rad/s.
    pub turn_radps: f64,
    /// Scans taken a second.
    pub scan_rate_hz: f64,
    /// A scan is kept when the scanner has moved this far since the last one kept, metres; 0 keeps all ...
    pub step_m: f64,
    /// ... or turned this far, radians.
    pub step_rad: f64,
    /// The scanner stays at the first stop instead of making the tour.
    pub standing: bool,
    /// No more scans than this, 1 to 1 000 000. A standing scanner takes exactly as many.
    pub max_scans: usize,
}

impl Motion {
    /// Every scan of a tour at 10 Hz: 5 cm and up to 4.5° from scan to scan, some thousand scans.
    #[must_use]
    pub fn full_rate() -> Self {
        Self {
            speed_mps: 0.5,
            turn_radps: TAU / 8.0,
            scan_rate_hz: 10.0,
            step_m: 0.0,
            step_rad: 0.0,
            standing: false,
            max_scans: 20_000,
        }
    }

    /// A scan every metre or 40°, like logs thinned to keyframes.
    #[must_use]
    pub fn keyframes() -> Self {
        Self {
            step_m: 1.0,
            step_rad: TAU / 9.0,
            ..Self::full_rate()
        }
    }

    /// A scanner that stands still and takes `scans` scans.
    #[must_use]
    pub fn standing(scans: usize) -> Self {
        Self {
            standing: true,
            max_scans: scans,
            ..Self::full_rate()
        }
    }

    pub(crate) fn check(&self) -> Result<(), SimError> {
        let positive = [
            ("speed_mps", self.speed_mps),
            ("turn_radps", self.turn_radps),
            ("scan_rate_hz", self.scan_rate_hz),
        ];
        for (name, value) in positive {
            // Slower than a crawl fills the memory before the tour ends.
            if !(0.01..=1000.0).contains(&value) {
                return Err(SimError::Setting {
                    name,
                    value,
                    range: "0.01 to 1000",
                });
            }
        }
        if !(1..=MOST_SCANS).contains(&self.max_scans) {
            return Err(SimError::Setting {
                name: "max_scans",
                value: self.max_scans as f64,
                range: "1 to 1000000",
            });
        }
        for (name, value) in [("step_m", self.step_m), ("step_rad", self.step_rad)] {
            if !(0.0..=1000.0).contains(&value) {
                return Err(SimError::Setting {
                    name,
                    value,
                    range: "0 to 1000",
                });
            }
        }
        Ok(())
    }
}

/// A day at 10 Hz; more would fill the memory.
const MOST_SCANS: usize = 1_000_000;
/// A sharper turn at a stop is made on the spot; a lesser one is cut.
const TURN_BACK_RAD: f64 = 2.0;

/// When and where a scan is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stand {
    pub(crate) stamp_s: f64,
    pub(crate) world_from_laser: Pose,
}

/// The scans of a tour through the plan.
pub(crate) fn stands(plan: &Plan, terrain: &Terrain, motion: &Motion) -> Result<Vec<Stand>, SimError> {
    let ways = tour(plan, terrain);
    let timed = timed(&ways, motion);
    let first = *timed.first().ok_or(SimError::NoRoom {
        plan: plan.kind().name(),
        seed: plan.seed(),
    })?;
    let period_s = 1.0 / motion.scan_rate_hz;
    if motion.standing {
        let at = |k: usize| Stand {
            stamp_s: k as f64 * period_s,
            ..first
        };
        return Ok((0..motion.max_scans).map(at).collect());
    }
    Ok(sampled(&timed, motion, period_s))
}

/// Smooth ways from turn-back to turn-back; stops that cannot be reached are left out.
fn tour(plan: &Plan, terrain: &Terrain) -> Vec<Vec<Point>> {
    let stops: Vec<Point> = plan
        .stops()
        .iter()
        .filter_map(|&s| terrain.reachable_near(s))
        .collect();
    let ways = stops.windows(2).filter_map(|pair| terrain.way(pair[0], pair[1]));
    let mut joined: Vec<Vec<Point>> = Vec::new();
    for way in ways.filter(|way| way.len() >= 2) {
        match joined.last_mut() {
            Some(last) if turn_between(last, &way) < TURN_BACK_RAD => last.extend(way.into_iter().skip(1)),
            _ => joined.push(way),
        }
    }
    // Once more, now that the corners at the stops in between may be cut.
    joined.iter().map(|way| terrain.smooth(way)).collect()
}

/// Turn from the end of one way to the start of the next, over half a metre each, radians, 0 to π.
fn turn_between(before: &[Point], after: &[Point]) -> f64 {
    let steps = (0.5 / WAY_STEP_M) as usize;
    let stop = before[before.len() - 1];
    let arriving = stop - before[before.len().saturating_sub(1 + steps)];
    let leaving = after[steps.min(after.len() - 1)] - stop;
    wrap_rad(bearing_rad(leaving) - bearing_rad(arriving)).abs()
}

/// Poses along the ways with their times: as fast as speed and turning rate allow. The heading is the direction
/// of the way; between two ways the vehicle turns on the spot.
fn timed(ways: &[Vec<Point>], motion: &Motion) -> Vec<Stand> {
    let mut out: Vec<Stand> = Vec::new();
    for way in ways {
        for (k, &p) in way.iter().enumerate() {
            let (before, after) = (way[k.saturating_sub(1)], way[(k + 1).min(way.len() - 1)]);
            let pose = Pose::new(p.x, p.y, bearing_rad(after - before));
            let stamp_s = out.last().map_or(0.0, |last| {
                let from = last.world_from_laser;
                let turn_rad = wrap_rad(pose.theta_rad - from.theta_rad).abs();
                last.stamp_s + (from.distance(pose) / motion.speed_mps).max(turn_rad / motion.turn_radps)
            });
            out.push(Stand {
                stamp_s,
                world_from_laser: pose,
            });
        }
    }
    out
}

fn sampled(timed: &[Stand], motion: &Motion, period_s: f64) -> Vec<Stand> {
    let mut out: Vec<Stand> = Vec::new();
    let mut ahead = 0;
    for tick in 0.. {
        let stamp_s = f64::from(tick) * period_s;
        while ahead < timed.len() && timed[ahead].stamp_s < stamp_s {
            ahead += 1;
        }
        if ahead == timed.len() || out.len() >= motion.max_scans {
            break;
        }
        let pose = between(timed[ahead.saturating_sub(1)], timed[ahead], stamp_s);
        let keep = out.last().is_none_or(|last| {
            let from = last.world_from_laser;
            let turned_rad = wrap_rad(pose.theta_rad - from.theta_rad).abs();
            from.distance(pose) >= motion.step_m || turned_rad >= motion.step_rad
        });
        if keep {
            out.push(Stand {
                stamp_s,
                world_from_laser: pose,
            });
        }
    }
    out
}

fn between(a: Stand, b: Stand, stamp_s: f64) -> Pose {
    let lasting_s = b.stamp_s - a.stamp_s;
    let share = if lasting_s > 0.0 {
        (stamp_s - a.stamp_s) / lasting_s
    } else {
        1.0
    };
    let (from, to) = (a.world_from_laser, b.world_from_laser);
    let place = from.translation().lerp(to.translation(), share);
    let turn_rad = wrap_rad(to.theta_rad - from.theta_rad);
    Pose::new(place.x, place.y, from.theta_rad + share * turn_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::PlanKind;
    use crate::sides::SideGrid;
    use crate::terrain::CLEARANCE_M;

    fn tour_of(kind: PlanKind, seed: u64, motion: &Motion) -> (Plan, SideGrid, Vec<Stand>) {
        let plan = Plan::new(kind, seed);
        let walls = SideGrid::new(plan.walls());
        let terrain = Terrain::new(&plan, &walls).unwrap();
        let stands = stands(&plan, &terrain, motion).unwrap();
        (plan, walls, stands)
    }

    #[test]
    fn tours_keep_clear_of_walls_and_plants_and_turn_gently() {
        for kind in PlanKind::ALL {
            for seed in 0..3 {
                let (plan, walls, stands) = tour_of(kind, seed, &Motion::full_rate());
                assert!(stands.len() > 500, "{kind} {seed}: only {} scans", stands.len());
                for s in &stands {
                    let p = s.world_from_laser.translation();
                    let near = walls.nearest(p, CLEARANCE_M - 0.005);
                    assert_eq!(near, None, "{kind} {seed} at {p:?}");
                    for plant in plan.plants() {
                        assert!(plant.centre.distance(p) > plant.radius_m + CLEARANCE_M - 0.005);
                    }
                }
                for pair in stands.windows(2) {
                    let (a, b) = (pair[0].world_from_laser, pair[1].world_from_laser);
                    // Steps are short and clear at both ends, so the way between crosses no wall.
                    assert!(a.distance(b) < 0.0501);
                    assert!(wrap_rad(a.theta_rad - b.theta_rad).abs() < 0.08);
                    assert!(pair[1].stamp_s > pair[0].stamp_s);
                }
            }
        }
    }

    #[test]
    fn tours_see_most_stops_and_come_back_to_places() {
        for (kind, seed) in PlanKind::ALL.into_iter().flat_map(|kind| [(kind, 1), (kind, 6)]) {
            let (plan, _, stands) = tour_of(kind, seed, &Motion::full_rate());
            let places: Vec<Point> = stands.iter().map(|s| s.world_from_laser.translation()).collect();
            let called_at = |stop: &&Point| places.iter().any(|p| p.distance(**stop) < 1.6);
            let calls = plan.stops().iter().filter(called_at).count();
            let missed: Vec<_> = plan.stops().iter().filter(|s| !called_at(s)).collect();
            assert!(calls * 10 >= plan.stops().len() * 9, "{kind}: missed {missed:?}");
            let last = places.len() - 1;
            let again = (0..=last).any(|k| (k + 600..=last).any(|j| places[k].distance(places[j]) < 0.5));
            assert!(again, "{kind}: no place is seen twice a minute apart");
        }
    }

    #[test]
    fn keyframes_are_a_metre_or_forty_degrees_apart() {
        let (_, _, stands) = tour_of(PlanKind::Office, 1, &Motion::keyframes());
        assert!(stands.len() > 50 && stands.len() < 600, "{}", stands.len());
        for pair in stands.windows(2) {
            let (a, b) = (pair[0].world_from_laser, pair[1].world_from_laser);
            let (moved_m, turned_rad) = (a.distance(b), wrap_rad(a.theta_rad - b.theta_rad).abs());
            assert!(moved_m >= 1.0 || turned_rad >= TAU / 9.0);
            assert!(moved_m < 1.051 && turned_rad < TAU / 9.0 + 0.08);
        }
    }

    #[test]
    fn a_standing_scanner_stands() {
        let (_, _, stands) = tour_of(PlanKind::Clutter, 1, &Motion::standing(20));
        assert_eq!(stands.len(), 20);
        assert!(
            stands
                .iter()
                .all(|s| s.world_from_laser == stands[0].world_from_laser)
        );
        assert!((stands[19].stamp_s - 1.9).abs() < 1e-12);
    }
}
