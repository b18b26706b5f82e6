use super::Information;
use crate::geometry::{Near, Point, Pose, SideGrid, wrap_rad};

/// A return and the direction of the scan side it lies on.
#[derive(Clone, Copy, Debug)]
pub struct SidePoint {
    /// Laser frame, metres.
    pub point: Point,
    /// Unit vector along the side, laser frame.
    pub direction: Point,
    /// Standard deviation of the distance to the side, metres.
    pub sigma_m: f64,
    /// How much of an independent measurement it is, 0..=1. The errors of the returns of one wall go together
    /// (the wall is not quite straight, the map's side not quite in place), so a hundred of them do not tell a
    /// hundred times as much as one.
    pub worth: f64,
    /// Whether its side is so short that the direction is not known, in a scan that shows little else: it may lie on any side that
    /// faces the same way.
    pub is_on_short_side: bool,
    /// Which polyline of the scan it belongs to.
    pub polyline: u32,
}

/// What is expected of the pose before the walls are asked.
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    /// Expected pose.
    pub map_from_scan: Pose,
    /// Its information, map axes, turn about the scanner.
    pub information: Information,
}

/// The ends of a side lie this far off the wall, metres: so its direction is known the worse the shorter it is.
const SIDE_END_M: f64 = 0.02;
/// Errors of direction are the same from scan to scan, other than the noise of returns: they count so many times.
const DIRECTIONS_LAST: f64 = 3.0;
/// Share of the guess's doubt from which on directions are judged: before, all of them are off by the heading.
const DOUBT_OF_DIRECTIONS: f64 = 0.1;

/// How the alignment goes about it.
#[derive(Clone, Copy, Debug)]
pub struct AlignSettings {
    /// Gate that no round exceeds, metres.
    pub widest_gate_m: f64,
    /// Gate of the last rounds, metres. 0.10 m is five times the noise of a cheap scanner.
    pub last_gate_m: f64,
    /// Rounds at most.
    pub max_rounds: u32,
    /// Scale of the Cauchy weight in standard deviations; 2.385 keeps 95 % efficiency on Gaussian noise.
    pub robust_sigmas: f64,
    /// A direction along which the walls leave the place with a larger standard deviation than this, metres, is
    /// named unobservable. Two walls parallel to 2° leave 0.05 m and more; one door frame leaves 0.01 m.
    pub observable_sigma_m: f64,
    /// A heading that the walls leave with a larger standard deviation than this, radians, is not told by them: it puts a wall 2 m off
    /// as far out of place as `observable_sigma_m` does. Walls that a scanner sees at all tell it to 0.001 to 0.005.
    pub observable_sigma_rad: f64,
}

impl Default for AlignSettings {
    fn default() -> Self {
        Self {
            widest_gate_m: 0.5,
            last_gate_m: 0.10,
            max_rounds: 20,
            robust_sigmas: 2.385,
            observable_sigma_m: 0.04,
            observable_sigma_rad: 0.02,
        }
    }
}

/// A pose to start from, and how far off it may be.
#[derive(Clone, Copy, Debug)]
pub struct Guess {
    /// The pose.
    pub map_from_scan: Pose,
    /// Standard deviation of its place, metres.
    pub sigma_m: f64,
    /// Standard deviation of its heading, radians.
    pub sigma_rad: f64,
}

impl Guess {
    /// The guess as a prior.
    #[must_use]
    pub fn prior(&self) -> Prior {
        Prior {
            map_from_scan: self.map_from_scan,
            information: Information::from_sigmas(self.sigma_m, self.sigma_m, self.sigma_rad),
        }
    }
}

