//! From settings to a log with its truth: plan → tour → beams → ranges.

use polymapper_core::geometry::{Point, Polyline, Pose};
use polymapper_core::scan::{Scan, ScanGeometry};

use crate::dice::{Dice, Purpose, direction};
use crate::error::SimError;
use crate::motion::{Motion, Stand, stands};
use crate::odometry::OdometryNoise;
use crate::people::{Body, Walker, meet_disc, meet_leg};
use crate::plan::{Plan, PlanKind, Plant};
use crate::scanner::{Scanner, ScannerKind};
use crate::seen::SeenWalls;
use crate::sides::SideGrid;
use crate::terrain::Terrain;

/// Somebody nearer to the scanner than this is taken to step aside.
const STEPS_ASIDE_M: f64 = 0.35;
/// Neighbouring beams whose ranges differ by so much have an edge between them, at which a beam can be split;
/// beyond the second the two echoes are told apart.
const EDGE_M: (f64, f64) = (0.15, 3.0);
/// More people than this is a mistake.
const MOST_PEOPLE: usize = 1000;

/// Everything that a simulated log depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimSettings {
    /// Kind of floor plan.
    pub plan: PlanKind,
    /// Seed of plan, people, noise and odometry.
    pub seed: u64,
    /// The scanner and its faults.
    pub scanner: Scanner,
    /// How it is carried, and which scans are kept.
    pub motion: Motion,
    /// Number of people who walk about.
    pub people: usize,
    /// Wheel odometry; none: the log says (0, 0, 0) throughout.
    pub odometry: Option<OdometryNoise>,
}

impl SimSettings {
    /// A SICK 180° scanner at full rate, with drifting odometry and nobody about.
    #[must_use]
    pub fn new(plan: PlanKind, seed: u64) -> Self {
        Self {
            plan,
            seed,
            scanner: Scanner::new(ScannerKind::Sick180),
            motion: Motion::full_rate(),
            people: 0,
            odometry: Some(OdometryNoise::default()),
        }
    }

    fn check(&self) -> Result<(), SimError> {
        self.scanner.check()?;
        self.motion.check()?;
        if self.people > MOST_PEOPLE {
            return Err(SimError::Setting {
                name: "people",
                value: self.people as f64,
                range: "1000 or fewer",
            });
        }
        self.odometry.map_or(Ok(()), |noise| noise.check())
    }
}

/// What a beam hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hit {
    /// Nothing within reach, or the beam dropped out: no range was logged.
    Nothing,
    /// A wall or furniture: the side with this number, counted through all walls in order.
    Wall(u32),
    /// A leg of the person with this number.
    Person(u32),
    /// A leaf of the plant with this number.
    Plant(u32),
    /// Two things at an edge: the range lies between them, where nothing is.
    Mixed,
}

/// A simulated log and the truth about it.
#[derive(Clone, Debug)]
pub struct SimLog {
    /// What it was made from.
    pub settings: SimSettings,
    /// Bearings and limits of the scanner.
    pub geometry: ScanGeometry,
    /// The scans, in the order they were taken.
    pub scans: Vec<Scan>,
    /// When, seconds from the start of the tour.
    pub stamps_s: Vec<f64>,
    /// Where: `world_from_laser`, exact.
    pub truth_poses: Vec<Pose>,
    /// Where the wheels say: `odom_from_laser`; empty without odometry.
    pub odometry: Vec<Pose>,
    /// What every beam of every scan hit.
    pub hits: Vec<Vec<Hit>>,
    /// Where every person was at every scan, world frame.
    pub people: Vec<Vec<Point>>,
    /// The floor plan: walls and plants.
    pub plan: Plan,
    /// Which pieces of its walls returned a beam.
    pub seen: SeenWalls,
}

