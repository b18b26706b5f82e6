//! Places seen before: candidates for closing a loop, verified.
//!
//! In: the keyframes and the edges between them. Out: an edge from an old keyframe to the newest one, when the scans
//! of the last metres fit the old place in exactly one way. A closure taken wrongly ruins a map, one missed is found
//! a metre later: every test errs on the side of no.

use crate::align::{AlignSettings, Alignment, Guess, SidePoint, align_to_grid};
use crate::geometry::{Point, Pose, SideGrid, wrap_rad};
use crate::keyframe::Keyframe;
use crate::loops::graph::Edge;
use crate::loops::ways::Way;
use crate::place::judge::{Agreement, judge};
use crate::place::search::{Field, Window, search};
use crate::place::thinned;

/// When a place is recognised.
#[derive(Clone, Copy, Debug)]
pub struct RecogniseSettings {
    /// Way back from the newest keyframe whose scans are compared, and on either side of the old keyframe, metres.
    pub stretch_m: f64,
    /// Standard deviation of the drift, as a share of the way since (measured on full-rate logs: 0.5 to 1 %).
    pub drift_share: f64,
    /// Half the width of the search window at the most, metres; three standard deviations otherwise.
    pub most_window_m: f64,
    /// Share of the beams that must agree, of those that the old place says something of.
    pub least_fit: f64,
    /// Share of the beams that the old place must say something of.
    pub least_known: f64,
    /// By how much the score of the second best pose must be worse, and
    pub least_lead: f64,
    /// how many times as many beams must disagree with it;
    pub least_outdoing: f64,
    /// or how many times whatever the score.
    pub clear_outdoing: f64,
    /// A closure that moves the newest keyframe farther than this, metres, waits for a second one that agrees.
    pub confirm_beyond_m: f64,
}

impl Default for RecogniseSettings {
    fn default() -> Self {
        Self {
            stretch_m: 3.0,
            drift_share: 0.012,
            most_window_m: 12.0,
            least_fit: 0.85,
            least_known: 0.5,
            least_lead: 0.10,
            least_outdoing: 1.5,
            clear_outdoing: 2.5,
            confirm_beyond_m: 1.0,
        }
    }
}

/// The part of a stretch of keyframes that is compared: one every half metre is enough, and thirty.
const STRETCH_STEP_M: f64 = 0.5;
const STRETCH_STEPS: f64 = 16.0;

/// An edge from an old keyframe to the newest, if a place is recognised. `ways` are the ways along the graph from
/// the newest keyframe ([`crate::loops::ways::ways`]).
pub(crate) fn recognise(
    keyframes: &[Keyframe],
    ways: &[Option<Way>],
    local_m: f64,
    align: &AlignSettings,
    settings: &RecogniseSettings,
) -> Option<Recognised> {
    let newest = keyframes.len().checked_sub(1)?;
    let unknown = Way {
        length_m: f64::INFINITY,
        ..Way::default()
    };
    let way = |k: usize| ways[k].unwrap_or(unknown);
    let drift = |k: usize| Drift::after(way(k), settings);
    let seen_here = keyframes[newest].seen_around();
    let (old, _) = (0..newest)
        .filter(|&k| way(k).length_m > local_m)
        .map(|k| (k, keyframes[k].seen_around().distance(seen_here)))
        .filter(|&(k, off_m)| off_m < drift(k).window_m + SAME_VIEW_M)
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let place = Place::around(keyframes, old, settings.stretch_m);
    let recent = stretch(keyframes, newest, settings.stretch_m, |k| k <= newest);
    let here = keyframes[newest].map_from_scan;
    let views: Vec<View> = recent.iter().map(|&k| View::new(&keyframes[k], here)).collect();
    let matched = place.locate(&views, here, drift(old), align, settings)?;
    let old_pose = keyframes[old].map_from_scan;
    Some(Recognised {
        edge: Edge {
            from: old,
            to: newest,
            motion: old_pose.inverse() * matched.map_from_scan,
            information: matched.information.turned(-old_pose.theta_rad),
            is_loop: true,
        },
        is_far: drift(old).squares(matched.map_from_scan, here) > SOME_SQUARES,
    })
}

/// A place that was recognised.
#[derive(Clone, Copy)]
pub(crate) struct Recognised {
    /// From the old keyframe to the newest.
    pub edge: Edge,
    /// Whether it asks for more drift than is usual after such a way.
    pub is_far: bool,
}