/// A pose and how good it is.
#[derive(Clone, Copy, Debug)]
pub struct Alignment {
    /// The scanner in the map.
    pub map_from_scan: Pose,
    /// Information of the walls alone (no prior), map axes, turn about the scanner.
    pub information: Information,
    /// Direction (unit vector, map frame) along which the walls cannot tell the place.
    pub unobservable: Option<Point>,
    /// Whether the steps became negligible before the rounds ran out.
    pub converged: bool,
    /// Rounds taken.
    pub rounds: u32,
    /// Returns that found a side within the last gate.
    pub matched: usize,
    /// Returns asked.
    pub asked: usize,
    /// Root mean square distance of the matched returns to their sides, metres.
    pub rms_m: f64,
}

impl Alignment {
    /// Share of the returns that found a side, 0..=1.
    #[must_use]
    pub fn matched_share(&self) -> f64 {
        if self.asked == 0 {
            0.0
        } else {
            self.matched as f64 / self.asked as f64
        }
    }
}

/// Aligns `points` to the sides in `target`, starting at `guess`; `allowed(scan polyline, map polyline)` limits
/// the pairs to matched polylines. `None` when no return finds a side or nothing determines the pose.
pub(crate) fn align_to_grid(
    points: &[SidePoint],
    target: &SideGrid,
    allowed: impl Fn(u32, u32) -> bool,
    guess: &Guess,
    prior: Option<&Prior>,
    settings: &AlignSettings,
) -> Option<Alignment> {
    let mut pose = guess.map_from_scan;
    let mut doubt = 1.0;
    let mut converged = false;
    let mut rounds = 0;
    let mut last = Round::default();
    // How far off the guess puts each return.
    let off_m: Vec<f64> = points
        .iter()
        .map(|p| 3.0 * guess.sigma_m.hypot(guess.sigma_rad * p.point.norm()))
        .collect();
    while rounds < settings.max_rounds && !converged {
        rounds += 1;
        let gate = |off_m: f64| (settings.last_gate_m + doubt * off_m).min(settings.widest_gate_m);
        let gated = points.iter().zip(off_m.iter().map(|&off_m| gate(off_m)));
        last = Round {
            directions: (doubt < DOUBT_OF_DIRECTIONS).then(Directions::default),
            ..Round::default()
        };
        last.pair(gated, target, &allowed, pose, settings);
        last.discount_directions();
        let step = last.step(pose, prior)?;
        pose = Pose::new(pose.x + step[0], pose.y + step[1], pose.theta_rad + step[2]);
        let (shift_m, turn_rad) = (step[0].hypot(step[1]), step[2].abs());
        converged = doubt < 0.05 && shift_m < 2e-4 && turn_rad < 2e-5;
        if shift_m < 0.5 * guess.sigma_m + 0.02 && turn_rad < 0.5 * guess.sigma_rad + 0.005 {
            doubt *= 0.4;
        }
    }
    (last.matched > 0).then(|| Alignment {
        map_from_scan: pose,
        information: last.information,
        unobservable: last.unobservable(settings.observable_sigma_m),
        converged,
        rounds,
        matched: last.matched,
        asked: points.len(),
        rms_m: (last.squares_m2 / last.matched as f64).sqrt(),
    })
}

/// The normal equations of one round.
#[derive(Default)]
struct Round {
    information: Information,
    /// `None` while directions are not judged.
    directions: Option<Directions>,
    /// Σ w j e / σ²
    gradient: [f64; 3],
    matched: usize,
    squares_m2: f64,
}

impl Round {
    /// The direction along which the walls leave a standard deviation above `sigma_m`.
    fn unobservable(&self, sigma_m: f64) -> Option<Point> {
        let (direction, information) = self.information.weakest_direction();
        (information < 1.0 / (sigma_m * sigma_m)).then_some(direction)
    }

    /// Takes out what sides seem to tell by being out of line with their walls: see the module.
    fn discount_directions(&mut self) {
        let Some(directions) = &self.directions else {
            return;
        };
        let seeming = directions.seeming().scaled(DIRECTIONS_LAST);
        let kept = self.information.discounted_by(&seeming, self.gradient);
        if let Some((information, gradient)) = kept {
            (self.information, self.gradient) = (information, gradient);
        }
    }