/// Simulates a log; the same settings give the same log on every platform.
///
/// # Errors
/// A setting that makes no sense.
pub fn simulate(settings: &SimSettings) -> Result<SimLog, SimError> {
    settings.check()?;
    let plan = Plan::new(settings.plan, settings.seed);
    let walls = SideGrid::new(plan.walls());
    let terrain = Terrain::new(&plan, &walls).ok_or(SimError::NoRoom {
        plan: settings.plan.name(),
        seed: settings.seed,
    })?;
    let stands = stands(&plan, &terrain, &settings.motion)?;
    let walkers = walkers(settings, &terrain, &stands);
    let truth_poses: Vec<Pose> = stands.iter().map(|s| s.world_from_laser).collect();
    let odometry = settings
        .odometry
        .map(|noise| noise.measured(&truth_poses, settings.seed));
    let mut log = SimLog {
        settings: *settings,
        geometry: settings.scanner.geometry()?,
        scans: Vec::with_capacity(stands.len()),
        stamps_s: stands.iter().map(|s| s.stamp_s).collect(),
        truth_poses,
        odometry: odometry.unwrap_or_default(),
        hits: Vec::with_capacity(stands.len()),
        people: Vec::with_capacity(stands.len()),
        seen: SeenWalls::nothing(plan.walls()),
        plan,
    };
    let mut dice = Dice::new(settings.seed, Purpose::Scanner);
    for (number, stand) in stands.iter().enumerate() {
        let bodies: Vec<Body> = walkers.iter().map(|w| w.body(stand.stamp_s)).collect();
        let world = World {
            walls: &walls,
            plants: log.plan.plants(),
            bodies: &bodies,
        };
        let motion = motion_at(&log.truth_poses, number);
        let mut beams = world.scan(
            &settings.scanner,
            log.geometry,
            stand.world_from_laser,
            motion,
            &mut dice,
        );
        let ranges_m = beams.iter().map(|b| b.range_m.unwrap_or(f64::NAN)).collect();
        let scan = Scan::new(log.geometry, ranges_m)?;
        // A true range that happens to be a no-return code is lost as well.
        for (beam, _) in beams.iter_mut().zip(scan.ranges_m()).filter(|(_, r)| r.is_nan()) {
            beam.hit = Hit::Nothing;
        }
        mark_seen(&beams, log.geometry.is_full_circle(), &mut log.seen);
        log.scans.push(scan);
        log.hits.push(beams.into_iter().map(|b| b.hit).collect());
        log.people.push(bodies.iter().map(|b| b.centre).collect());
    }
    Ok(log)
}

impl SimLog {
    /// The walls, world frame, free space on their left.
    #[must_use]
    pub fn walls(&self) -> &[Polyline] {
        self.plan.walls()
    }
}

/// The motion from scan to scan about scan `number`, in the scanner's frame: half of the way from the one before to the one after.
fn motion_at(poses: &[Pose], number: usize) -> Pose {
    let (before, after) = (number.saturating_sub(1), (number + 1).min(poses.len() - 1));
    let motion = poses[before].inverse() * poses[after];
    motion.scaled(1.0 / (after - before).max(1) as f64)
}

fn walkers(settings: &SimSettings, terrain: &Terrain, stands: &[Stand]) -> Vec<Walker> {
    let mut dice = Dice::new(settings.seed, Purpose::People);
    let lasting_s = stands.last().map_or(0.0, |s| s.stamp_s);
    let all = (0..settings.people).map(|_| Walker::new(terrain, &mut dice, lasting_s));
    all.flatten().collect()
}

/// Everything that can stop a beam at one moment.
struct World<'a> {
    walls: &'a SideGrid,
    plants: &'a [Plant],
    bodies: &'a [Body],
}

/// What became of a beam.
struct Beam {
    true_m: Option<f64>,
    range_m: Option<f64>,
    hit: Hit,
    /// Share of the side that was hit.
    share: f64,
}

