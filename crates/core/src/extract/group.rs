//! Returns → groups (paper section 2: a gap of more than 0.20 m starts a new polyline).
//!
//! In: the returns of a scan. Out: runs of returns that belong to one surface, in counter-clockwise order.
//!
//! The paper's fixed 0.20 m cuts far and grazing walls to pieces, because the spacing of the returns on a wall is
//! r·Δφ/sin γ for range r, beam step Δφ and incidence γ. Here two neighbouring returns p, q belong together when
//! 1. they are closer than 0.20 m, or than three times the spacing r·Δφ on a wall seen square on, or
//! 2. a line seen before p leads to q, or one seen after q leads back to p (grazing walls), or
//! 3. beams are missing between them, both lines agree, and the hole is small (dropouts inside a wall).

use std::ops::Range;

use crate::geometry::Point;
use crate::scan::Scan;

/// How returns are grouped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupSettings {
    /// Returns closer than this belong together, metres (paper section 2: 0.20).
    pub gap_m: f64,
    /// Returns closer than this many times their spacing on a wall seen square on belong together. 3 keeps walls
    /// down to 20° of incidence without looking at their neighbours.
    pub spacings: f64,
    /// A hole of missing beams inside a straight wall is bridged up to this length, metres.
    pub hole_m: f64,
    /// Farthest two returns on one grazing wall may be apart, metres: beyond it, a wall is a guess.
    pub reach_m: f64,
}

impl Default for GroupSettings {
    fn default() -> Self {
        Self {
            gap_m: 0.20,
            spacings: 3.0,
            hole_m: 0.60,
            reach_m: 2.0,
        }
    }
}

/// The returns of a scan in counter-clockwise order, cut into groups.
///
/// On a full circle the order starts at a gap, so that no group is cut by the end of the list.
#[derive(Clone, Debug, Default)]
pub(crate) struct Groups {
    /// Beam of every return.
    pub(crate) beams: Vec<usize>,
    /// Where it hit, laser frame.
    pub(crate) points: Vec<Point>,
    /// Its range, metres.
    pub(crate) ranges_m: Vec<f64>,
    /// Groups as ranges of positions in the lists above; every return is in one.
    pub(crate) groups: Vec<Range<usize>>,
}

/// Groups the returns of a scan.
pub(crate) fn group(scan: &Scan, settings: &GroupSettings, noise_m: f64) -> Groups {
    let (mut beams, mut points): (Vec<usize>, Vec<Point>) = scan.points().unzip();
    let n = points.len();
    if n == 0 {
        return Groups::default();
    }
    let circle = scan.geometry().is_full_circle();
    let row = Row {
        beams: &beams,
        points: &points,
        beam_count: scan.geometry().beams(),
        step_rad: scan.geometry().step_rad(),
        circle,
        noise_m,
        settings,
    };
    // joined[k]: return k belongs with the one before it (on a circle, the first with the last).
    let mut joined: Vec<bool> = (0..n).map(|k| row.joined(k)).collect();
    if circle {
        let start = row.start(&joined);
        beams.rotate_left(start);
        points.rotate_left(start);
        joined.rotate_left(start);
    }
    let mut groups = Vec::new();
    let mut first = 0;
    for k in (1..n).filter(|&k| !joined[k]).chain([n]) {
        groups.push(first..k);
        first = k;
    }
    let ranges_m = beams.iter().map(|&b| scan.ranges_m()[b]).collect();
    Groups {
        beams,
        points,
        ranges_m,
        groups,
    }
}

/// The returns with what is needed to judge a gap.
struct Row<'a> {
    beams: &'a [usize],
    points: &'a [Point],
    beam_count: usize,
    step_rad: f64,
    circle: bool,
    noise_m: f64,
    settings: &'a GroupSettings,
}

impl Row<'_> {
    /// Returns looked at on either side of a gap.
    const NEAR: usize = 3;

    fn before(&self, k: usize) -> Option<usize> {
        let n = self.points.len();
        if k > 0 {
            Some(k - 1)
        } else {
            (self.circle && n > 1).then(|| n - 1)
        }
    }

    fn after(&self, k: usize) -> Option<usize> {
        let n = self.points.len();
        if k + 1 < n {
            Some(k + 1)
        } else {
            (self.circle && n > 1).then_some(0)
        }
    }

    /// Beam steps from return `a` to the next return `b`.
    fn steps(&self, a: usize, b: usize) -> usize {
        if b > a {
            self.beams[b] - self.beams[a]
        } else {
            self.beams[b] + self.beam_count - self.beams[a]
        }
    }

    /// Whether return `k` belongs with the one before it.
    fn joined(&self, k: usize) -> bool {
        let Some(j) = self.before(k) else {
            return false;
        };
        let (p, q) = (self.points[j], self.points[k]);
        let gap_m = p.distance(q);
        if gap_m <= self.settings.gap_m {
            return true;
        }
        let steps = self.steps(j, k);
        let spacing_m = p.norm().min(q.norm()) * self.step_rad * steps as f64;
        if steps == 1 && gap_m <= self.settings.spacings * spacing_m {
            return true;
        }
        let from_left = self.leads_to(j, q, Self::before);
        let from_right = self.leads_to(k, p, Self::after);
        if steps == 1 {
            gap_m <= self.settings.reach_m && (from_left || from_right)
        } else {
            gap_m
                <= self
                    .settings
                    .hole_m
                    .max(self.settings.spacings * spacing_m / steps as f64)
                && from_left
                && from_right
        }
    }

    /// Whether the line through return `from` and its neighbours in direction `next` passes by `target`, a gap of
    /// no more than 2.5 times the spacing of those neighbours and growing as on a wall.
    fn leads_to(&self, from: usize, target: Point, next: impl Fn(&Self, usize) -> Option<usize>) -> bool {
        let p = self.points[from];
        let mut far = from;
        let mut count = 0;
        for _ in 0..Self::NEAR - 1 {
            let Some(further) = next(self, far) else { break };
            far = further;
            count += 1;
        }
        if count < 1 || far == from {
            return false;
        }
        let Some(direction) = (p - self.points[far]).unit() else {
            return false;
        };
        let to_target = target - p;
        let ahead_m = to_target.dot(direction);
        if ahead_m <= 0.0 {
            return false;
        }
        let length_m = p.distance(self.points[far]);
        // The direction of a line through points with noise σ in range is off by about σ_perp / length.
        let sine = (direction.cross(p) / p.norm().max(1e-9)).abs();
        let across_m =
            3.0 * self.noise_m * sine * (1.0 + 2.0 * ahead_m / length_m.max(1e-9)) + 0.03 * ahead_m;
        let spacing_m = length_m / count as f64;
        direction.cross(to_target).abs() <= across_m && ahead_m <= 2.5 * spacing_m.max(self.settings.gap_m)
    }

    /// Where to begin the list of a full circle: at the first gap, or at the widest step when there is none.
    fn start(&self, joined: &[bool]) -> usize {
        if let Some(k) = joined.iter().position(|&j| !j) {
            return k;
        }
        let step_m = |k: usize| {
            self.before(k)
                .map_or(0.0, |j| self.points[j].distance(self.points[k]))
        };
        (0..joined.len())
            .max_by(|&a, &b| step_m(a).total_cmp(&step_m(b)).then(b.cmp(&a)))
            .unwrap_or(0)
    }
}
