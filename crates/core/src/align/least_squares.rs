use super::Information;
use crate::geometry::{Near, Point, Pose, SideGrid};

/// A return and the direction of the scan side it lies on.
#[derive(Clone, Copy, Debug)]
pub struct SidePoint {
    /// Laser frame, metres.
    pub point: Point,
    /// Unit vector along the side, laser frame.
    pub direction: Point,
    /// Standard deviation of the distance to the side, metres.
    pub sigma_m: f64,
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

/// How the alignment goes about it.
#[derive(Clone, Copy, Debug)]
pub struct AlignSettings {
    /// Gate of the first round, metres: how far off the guess may be.
    pub first_gate_m: f64,
    /// Gate of the last rounds, metres. 0.10 m is five times the noise of a cheap scanner.
    pub last_gate_m: f64,
    /// Rounds at most.
    pub max_rounds: u32,
    /// Scale of the Cauchy weight in standard deviations; 2.385 keeps 95 % efficiency on Gaussian noise.
    pub robust_sigmas: f64,
    /// A direction in which the walls hold less than this many returns' worth of information is left to the prior.
    /// Walls that are parallel to 2° give 180 returns 0.2; one door frame gives 3 to 10.
    pub min_returns_along: f64,
}

impl Default for AlignSettings {
    fn default() -> Self {
        Self {
            first_gate_m: 0.5,
            last_gate_m: 0.10,
            max_rounds: 20,
            robust_sigmas: 2.385,
            min_returns_along: 3.0,
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
    guess: Pose,
    prior: Option<&Prior>,
    settings: &AlignSettings,
) -> Option<Alignment> {
    let mut pose = guess;
    let mut gate_m = settings.first_gate_m;
    let mut converged = false;
    let mut rounds = 0;
    let mut last = Round::default();
    while rounds < settings.max_rounds && !converged {
        rounds += 1;
        let at_last_gate = gate_m <= settings.last_gate_m * 1.001;
        last = Round::pair(points, target, &allowed, pose, gate_m, settings);
        let step = last.step(pose, prior, settings)?;
        pose = Pose::new(pose.x + step[0], pose.y + step[1], pose.theta_rad + step[2]);
        converged = at_last_gate && step[0].hypot(step[1]) < 2e-4 && step[2].abs() < 2e-5;
        let small_step = step[0].hypot(step[1]) < 0.3 * gate_m && step[2].abs() < 0.1;
        if small_step {
            gate_m = (gate_m * 0.6).max(settings.last_gate_m);
        }
    }
    (last.matched > 0).then(|| Alignment {
        map_from_scan: pose,
        information: last.information,
        unobservable: last.unobservable(settings),
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
    /// Σ w j e / σ²
    gradient: [f64; 3],
    /// Σ w n nᵀ: returns' worth of information by direction, whatever their noise.
    returns: Information,
    matched: usize,
    squares_m2: f64,
}

impl Round {
    fn pair(
        points: &[SidePoint],
        target: &SideGrid,
        allowed: &impl Fn(u32, u32) -> bool,
        pose: Pose,
        gate_m: f64,
        settings: &AlignSettings,
    ) -> Self {
        let mut round = Self::default();
        let (sin, cos) = pose.theta_rad.sin_cos();
        let turn = |v: Point| Point::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y);
        // A wide gate comes with a poor heading: sides may then differ by more.
        let min_cos = if gate_m > 0.25 { 0.7 } else { 0.85 };
        for p in points {
            let arm = turn(p.point);
            let place = arm + pose.translation();
            let near = Near {
                direction: turn(p.direction),
                min_cos,
                max_distance_m: gate_m,
                beyond_ends: false,
            };
            let Some(foot) = target.nearest(place, &near, |owner| allowed(p.polyline, owner)) else {
                continue;
            };
            let normal = target.side(foot.side).normal();
            let error_m = normal.dot(place - foot.point);
            // The scale follows the gate, so that far guesses are not weighted away in the first rounds.
            let scale_m = settings.robust_sigmas * p.sigma_m.max(0.2 * gate_m);
            let weight = 1.0 / (1.0 + (error_m / scale_m).powi(2));
            let j = [normal.x, normal.y, normal.dot(arm.left())];
            let w = weight / (p.sigma_m * p.sigma_m);
            round.information.add_residual(j, w);
            round.returns.add_residual(j, weight);
            for (g, j) in round.gradient.iter_mut().zip(j) {
                *g += w * j * error_m;
            }
            round.matched += 1;
            round.squares_m2 += error_m * error_m;
        }
        round
    }

    fn unobservable(&self, settings: &AlignSettings) -> Option<Point> {
        let (direction, returns) = self.returns.weakest_direction();
        (returns < settings.min_returns_along).then_some(direction)
    }

    /// The Gauss–Newton step. Along an unobservable direction the walls' equations are replaced by the prior's.
    fn step(&self, pose: Pose, prior: Option<&Prior>, settings: &AlignSettings) -> Option<[f64; 3]> {
        let Some(weak) = self.unobservable(settings) else {
            return self.information.solve(self.gradient.map(|g| -g));
        };
        let strong = weak.left();
        let axes = [[strong.x, strong.y, 0.0], [0.0, 0.0, 1.0]];
        // Normal equations in the basis (strong, θ), and the way along `weak` from the prior alone.
        let along = prior.map_or(0.0, |p| {
            (p.map_from_scan.translation() - pose.translation()).dot(weak)
        });
        let mut reduced = Information::default();
        let mut rhs = [0.0; 3];
        let shift = self.information.times([weak.x * along, weak.y * along, 0.0]);
        for (r, a) in axes.iter().enumerate() {
            let times = self.information.times(*a);
            for (c, b) in axes.iter().enumerate() {
                reduced.rows[r][c] = (0..3).map(|k| times[k] * b[k]).sum();
            }
            rhs[r] = -(0..3).map(|k| a[k] * (self.gradient[k] + shift[k])).sum::<f64>();
        }
        reduced.rows[2][2] = 1.0;
        // One wall through the scanner's own place can leave even these two undetermined: a whiff of damping.
        let damping = 1e-9 * (reduced.rows[0][0] + reduced.rows[1][1]) + 1e-9;
        reduced.rows[0][0] += damping;
        reduced.rows[1][1] += damping;
        let [across, theta, _] = reduced.solve(rhs)?;
        Some([
            strong.x * across + weak.x * along,
            strong.y * across + weak.y * along,
            theta,
        ])
    }
}

/// Aligns `points` to the sides of `reference` polylines, starting at `guess`; `pairs` (scan polyline, reference
/// polyline) limits them to matched polylines, all when `None`.
#[must_use]
pub fn align(
    points: &[SidePoint],
    reference: &[crate::geometry::Polyline],
    pairs: Option<&[(u32, u32)]>,
    guess: Pose,
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
            Pose::IDENTITY,
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
            Pose::IDENTITY,
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
            Pose::IDENTITY,
            None,
            &AlignSettings::default(),
        )
        .unwrap();
        assert!(found.map_from_scan.distance(Pose::IDENTITY) < 1e-9);
    }
}