    /// Pairs returns, each with its gate, with the sides nearest to them.
    fn pair<'a>(
        &mut self,
        points: impl Iterator<Item = (&'a SidePoint, f64)>,
        target: &SideGrid,
        allowed: &impl Fn(u32, u32) -> bool,
        pose: Pose,
        settings: &AlignSettings,
    ) {
        let map_from_scan = pose.isometry();
        let mut reader = target.reader();
        for (p, gate_m) in points {
            // A wide gate comes with a poor heading: sides may then differ by more.
            let min_cos = match (p.is_on_short_side, gate_m > 0.25) {
                (true, _) => 0.3,
                (false, true) => 0.7,
                (false, false) => 0.85,
            };
            let arm = map_from_scan.rotate(p.point);
            let place = arm + map_from_scan.translation();
            let near = Near {
                direction: map_from_scan.rotate(p.direction),
                min_cos,
                max_distance_m: gate_m,
                beyond_ends: false,
            };
            let Some(foot) = reader.nearest(place, &near, |owner| allowed(p.polyline, owner)) else {
                continue;
            };
            let side = target.side(foot.side);
            let error_m = side.normal().dot(place - foot.point);
            let direction = reader.along(foot.side, foot.share);
            let normal = direction.left();
            // The scale follows the gate, so that poor guesses are not weighted away in the first rounds.
            let scale_m = settings.robust_sigmas * p.sigma_m.max(0.2 * (gate_m - settings.last_gate_m));
            let weight = 1.0 / (1.0 + (error_m / scale_m).powi(2));
            let j = [normal.x, normal.y, normal.dot(arm.left())];
            let w = weight * p.worth / (p.sigma_m * p.sigma_m);
            self.information.add_residual(j, w);
            if let Some(directions) = &mut self.directions {
                let along = [direction.x, direction.y, direction.dot(arm.left())];
                let turned = normal.dot(near.direction);
                directions.add(along, w, turned, SIDE_END_M / reader.told_by_m(foot.side));
            }
            for (g, j) in self.gradient.iter_mut().zip(j) {
                *g += w * j * error_m;
            }
            self.matched += 1;
            self.squares_m2 += error_m * error_m;
        }
    }

    /// The Gauss–Newton step of the walls and the prior together.
    fn step(&self, pose: Pose, prior: Option<&Prior>) -> Option<[f64; 3]> {
        let Some(prior) = prior else {
            return self.information.solve(self.gradient.map(|g| -g));
        };
        let off = [
            pose.x - prior.map_from_scan.x,
            pose.y - prior.map_from_scan.y,
            wrap_rad(pose.theta_rad - prior.map_from_scan.theta_rad),
        ];
        let pull = prior.information.times(off);
        let gradient = [0, 1, 2].map(|k| -(self.gradient[k] + pull[k]));
        self.information.plus(&prior.information).solve(gradient)
    }
}

/// How far sides are out of line with their walls, and what that may tell of itself.
#[derive(Default)]
struct Directions {
    /// Σ w a aᵀ, a the derivatives along the sides, the same times ε, and the sum of what is times ε² or not known of it.
    along: Information,
    along_turned: Information,
    along_squares: Information,
    /// Σ w and Σ w ε.
    weight: f64,
    turned: f64,
}

impl Directions {
    /// A return, ε out of line; directions are not known to `doubt`, both in radians.
    fn add(&mut self, along: [f64; 3], weight: f64, turned: f64, doubt: f64) {
        self.along.add_residual(along, weight);
        self.along_turned.add_residual(along, weight * turned);
        self.along_squares
            .add_residual(along, weight * (turned * turned + doubt * doubt));
        self.weight += weight;
        self.turned += weight * turned;
    }