/// A place of one map that is looked for in another.
#[derive(Clone, Copy)]
pub(crate) struct Lookup<'a> {
    /// The map that is searched, and the keyframe around which.
    pub old: &'a [Keyframe],
    pub at: usize,
    /// The map whose place is looked for, and the keyframe around which its scans are compared.
    pub new: &'a [Keyframe],
    pub anchor: usize,
    /// Where in the old map the anchor is looked for, whatever its heading,
    pub centre: Pose,
    /// and how far off it may be.
    pub drift: Drift,
    /// Way on either side of the keyframes that is compared, metres.
    pub stretch_m: f64,
}

/// An edge from the old map to the new one, when the scans around the anchor fit the old place in exactly one way.
pub(crate) fn find_in(lookup: &Lookup, align: &AlignSettings, settings: &RecogniseSettings) -> Option<Edge> {
    let Lookup {
        old, at, new, anchor, ..
    } = *lookup;
    let place = Place::around(old, at, lookup.stretch_m);
    let here = new[anchor].map_from_scan;
    let views: Vec<View> = stretch(new, anchor, lookup.stretch_m, |_| true)
        .iter()
        .map(|&k| View::new(&new[k], here))
        .collect();
    let matched = place.locate(&views, lookup.centre, lookup.drift, align, settings)?;
    Some(Edge {
        from: at,
        to: anchor,
        motion: old[at].map_from_scan.inverse() * matched.map_from_scan,
        information: matched.information.turned(-old[at].map_from_scan.theta_rad),
        is_loop: true,
    })
}

/// How far off the estimate of the newest keyframe may be, seen from an old one.
#[derive(Clone, Copy)]
pub(crate) struct Drift {
    sigma_m: f64,
    sigma_rad: f64,
    window_m: f64,
    window_rad: f64,
}

impl Drift {
    /// Nothing is known but that the place is within `window_m`.
    pub fn anywhere(window_m: f64) -> Self {
        Self {
            sigma_m: 1e3,
            sigma_rad: 1e3,
            window_m,
            window_rad: std::f64::consts::PI,
        }
    }

    /// Somebody who lost his way has moved by this, standard deviations, and is looked for within `window_m` at any heading.
    pub fn lost(sigma_m: f64, sigma_rad: f64, window_m: f64) -> Self {
        Self {
            sigma_m,
            sigma_rad,
            window_m,
            window_rad: std::f64::consts::PI,
        }
    }

    fn after(way: Way, settings: &RecogniseSettings) -> Self {
        let way_m = way.length_m.min(1e4);
        let sigma_m = (0.15 + settings.drift_share * way_m).hypot(way.open_m2.sqrt());
        // A turn by one degree in 50 m.
        let sigma_rad = (0.02 + 0.000_35 * way_m).hypot(way.open_rad2.sqrt());
        Self {
            sigma_m,
            sigma_rad,
            window_m: (3.0 * sigma_m).min(settings.most_window_m),
            window_rad: (3.0 * sigma_rad).min(0.6),
        }
    }

    /// Squared distance in standard deviations between two poses.
    fn squares(&self, a: Pose, b: Pose) -> f64 {
        let shift = a.distance(b) / self.sigma_m;
        let turn = wrap_rad(a.theta_rad - b.theta_rad) / self.sigma_rad;
        shift * shift + turn * turn
    }
}

/// A pose farther off than this, in squared standard deviations, is another place that looks alike (χ² with three
/// degrees of freedom: 99.9 %).
const MOST_SQUARES: f64 = 16.3;
/// What a pose one standard deviation of drift away loses of its score.
const LOSS_PER_SQUARE: f64 = 0.02;

/// From so many squared standard deviations on, a pose must not have one nearer that fits: nine in ten closures of seven logs
/// ask for less.
const SOME_SQUARES: f64 = 2.0;
/// Share of the beams that the old place must say something of there, and how much worse the fit may be.
const NEARER_KNOWN: f64 = 0.08;
const NEARER_FIT: f64 = 0.05;

/// Scans whose middles are farther apart than this, besides the drift, show different things.
const SAME_VIEW_M: f64 = 3.0;