impl World<'_> {
    /// `motion` is the scanner's from scan to scan, in its own frame.
    fn scan(
        &self,
        scanner: &Scanner,
        geometry: ScanGeometry,
        at: Pose,
        motion: Pose,
        dice: &mut Dice,
    ) -> Vec<Beam> {
        let mut beams: Vec<Beam> = (0..geometry.beams())
            .map(|k| {
                let off_rad = dice.normal() * scanner.bearing_noise_rad;
                let bearing_rad = geometry.bearing_rad(k);
                let here = at * motion.scaled(scanner.sweep_ratio * geometry.turns_from_middle(bearing_rad));
                let towards = direction(here.theta_rad + bearing_rad + off_rad);
                self.beam(here.translation(), towards, scanner.max_range_m, dice)
            })
            .collect();
        mix_pixels(&mut beams, scanner.mixed_pixel_ratio, dice);
        for beam in &mut beams {
            beam.range_m = scanner.logged_m(beam.true_m, dice);
        }
        beams
    }

    /// The first thing along a ray.
    fn beam(&self, origin: Point, towards: Point, reach_m: f64, dice: &mut Dice) -> Beam {
        let wall = self.walls.cast(origin, towards, reach_m);
        let mut nearest_m = wall.map_or(reach_m, |h| h.range_m);
        let mut hit = wall.map_or(Hit::Nothing, |h| Hit::Wall(h.side as u32));
        for (k, plant) in self.plants.iter().enumerate() {
            // Drawn in any case, so that people in the way do not change what other beams meet.
            if let Some(leaf_m) = meet_leaf(plant, origin, towards, dice).filter(|&t| t < nearest_m) {
                (nearest_m, hit) = (leaf_m, Hit::Plant(k as u32));
            }
        }
        for (k, body) in self.bodies.iter().enumerate() {
            if body.centre.distance(origin) < STEPS_ASIDE_M {
                continue;
            }
            for leg in body.legs {
                if let Some(leg_m) = meet_leg(leg, origin, towards).filter(|&t| t < nearest_m) {
                    (nearest_m, hit) = (leg_m, Hit::Person(k as u32));
                }
            }
        }
        Beam {
            true_m: (hit != Hit::Nothing).then_some(nearest_m),
            range_m: None,
            hit,
            share: wall.map_or(0.0, |h| h.share),
        }
    }
}

/// Where a ray ends in a plant: at an exponentially spread depth behind where it enters the leaves; `None` when it
/// passes by or gets through.
fn meet_leaf(plant: &Plant, origin: Point, towards: Point, dice: &mut Dice) -> Option<f64> {
    let (enters_m, leaves_m) = meet_disc(plant.centre, plant.radius_m, origin, towards)?;
    let leaf_m = enters_m.max(0.0) + dice.exponential(plant.depth_m);
    (leaf_m < leaves_m).then_some(leaf_m)
}

/// Puts some of the beams beside an edge between the two sides of it.
fn mix_pixels(beams: &mut [Beam], ratio: f64, dice: &mut Dice) {
    if ratio <= 0.0 {
        return;
    }
    for k in 1..beams.len() {
        let (mixed, share) = (dice.chance(ratio), dice.share());
        if let (Some(before_m), Some(here_m)) = (beams[k - 1].true_m, beams[k].true_m) {
            let jump_m = (here_m - before_m).abs();
            if mixed && beams[k - 1].hit != Hit::Mixed && jump_m > EDGE_M.0 && jump_m < EDGE_M.1 {
                beams[k].true_m = Some(before_m + (here_m - before_m) * share);
                beams[k].hit = Hit::Mixed;
            }
        }
    }
}