    /// What sides may tell by being out of line: S with ε counted from its mean, because that is the heading.
    fn seeming(&self) -> Information {
        if self.weight <= 0.0 {
            return Information::default();
        }
        let mean = self.turned / self.weight;
        self.along_squares
            .plus(&self.along_turned.scaled(-2.0 * mean))
            .plus(&self.along.scaled(mean * mean))
    }
}

/// Aligns `points` to the sides of `reference` polylines, starting at `guess`; `pairs` (scan polyline, reference
/// polyline) limits them to matched polylines, all when `None`.
#[must_use]
pub fn align(
    points: &[SidePoint],
    reference: &[crate::geometry::Polyline],
    pairs: Option<&[(u32, u32)]>,
    guess: &Guess,
    prior: Option<&Prior>,
    settings: &AlignSettings,
) -> Option<Alignment> {
    let mut grid = SideGrid::default();
    for (owner, polyline) in (0_u32..).zip(reference) {
        grid.insert(owner, polyline.vertices().iter().copied());
    }
    let allowed = |scan, map| pairs.is_none_or(|pairs| pairs.contains(&(scan, map)));
    align_to_grid(points, &grid, allowed, guess, prior, settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polyline;

    /// Walls of a room of 6 m × 4 m, seen from inside: counter-clockwise, free space on the left.
    fn room() -> Vec<Polyline> {
        let corners = [(-2.0, -2.0), (4.0, -2.0), (4.0, 2.0), (-2.0, 2.0), (-2.0, -2.0)];
        vec![Polyline::new(corners.iter().map(|&(x, y)| Point::new(x, y)).collect()).unwrap()]
    }

    fn around(map_from_scan: Pose) -> Guess {
        Guess {
            map_from_scan,
            sigma_m: 0.2,
            sigma_rad: 0.1,
        }
    }

    fn corridor() -> Vec<Polyline> {
        let wall = |a: (f64, f64), b: (f64, f64)| {
            Polyline::new(vec![Point::new(a.0, a.1), Point::new(b.0, b.1)]).unwrap()
        };
        vec![wall((-20.0, -1.0), (20.0, -1.0)), wall((20.0, 1.0), (-20.0, 1.0))]
    }

    fn seen_from(walls: &[Polyline], map_from_scan: Pose) -> Vec<SidePoint> {
        let scan_from_map = map_from_scan.inverse();
        let mut out = Vec::new();
        for (k, wall) in walls.iter().enumerate() {
            for side in wall.sides() {
                let direction = scan_from_map.rotate(side.direction().unwrap());
                let n = (side.length_m() / 0.1) as usize;
                out.extend((0..n).map(|i| SidePoint {
                    point: scan_from_map * side.at((i as f64 + 0.5) / n as f64),
                    direction,
                    sigma_m: 0.01,
                    worth: 0.1,
                    is_on_short_side: false,
                    polyline: k as u32,
                }));
            }
        }
        out
    }

    #[test]
    fn a_shift_and_a_turn_in_a_room_are_found_exactly() {
        let truth = Pose::new(0.3, -0.2, 0.15);
        let points = seen_from(&room(), truth);
        let found = align(
            &points,
            &room(),
            None,
            &around(Pose::IDENTITY),
            None,
            &AlignSettings::default(),
        )
        .unwrap();
        assert!(found.converged && found.unobservable.is_none());
        assert!(
            found.map_from_scan.distance(truth) < 1e-6,
            "{:?}",
            found.map_from_scan
        );
        assert!((found.map_from_scan.theta_rad - 0.15).abs() < 1e-6);
        assert!(found.matched_share() > 0.99 && found.rms_m < 1e-6);
    }

    #[test]
    fn a_corridor_is_named_and_the_motion_model_fills_it() {
        let truth = Pose::new(0.0, 0.1, 0.05);
        let points = seen_from(&corridor(), truth);
        let prior = Prior {
            map_from_scan: Pose::new(0.4, 0.0, 0.0),
            information: Information::from_sigmas(0.1, 0.1, 0.1),
        };
        let found = align(
            &points,
            &corridor(),
            None,
            &around(Pose::IDENTITY),
            Some(&prior),
            &AlignSettings::default(),
        )
        .unwrap();
        let along = found.unobservable.unwrap();
        assert!(along.x.abs() > 0.999, "{along:?}");
        assert!(
            (found.map_from_scan.x - 0.4).abs() < 1e-3,
            "along: from the prior, {:?}",
            found.map_from_scan
        );
        assert!(
            (found.map_from_scan.y - 0.1).abs() < 1e-3,
            "across: from the walls"
        );
        assert!((found.map_from_scan.theta_rad - 0.05).abs() < 1e-4);
    }

    #[test]
    fn only_matched_polylines_pull() {
        let mut points = seen_from(&room(), Pose::IDENTITY);
        // A second object that moved by 0.2 m must not disturb when its polyline is not matched.
        let moved: Vec<SidePoint> = points
            .iter()
            .map(|p| SidePoint {
                point: p.point + Point::new(0.2, 0.0),
                polyline: 1,
                ..*p
            })
            .collect();
        points.extend(moved);
        let pairs = [(0, 0)];
        let found = align(
            &points,
            &room(),
            Some(&pairs),
            &around(Pose::IDENTITY),
            None,
            &AlignSettings::default(),
        )
        .unwrap();
        assert!(found.map_from_scan.distance(Pose::IDENTITY) < 1e-9);
    }

    /// The wall of a round corridor as a map has it: corners every metre, each up to 1 cm off.
    fn round_wall(radius_m: f64, is_outer: bool) -> Polyline {
        let corner = |k: i32| {
            let k = if is_outer { k } else { -k };
            let wobble_m = 0.01 * (f64::from(k) * 2.4).sin();
            Point::from_polar(radius_m + wobble_m, f64::from(k) / radius_m)
        };
        Polyline::new((-20..=20).map(corner).collect()).unwrap()
    }

    /// A round room, the corners of its wall at every 0.6 m and up to 1 cm off, and what is seen of it from a quarter of a
    /// metre beside its middle, the sides' corners `shifted_m` along the wall.
    fn round_room(shifted_m: f64, turned_rad: f64) -> (Polyline, Vec<SidePoint>) {
        const RADIUS_M: f64 = 2.5;
        let corner = |k: i32| {
            let wobble_m = 0.01 * (f64::from(k) * 2.4).sin();
            Point::from_polar(RADIUS_M + wobble_m, (0.6 * f64::from(k) + shifted_m) / RADIUS_M)
        };
        let wall = Polyline::new((-9..=9).map(corner).collect()).unwrap();
        let scan_from_map = Pose::new(0.25, 0.0, turned_rad).inverse();
        let points = (-90..=90)
            .map(|beam| {
                let bearing = Point::from_polar(1.0, f64::from(beam) / 60.0);
                SidePoint {
                    point: scan_from_map * (bearing * RADIUS_M),
                    direction: scan_from_map.rotate(bearing.left()),
                    sigma_m: 0.015,
                    worth: 0.5,
                    is_on_short_side: false,
                    polyline: 0,
                }
            })
            .collect();
        (wall, points)
    }

    #[test]
    fn a_round_room_does_not_tell_a_turn_and_a_box_in_it_does() {
        let turned_rad = 0.08;
        for k in 0..6 {
            let (wall, mut points) = round_room(0.1 * f64::from(k), turned_rad);
            let mut walls = vec![wall];
            let guess = Guess {
                map_from_scan: Pose::new(0.25, 0.0, 0.0),
                sigma_m: 0.005,
                sigma_rad: 0.1,
            };
            let found = |points: &[SidePoint], walls: &[Polyline]| {
                let settings = AlignSettings::default();
                align(points, walls, None, &guess, Some(&guess.prior()), &settings).unwrap()
            };
            // A turn about the room's middle moves a scanner beside it sideways.
            let about_middle = |found: &Alignment| {
                let at = found.map_from_scan.translation();
                let way = Point::default() - at;
                found.information.quadratic([way.y, -way.x, 1.0]).sqrt().recip()
            };
            let alone = found(&points, &walls);
            let sigma_rad = about_middle(&alone);
            assert!(sigma_rad > 0.1, "{k}: the turn is claimed to {sigma_rad} rad");

            let box_corners = [(1.2, 0.3), (0.8, 0.0), (1.1, -0.4)].map(|(x, y)| Point::new(x, y));
            let seen_box = Polyline::new(box_corners.iter().rev().copied().collect()).unwrap();
            let mut of_box = seen_from(std::slice::from_ref(&seen_box), Pose::new(0.25, 0.0, turned_rad));
            of_box.iter_mut().for_each(|p| p.worth = 1.0);
            points.extend(of_box.into_iter().map(|p| SidePoint { polyline: 1, ..p }));
            walls.push(seen_box);
            let with_box = found(&points, &walls);
            let off_rad = (with_box.map_from_scan.theta_rad - turned_rad).abs();
            assert!(off_rad < 0.015, "{k}: {off_rad} rad off with a box in sight");
        }
    }

    #[test]
    fn a_heading_that_is_off_does_not_make_sides_be_out_of_line() {
        let seeming = |heading_off_rad: f64| {
            let mut directions = Directions::default();
            for k in 0..40 {
                let bearing_rad = 0.1 * f64::from(k);
                let turned = 0.02 * (f64::from(k) * 2.4).sin();
                let along = [bearing_rad.cos(), bearing_rad.sin(), 2.5];
                directions.add(along, 1.0, turned + heading_off_rad, 0.0);
            }
            directions.seeming().quadratic([0.0, 0.0, 1.0])
        };
        assert!((seeming(0.1) - seeming(0.0)).abs() < 1e-9 && seeming(0.0) > 0.0);
    }

    #[test]
    fn along_round_walls_the_motion_goes_on_and_the_walls_do_not_claim_to_know() {
        let (middle_m, reach_rad) = (10.0, 0.5);
        let walls = [round_wall(11.0, true), round_wall(9.0, false)];
        for k in 0..20 {
            // Somewhere along the corridor, looking along it.
            let at_rad = -0.7 + 0.07 * f64::from(k);
            let place = Point::from_polar(middle_m, at_rad);
            let truth = Pose::new(place.x, place.y, at_rad + std::f64::consts::FRAC_PI_2);
            let points: Vec<SidePoint> = [(11.0, 1.0), (9.0, -1.0)]
                .into_iter()
                .flat_map(|(radius_m, way)| (-60..60).map(move |i| (radius_m, way, f64::from(i) / 60.0)))
                .map(|(radius_m, way, share)| {
                    let outward = Point::from_polar(1.0, at_rad + reach_rad * share);
                    SidePoint {
                        point: truth.inverse() * (outward * radius_m),
                        direction: truth.inverse().rotate(outward.left() * way),
                        sigma_m: 0.015,
                        worth: 0.5,
                        is_on_short_side: false,
                        polyline: 0,
                    }
                })
                .collect();
            let guess = Guess {
                map_from_scan: truth,
                sigma_m: 0.035,
                sigma_rad: 0.06,
            };
            let settings = AlignSettings::default();
            let found = align(&points, &walls, None, &guess, Some(&guess.prior()), &settings).unwrap();
            let way = Point::from_polar(1.0, at_rad).left();
            let held_m = way.dot(found.map_from_scan.translation() - place).abs();
            assert!(found.unobservable.is_some());
            let along = [way.x, way.y, 1.0 / middle_m];
            let sigma_m = found.information.quadratic(along).sqrt().recip();
            assert!(held_m < 0.003, "{k}: {held_m} m off the way that was gone");
            assert!(
                sigma_m > 0.09,
                "{k}: the walls claim to know the way to {sigma_m} m"
            );
        }
    }
}