/// Keyframes within `stretch_m` of path of keyframe `middle`, some half a metre apart.
pub(super) fn stretch(
    keyframes: &[Keyframe],
    middle: usize,
    stretch_m: f64,
    allowed: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let mut out = vec![middle];
    let spacing_m = STRETCH_STEP_M.max(stretch_m / STRETCH_STEPS);
    for backwards in [true, false] {
        let (mut k, mut path_m, mut since_m) = (middle, 0.0, 0.0);
        loop {
            let next = if backwards {
                k.checked_sub(1)
            } else {
                Some(k + 1).filter(|&n| n < keyframes.len())
            };
            let Some(next) = next.filter(|&n| allowed(n)) else {
                break;
            };
            let step = keyframes[k].map_from_scan.inverse() * keyframes[next].map_from_scan;
            // A turn shows other walls as a way does: half a metre counts as much as 30°.
            let step_m = step.translation().norm() + step.theta_rad.abs();
            path_m += step_m;
            since_m += step_m;
            if path_m > stretch_m {
                break;
            }
            if since_m >= spacing_m {
                out.push(next);
                since_m = 0.0;
            }
            k = next;
        }
    }
    out.sort_unstable();
    out
}

pub(super) struct Matched {
    pub map_from_scan: Pose,
    pub information: crate::align::Information,
}

/// The walls seen around an old keyframe.
pub(super) struct Place {
    sides: SideGrid,
}

impl Place {
    fn around(keyframes: &[Keyframe], middle: usize, stretch_m: f64) -> Self {
        let around = stretch(keyframes, middle, stretch_m, |_| true);
        Self::of(around.into_iter().map(|k| &keyframes[k]))
    }