fn mark_seen(beams: &[Beam], full_circle: bool, seen: &mut SeenWalls) {
    for (k, beam) in beams.iter().enumerate() {
        let Hit::Wall(side) = beam.hit else { continue };
        seen.hit(side as usize, beam.share);
        let next = match beams.get(k + 1) {
            Some(next) => next,
            None if full_circle => &beams[0],
            None => continue,
        };
        if next.hit == beam.hit {
            seen.hit_pair(side as usize, beam.share, next.share);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keyframes(plan: PlanKind, kind: ScannerKind) -> SimSettings {
        SimSettings {
            scanner: Scanner::new(kind),
            motion: Motion::keyframes(),
            ..SimSettings::new(plan, 4)
        }
    }

    #[test]
    fn without_noise_every_point_lies_on_the_wall_it_names() {
        for plan in PlanKind::ALL {
            let mut settings = keyframes(plan, ScannerKind::Hokuyo240);
            settings.scanner = Scanner {
                noise_m: 0.0,
                noise_per_m_ratio: 0.0,
                ..settings.scanner
            };
            let log = simulate(&settings).unwrap();
            let sides: Vec<_> = log.walls().iter().flat_map(Polyline::sides).collect();
            let mut walls = 0;
            for ((scan, pose), hits) in log.scans.iter().zip(&log.truth_poses).zip(&log.hits) {
                for (beam, point) in scan.points() {
                    if let Hit::Wall(side) = hits[beam] {
                        let point = *pose * point;
                        let side = sides[side as usize];
                        // Half a millimetre of rounding along the beam.
                        assert!(side.distance(point) < 0.0006, "{plan}");
                        let to_scanner = pose.translation() - side.a;
                        assert!((side.b - side.a).cross(to_scanner) > 0.0, "seen from its left");
                        walls += 1;
                    }
                }
            }
            assert!(walls > 10_000, "{plan}: {walls}");
        }
    }

    #[test]
    fn scans_and_hits_agree_on_what_returned() {
        let mut settings = keyframes(PlanKind::Clutter, ScannerKind::LowCost360);
        settings.people = 4;
        let log = simulate(&settings).unwrap();
        let (mut people, mut plants, mut nothing, mut all) = (0, 0, 0, 0);
        for (scan, hits) in log.scans.iter().zip(&log.hits) {
            for (range, hit) in scan.ranges_m().iter().zip(hits) {
                assert_eq!(range.is_nan(), *hit == Hit::Nothing);
                all += 1;
                match hit {
                    Hit::Nothing => nothing += 1,
                    Hit::Person(_) => people += 1,
                    Hit::Plant(_) => plants += 1,
                    _ => {}
                }
            }
        }
        assert!(people > 50 && plants > 200, "{people} {plants}");
        let dropouts = f64::from(nothing) / f64::from(all);
        assert!((dropouts - 0.17).abs() < 0.02, "{dropouts}");
    }

    #[test]
    fn points_on_people_lie_on_their_legs() {
        let settings = SimSettings {
            motion: Motion::standing(200),
            people: 3,
            ..SimSettings::new(PlanKind::Clutter, 2)
        };
        let log = simulate(&settings).unwrap();
        let mut hits = 0;
        for (k, scan) in log.scans.iter().enumerate() {
            for (beam, point) in scan.points() {
                if let Hit::Person(person) = log.hits[k][beam] {
                    let centre = log.people[k][person as usize];
                    assert!(centre.distance(log.truth_poses[k] * point) < 0.4);
                    hits += 1;
                }
            }
        }
        assert!(hits > 200, "{hits}");
    }

    #[test]
    fn plants_have_no_stable_shape() {
        let settings = SimSettings {
            motion: Motion::standing(60),
            ..SimSettings::new(PlanKind::Clutter, 1)
        };
        let log = simulate(&settings).unwrap();
        let spread = |wanted: fn(Hit) -> bool| {
            let mut widest: f64 = 0.0;
            for beam in 0..log.geometry.beams() {
                let scans = log
                    .scans
                    .iter()
                    .zip(&log.hits)
                    .filter(|(_, hits)| wanted(hits[beam]));
                let ranges: Vec<f64> = scans.map(|(scan, _)| scan.ranges_m()[beam]).collect();
                let low = ranges.iter().copied().fold(f64::INFINITY, f64::min);
                let high = ranges.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                widest = widest.max(high - low);
            }
            widest
        };
        assert!(spread(|h| matches!(h, Hit::Plant(_))) > 0.2);
        assert!(spread(|h| matches!(h, Hit::Wall(_))) < 0.1);
    }

    #[test]
    fn mixed_pixels_lie_where_nothing_is() {
        let mut settings = keyframes(PlanKind::Office, ScannerKind::Sick180);
        settings.scanner.mixed_pixel_ratio = 0.5;
        let log = simulate(&settings).unwrap();
        let mixed = log.hits.iter().flatten().filter(|h| **h == Hit::Mixed).count();
        assert!(mixed > 100, "{mixed}");
    }

    #[test]
    fn people_change_nothing_but_the_beams_that_they_stop() {
        let alone = simulate(&keyframes(PlanKind::Clutter, ScannerKind::Sick180)).unwrap();
        let mut settings = keyframes(PlanKind::Clutter, ScannerKind::Sick180);
        settings.people = 2;
        let crowded = simulate(&settings).unwrap();
        assert_eq!(alone.truth_poses, crowded.truth_poses);
        assert_eq!(alone.odometry, crowded.odometry);
        for (k, hits) in crowded.hits.iter().enumerate() {
            for (beam, hit) in hits.iter().enumerate() {
                if !matches!(hit, Hit::Person(_)) {
                    let (a, b) = (alone.scans[k].ranges_m()[beam], crowded.scans[k].ranges_m()[beam]);
                    assert_eq!(a.to_bits(), b.to_bits());
                }
            }
        }
    }
}
