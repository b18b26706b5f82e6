//! Floor plans drawn from a kind and a seed.
//!
//! In: [`PlanKind`] and a seed. Out: a [`Plan`]: walls and furniture as closed polylines at the height of the
//! scanner, plants, and the places that a tour calls at. Every measure that differs from building to building
//! is drawn at random; the same kind and seed give the same plan on every platform.

mod clutter;
mod corridor_loop;
mod furniture;
mod oblique;
mod office;
mod warehouse;

use std::fmt;
use std::str::FromStr;

use polymapper_core::geometry::{Point, Polyline};

use crate::dice::{Dice, Purpose};
use crate::error::SimError;
use crate::floor::{Floor, bounds};

/// What sort of place a plan shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PlanKind {
    /// `office`: rooms on both sides of a corridor, doors (some shut, some with the leaf standing open), doors
    /// from room to room, desks, cupboards, chairs, bins. About 30 m by 13 m.
    Office,
    /// `corridor-loop`: four bare corridors round a block, door niches the only features. About 35 m by 20 m.
    CorridorLoop,
    /// `warehouse`: a hall with rows of racks (uprights, pallets), pillars, gates and stacks. About 36 m by 24 m.
    Warehouse,
    /// `oblique`: a ring-shaped corridor round a round hall with a pillar, passages at odd angles, rooms with
    /// oblique walls and an apse. Hardly a right angle. About 32 m across.
    Oblique,
    /// `clutter`: two rooms full of small things: chair legs, table legs, boxes at every angle, bins, and plants
    /// that return at random depths. About 14 m by 10 m.
    Clutter,
}

impl PlanKind {
    /// Every kind, in the order of the documentation.
    pub const ALL: [Self; 5] = [
        Self::Office,
        Self::CorridorLoop,
        Self::Warehouse,
        Self::Oblique,
        Self::Clutter,
    ];

    /// The name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Office => "office",
            Self::CorridorLoop => "corridor-loop",
            Self::Warehouse => "warehouse",
            Self::Oblique => "oblique",
            Self::Clutter => "clutter",
        }
    }
}

impl fmt::Display for PlanKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for PlanKind {
    type Err = SimError;

    fn from_str(name: &str) -> Result<Self, SimError> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| SimError::UnknownName {
            what: "plan",
            name: name.to_owned(),
            known: Self::ALL.map(Self::name).join(", "),
        })
    }
}

/// A plant: leaves inside a circle, hit at random depths, so that it has no stable shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// Middle, world frame, metres.
    pub centre: Point,
    /// Radius of the leaves, metres.
    pub radius_m: f64,
    /// Mean depth that a beam gets into the leaves, metres.
    pub depth_m: f64,
}

/// A floor plan at the height of the scanner.
#[derive(Clone, Debug)]
pub struct Plan {
    kind: PlanKind,
    seed: u64,
    walls: Vec<Polyline>,
    plants: Vec<Plant>,
    stops: Vec<Point>,
    min: Point,
    max: Point,
}

impl Plan {
    /// Draws the plan of this kind and seed.
    #[must_use]
    pub fn new(kind: PlanKind, seed: u64) -> Self {
        let mut dice = Dice::new(seed, Purpose::Plan);
        let drawing = match kind {
            PlanKind::Office => office::draw(&mut dice),
            PlanKind::CorridorLoop => corridor_loop::draw(&mut dice),
            PlanKind::Warehouse => warehouse::draw(&mut dice),
            PlanKind::Oblique => oblique::draw(&mut dice),
            PlanKind::Clutter => clutter::draw(&mut dice),
        };
        let walls = drawing.floor.walls();
        let corners: Vec<Point> = walls.iter().flat_map(|w| w.vertices().iter().copied()).collect();
        let (min, max) = bounds(&corners);
        Self {
            kind,
            seed,
            walls,
            plants: drawing.plants,
            stops: drawing.stops,
            min,
            max,
        }
    }

    /// Its kind.
    #[must_use]
    pub fn kind(&self) -> PlanKind {
        self.kind
    }

    /// The seed it was drawn from.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Walls and furniture: closed polylines (the last vertex repeats the first) with free space on their left.
    /// World frame, metres. A wall between two rooms has a thickness, and a polyline on each side.
    #[must_use]
    pub fn walls(&self) -> &[Polyline] {
        &self.walls
    }

    /// Plants; part of no wall.
    #[must_use]
    pub fn plants(&self) -> &[Plant] {
        &self.plants
    }

    /// Places that a tour calls at, in this order; the first is where it starts. One that cannot be reached is
    /// left out of the tour.
    #[must_use]
    pub fn stops(&self) -> &[Point] {
        &self.stops
    }

    /// Corners of the box round all walls: smallest and largest coordinates, metres.
    #[must_use]
    pub fn bounds(&self) -> (Point, Point) {
        (self.min, self.max)
    }
}

/// What the draughtsman of a kind hands over.
#[derive(Default)]
struct Drawing {
    floor: Floor,
    plants: Vec<Plant>,
    stops: Vec<Point>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for kind in PlanKind::ALL {
            assert_eq!(kind.to_string().parse::<PlanKind>().unwrap(), kind);
        }
        let error = "castle".parse::<PlanKind>().unwrap_err().to_string();
        assert!(
            error.contains("castle") && error.contains("corridor-loop"),
            "{error}"
        );
    }

    #[test]
    fn seeds_differ_and_repeat() {
        for kind in PlanKind::ALL {
            let (a, b, c) = (Plan::new(kind, 1), Plan::new(kind, 1), Plan::new(kind, 2));
            assert_eq!(a.walls(), b.walls(), "{kind}");
            assert_ne!(a.walls(), c.walls(), "{kind}");
        }
    }

    /// The winding number tells free (1: inside the outer wall and outside of things) from solid (0), whatever
    /// drew the walls.
    fn winding(plan: &Plan, p: Point) -> i64 {
        let sides = plan.walls().iter().flat_map(Polyline::sides);
        sides
            .map(
                |s| match (s.a.y > p.y, s.b.y > p.y, (s.b - s.a).cross(p - s.a) > 0.0) {
                    (false, true, true) => 1,
                    (true, false, false) => -1,
                    _ => 0,
                },
            )
            .sum()
    }

    #[test]
    fn every_wall_has_free_space_on_its_left_and_is_solid_on_its_right() {
        for kind in PlanKind::ALL {
            for seed in 0..20 {
                let plan = Plan::new(kind, seed);
                for wall in plan.walls() {
                    assert_eq!(wall.first(), wall.last(), "{kind} {seed}: a wall does not close");
                    for side in wall.sides() {
                        let left = side.direction().unwrap().left() * 1e-6;
                        assert_eq!(winding(&plan, side.at(0.5) + left), 1, "{kind} {seed} {side:?}");
                        assert_eq!(winding(&plan, side.at(0.5) - left), 0, "{kind} {seed} {side:?}");
                    }
                }
                for &stop in plan.stops() {
                    assert_eq!(winding(&plan, stop), 1, "{kind} {seed}: a stop inside a wall");
                }
            }
        }
    }
}