    /// What these keyframes saw, but for what moves.
    pub fn of<'a>(keyframes: impl Iterator<Item = &'a Keyframe>) -> Self {
        let mut sides = SideGrid::default();
        let mut owner = 0;
        for keyframe in keyframes {
            for polyline in keyframe.standing_polylines() {
                sides.insert(
                    owner,
                    keyframe.map_from_scan.transform(polyline.polyline.vertices()),
                );
                owner += 1;
            }
        }
        Self { sides }
    }

    /// Poses in a window from which returns lie on this place's walls, best first.
    fn found(&self, points: &[SidePoint], window: &Window) -> Vec<Pose> {
        let reach_m = points.iter().map(|p| p.point.norm()).fold(0.0, f64::max) + window.half_m;
        let sides = self.sides.sides().map(|s| s.segment);
        let Some(field) = Field::new(sides, window.centre.translation(), reach_m) else {
            return Vec::new();
        };
        let candidates = search(&field, &sparse(points), window);
        candidates.into_iter().map(|c| c.map_from_scan).collect()
    }

    /// Poses `(half_m, half_rad)` around `here` from which the views lie on this place's walls, aligned from and held by where the
    /// search found them; `here` is one of them if it can be aligned.
    pub fn alignments(
        &self,
        views: &[View],
        here: Pose,
        (half_m, half_rad): (f64, f64),
        align: &AlignSettings,
    ) -> Vec<Alignment> {
        let points = points_of(views);
        let window = Window {
            centre: here,
            half_m,
            half_rad,
            wanted: 8,
            min_score: 0.2,
        };
        let poses = self.found(&points, &window).into_iter().chain([here]);
        let aligned = |map_from_scan| {
            let guess = Guess {
                map_from_scan,
                sigma_m: 0.07,
                sigma_rad: 0.02,
            };
            let prior = guess.prior();
            align_to_grid(&points, &self.sides, |_, _| true, &guess, Some(&prior), align)
        };
        poses.filter_map(aligned).collect()
    }

    /// The newest keyframe's pose by this place, if the recent scans fit it in one way only.
    pub fn locate(
        &self,
        views: &[View],
        here: Pose,
        drift: Drift,
        align: &AlignSettings,
        settings: &RecogniseSettings,
    ) -> Option<Matched> {
        let points = points_of(views);
        let window = Window {
            centre: here,
            half_m: drift.window_m,
            half_rad: drift.window_rad,
            wanted: 4,
            min_score: 0.3,
        };
        let mut fits: Vec<(f64, Agreement, Alignment)> = self
            .found(&points, &window)
            .into_iter()
            .filter_map(|map_from_scan| {
                let guess = Guess {
                    map_from_scan,
                    sigma_m: 0.07,
                    sigma_rad: 0.02,
                };
                let alignment = align_to_grid(&points, &self.sides, |_, _| true, &guess, None, align)?;
                let agreement = self.agreement(views, alignment.map_from_scan);
                let loss = LOSS_PER_SQUARE * drift.squares(alignment.map_from_scan, here);
                Some((agreement.score() - loss, agreement, alignment))
            })
            .collect();
        fits.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (score, agreement, alignment) = *fits.first()?;
        let pose = alignment.map_from_scan;
        let second = fits
            .iter()
            .find(|(_, _, a)| !a.map_from_scan.is_within(0.4, 0.17, pose));
        let lead = second.map_or(1.0, |s| score - s.0);
        let misfit = |a: &Agreement| 1.0 - a.fit() + 0.02;
        let outdoes = second.map_or(f64::INFINITY, |s| misfit(&s.1) / misfit(&agreement));
        let is_alone = (lead >= settings.least_lead && outdoes >= settings.least_outdoing)
            || outdoes >= settings.clear_outdoing;
        let believed = alignment.unobservable.is_none()
            && drift.squares(pose, here) < MOST_SQUARES
            && agreement.fit() >= settings.least_fit
            && agreement.known_share() >= settings.least_known
            && is_alone
            && !self.fits_nearer(views, &points, (pose, agreement.fit()), here, drift, align);
        believed.then_some(Matched {
            map_from_scan: pose,
            information: alignment.information,
        })
    }

    /// Whether the scans fit as well at a pose much nearer to where the scanner should be. Less of the old place may be seen
    /// from there, so that it does not stand out by its score; but a place that contradicts nothing and asks for little
    /// drift is to be believed rather than one that looks alike and asks for much.
    fn fits_nearer(
        &self,
        views: &[View],
        points: &[SidePoint],
        (far, fit): (Pose, f64),
        here: Pose,
        drift: Drift,
        align: &AlignSettings,
    ) -> bool {
        if drift.squares(far, here) < SOME_SQUARES {
            return false;
        }
        let half_m = 0.5 * far.distance(here);
        let window = Window {
            centre: here,
            half_m,
            half_rad: drift.window_rad,
            wanted: 4,
            min_score: 0.1,
        };
        let guess = |map_from_scan, sigma_m| Guess {
            map_from_scan,
            sigma_m,
            sigma_rad: 0.02,
        };
        let found = self.found(points, &window);
        let guesses = found.into_iter().map(|pose| guess(pose, 0.07));
        guesses.chain([guess(here, 0.15)]).any(|guess| {
            let Some(alignment) = align_to_grid(points, &self.sides, |_, _| true, &guess, None, align) else {
                return false;
            };
            let near = alignment.map_from_scan;
            let agreement = self.agreement(views, near);
            drift.squares(near, here) < 0.5 * drift.squares(far, here)
                && agreement.known_share() >= NEARER_KNOWN
                && agreement.fit() >= fit - NEARER_FIT
        })
    }

    pub fn agreement(&self, views: &[View], map_from_newest: Pose) -> Agreement {
        views.iter().fold(Agreement::default(), |sum, view| {
            let pose = map_from_newest * view.newest_from_scan;
            sum.plus(judge(view.points, &self.sides, pose, 0.12))
        })
    }
}

/// A recent scan, seen from the newest keyframe.
pub(super) struct View<'a> {
    points: &'a [SidePoint],
    newest_from_scan: Pose,
}

impl<'a> View<'a> {
    pub fn new(keyframe: &'a Keyframe, map_from_newest: Pose) -> Self {
        Self {
            points: &keyframe.points,
            newest_from_scan: map_from_newest.inverse() * keyframe.map_from_scan,
        }
    }

    fn points_in(&self, newest_from_scan: Pose) -> impl Iterator<Item = SidePoint> + '_ {
        self.points.iter().map(move |p| SidePoint {
            point: newest_from_scan * p.point,
            direction: newest_from_scan.rotate(p.direction),
            ..*p
        })
    }
}

/// What the views show, seen from the newest keyframe.
fn points_of(views: &[View]) -> Vec<SidePoint> {
    views
        .iter()
        .flat_map(|v| v.points_in(v.newest_from_scan))
        .collect()
}

/// Points to search with: thinned, and no more than a few hundred.
fn sparse(points: &[SidePoint]) -> Vec<(Point, Point)> {
    const MOST: usize = 300;
    let points = thinned(points);
    let step = points.len().div_ceil(MOST).max(1);
    points.into_iter().step_by(step).collect()
}
