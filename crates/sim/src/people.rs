//! People who walk about: two legs each, as a scanner at shin height sees them.
//!
//! Each walks at a steady speed from one random place to the next, round obstacles, from the first scan to the
//! last. They do not give way to each other or to the vehicle; whoever would step onto the scanner is taken to
//! step aside and is not seen for that moment.

use std::f64::consts::TAU;

use polymapper_core::geometry::Point;

use crate::dice::Dice;
use crate::terrain::{Terrain, WAY_STEP_M};

/// Radius of a lower leg.
const LEG_RADIUS_M: f64 = 0.06;
/// Half the distance between the legs, across the direction of walking.
const HALF_STANCE_M: f64 = 0.1;
/// How far a leg swings ahead of and behind the body.
const SWING_M: f64 = 0.22;
/// Length of two steps.
const STRIDE_M: f64 = 1.4;

/// Somebody walking.
pub(crate) struct Walker {
    way: Vec<Point>,
    speed_mps: f64,
}

/// Where somebody is at some moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Body {
    pub(crate) centre: Point,
    pub(crate) legs: [Point; 2],
}

/// Somebody's leg as a disc: the distance along the ray at which the ray enters it.
pub(crate) fn meet_leg(leg: Point, origin: Point, direction: Point) -> Option<f64> {
    meet_disc(leg, LEG_RADIUS_M, origin, direction)
        .map(|(enters, _)| enters)
        .filter(|&t| t > 0.0)
}

/// Where a ray (direction of length 1) enters and leaves a disc, the disc lying ahead at least in part.
pub(crate) fn meet_disc(centre: Point, radius_m: f64, origin: Point, direction: Point) -> Option<(f64, f64)> {
    let to_centre = centre - origin;
    let along = to_centre.dot(direction);
    let across = to_centre.cross(direction);
    let half_squared = radius_m * radius_m - across * across;
    if half_squared <= 0.0 {
        return None;
    }
    let half = half_squared.sqrt();
    (along + half > 0.0).then_some((along - half, along + half))
}

impl Walker {
    /// Somebody who starts anywhere and keeps walking for at least `lasting_s` seconds.
    pub(crate) fn new(terrain: &Terrain, dice: &mut Dice, lasting_s: f64) -> Option<Self> {
        let speed_mps = dice.between(0.9, 1.4);
        let mut random_place = || terrain.reachable_place((dice.share() * 1e9) as usize);
        let mut here = random_place()?;
        let mut way = vec![here];
        // Every other place is some metres away; the bound only guards against a floor of a single cell.
        for _ in 0..10_000 {
            if way.len() as f64 * WAY_STEP_M > speed_mps * lasting_s + 1.0 {
                break;
            }
            let next = random_place()?;
            if let Some(leg) = terrain.way(here, next) {
                way.extend(leg.into_iter().skip(1));
                here = next;
            }
        }
        Some(Self { way, speed_mps })
    }

    /// Where this person is at `time_s`.
    pub(crate) fn body(&self, time_s: f64) -> Body {
        let walked_m = self.speed_mps * time_s;
        let last = self.way.len() - 1;
        let at = (walked_m / WAY_STEP_M).clamp(0.0, last as f64);
        let k = (at as usize).min(last.saturating_sub(1));
        let next = (k + 1).min(last);
        let centre = self.way[k].lerp(self.way[next], at - k as f64);
        // Half a step around, so that the legs do not jump where the way bends.
        let (behind, ahead) = (self.way[k.saturating_sub(4)], self.way[(k + 4).min(last)]);
        let heading = (ahead - behind).unit().unwrap_or(Point::new(1.0, 0.0));
        let swing = heading * (SWING_M * libm::sin(TAU * walked_m / STRIDE_M));
        let stance = heading.left() * HALF_STANCE_M;
        Body {
            centre,
            legs: [centre + stance + swing, centre - stance - swing],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::Purpose;
    use crate::plan::{Plan, PlanKind};
    use crate::sides::SideGrid;

    #[test]
    fn a_ray_enters_a_leg_at_its_near_side() {
        let ahead = Point::new(1.0, 0.0);
        let entered = meet_leg(Point::new(2.0, 0.0), Point::default(), ahead).unwrap();
        assert!((entered - (2.0 - LEG_RADIUS_M)).abs() < 1e-12);
        assert_eq!(meet_leg(Point::new(2.0, 0.07), Point::default(), ahead), None);
        assert_eq!(meet_leg(Point::new(-2.0, 0.0), Point::default(), ahead), None);
    }

    #[test]
    fn people_walk_at_walking_speed_and_not_through_walls() {
        let plan = Plan::new(PlanKind::Office, 3);
        let walls = SideGrid::new(plan.walls());
        let terrain = Terrain::new(&plan, &walls).unwrap();
        let mut dice = Dice::new(3, Purpose::People);
        let walker = Walker::new(&terrain, &mut dice, 60.0).unwrap();
        let (mut before, mut walked_m) = (walker.body(0.0), 0.0);
        for k in 1..=600 {
            let body = walker.body(0.1 * f64::from(k));
            walked_m += before.centre.distance(body.centre);
            assert_eq!(walls.nearest(body.centre, 0.3), None);
            before = body;
        }
        assert!((50.0..=85.0).contains(&walked_m), "{walked_m} m in a minute");
    }
}
