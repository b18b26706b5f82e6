//! The poses looked at for one scan: aligned, judged, and what is believed of them.

use std::cell::OnceCell;

use super::judge::judge;
use super::search::{Field, Window, search};
use super::{Motion, PlaceSettings, Placement, thinned};
use crate::align::{AlignSettings, Alignment, FULL_WORTH, Guess, SidePoint, align_to_grid, worth};
use crate::geometry::{Pose, SideGrid, wrap_rad};
use crate::matching::{PoseGaussian, unmoved};

/// A guess nearer than this to a pose that was found leads there, metres and radians.
const SAME_GUESS_M: f64 = 0.05;
const SAME_GUESS_RAD: f64 = 0.02;

/// Returns that a glance is taken at.
const FEW: usize = 60;
/// Rounds of its alignment.
const GLANCE_ROUNDS: u32 = 12;
/// How far off the pose of a glance may be: standard deviations, metres and radians. (With half as much, one keyframe log in
/// seven had 2.5 % of its scans placed wrongly, which has none now.)
const GLANCED_M: f64 = 0.05;
const GLANCED_RAD: f64 = 0.015;
/// A guess whose merit is so far behind the best one's is not looked at any further. What is carried on, or called into doubt by
/// another, is less than 0.25 behind; the score of sixty returns has a standard deviation of 0.06.
const HOPELESS_BEHIND: f64 = 0.5;
/// A guess that leads near what was found is looked at if its merit is larger by so much: it leads nearer still.
const NO_BETTER: f64 = 0.05;

pub(super) struct Stage<'a> {
    points: &'a [SidePoint],
    /// Some of them, for a glance; chosen when they are needed.
    few: OnceCell<Vec<SidePoint>>,
    map: &'a SideGrid,
    motion: &'a Motion,
    /// [`Motion::peak`], computed once.
    peak: OnceCell<f64>,
    align: &'a AlignSettings,
    settings: &'a PlaceSettings,
    /// How much the scan has to say, 0..=1. A scanner that sees 4 m, in a hall, may see two posts, worth 5: they fit nearly anywhere, and
    /// a place found by them against what the motion makes likely was off by a metre in simulated halls.
    weight: f64,
    /// What was found so far.
    found: Vec<Placement>,
}

impl<'a> Stage<'a> {
    pub fn new(
        points: &'a [SidePoint],
        map: &'a SideGrid,
        motion: &'a Motion,
        align: &'a AlignSettings,
        settings: &'a PlaceSettings,
    ) -> Self {
        Self {
            points,
            few: OnceCell::new(),
            map,
            motion,
            weight: (worth(points) / FULL_WORTH).clamp(0.01, 1.0),
            peak: OnceCell::new(),
            align,
            settings,
            found: Vec::new(),
        }
    }

    /// The motion so far.
    pub fn motion(&self) -> &'a Motion {
        self.motion
    }

    /// All poses that were looked at.
    pub fn into_found(self) -> Vec<Placement> {
        self.found
    }

    /// Aligns from a guess and judges the result. The guess is its own prior: along a corridor the scan stays where
    /// it was guessed to be, instead of sliding to where the noise of the walls would have it.
    pub fn aligned(&self, guess: &Guess) -> Option<Placement> {
        self.aligned_from(guess, guess)
    }

    /// The same, begun elsewhere.
    fn aligned_from(&self, start: &Guess, guess: &Guess) -> Option<Placement> {
        let prior = guess.prior();
        let alignment = align_to_grid(
            self.points,
            self.map,
            |_, _| true,
            start,
            Some(&prior),
            self.align,
        )?;
        let agreement = judge(
            self.points,
            self.map,
            alignment.map_from_scan,
            self.settings.gate_m,
        );
        Some(Placement {
            alignment,
            agreement,
            merit: agreement.score(),
            lead: None,
        })
    }

    /// Aligns from a guess and adds the result, unless the guess leads where another has led already, or far behind the best.
    pub fn try_guess(&mut self, guess: &Guess) {
        if self.known(guess.map_from_scan).next().is_some() {
            return;
        }
        if let Some(start) = self.glance(guess)
            && let Some(placement) = self.aligned_from(&start, guess)
        {
            self.take(placement);
        }
    }

    /// What was found near a pose.
    fn known(&self, pose: Pose) -> impl Iterator<Item = &Placement> {
        self.found.iter().filter(move |p| {
            let other = p.alignment.map_from_scan;
            other.distance(pose) < SAME_GUESS_M
                && wrap_rad(other.theta_rad - pose.theta_rad).abs() < SAME_GUESS_RAD
        })
    }

    /// A few of the returns are aligned and judged: where to go on from with all of them. `None` when the guess leads to what was
    /// found before, or to what is much worse. (Of the guesses for scans of keyframe logs a quarter are of the one kind,
    /// half of the other; of those worth while, three in a hundred are lost so.)
    ///
    /// Where scans follow each other closely, all are aligned: along a corridor poses a few centimetres apart are to be weighed
    /// against each other, or it comes out too long.
    fn glance(&self, guess: &Guess) -> Option<Guess> {
        let best = self.found.iter().map(|p| p.merit).max_by(f64::total_cmp);
        let Some(best) = best.filter(|_| self.motion.is_of_keyframes()) else {
            return Some(*guess);
        };
        let few = self.few.get_or_init(|| every_few(self.points));
        let glance = AlignSettings {
            max_rounds: GLANCE_ROUNDS,
            ..*self.align
        };
        let prior = guess.prior();
        let Some(alignment) = align_to_grid(few, self.map, |_, _| true, guess, Some(&prior), &glance) else {
            return Some(*guess);
        };
        let pose = alignment.map_from_scan;
        let score = judge(few, self.map, pose, self.settings.gate_m).score();
        let merit = score - self.unlikely(&alignment);
        let is_idle = merit < best - HOPELESS_BEHIND || self.known(pose).any(|p| merit < p.merit + NO_BETTER);
        (!is_idle).then_some(Guess {
            map_from_scan: pose,
            sigma_m: GLANCED_M,
            sigma_rad: GLANCED_RAD,
        })
    }

    /// Adds a pose; what the motion so far makes unlikely counts against it.
    pub fn take(&mut self, placement: Placement) {
        let merit = placement.merit - self.unlikely(&placement.alignment);
        self.found.push(Placement { merit, ..placement });
    }

    /// What a pose loses for being unlikely after the motion so far: the more, the less the scan itself has to say. Along a
    /// direction that the walls leave open, the motion is all there is to go by.
    fn unlikely(&self, alignment: &Alignment) -> f64 {
        let peak = *self.peak.get_or_init(|| self.motion.peak());
        -self.settings.merit_per_nat / self.weight * self.motion.log_likelihood(alignment.map_from_scan, peak)
    }

    pub fn is_unsurprising(&self, p: &Placement) -> bool {
        let predicted = self.motion.predicted();
        let off_m = p.alignment.map_from_scan.distance(predicted.map_from_scan);
        let off_rad = wrap_rad(p.alignment.map_from_scan.theta_rad - predicted.map_from_scan.theta_rad).abs();
        self.motion.lost_scans == 0
            && self.motion.is_smooth()
            && p.agreement.fit() >= self.settings.good_fit
            && p.agreement.known_share() >= 0.5
            && p.alignment.matched_share() >= 0.5
            && off_m <= 2.0 * predicted.sigma_m
            && off_rad <= 2.0 * predicted.sigma_rad
    }

    /// How far from the predicted place a scanner can be that has moved as before, metres: ten times as far as
    /// usual. While scans cannot be placed it may wander off.
    fn reach_m(&self) -> f64 {
        self.usual_reach_m() + (0.5 * f64::from(self.motion.lost_scans)).min(6.0)
    }

    fn usual_reach_m(&self) -> f64 {
        let usual_m = 0.5 + 10.0 * self.motion.usual.shift_m;
        usual_m.min(self.settings.window_m) + self.motion.step.translation().norm()
    }

    pub fn is_good(&self, p: &Placement) -> bool {
        p.agreement.fit() >= self.settings.good_fit && p.agreement.known_share() >= 0.5
    }

    /// Whether a pose is believed: where the scanner was expected, on fair evidence; elsewhere only on good evidence and
    /// when nothing else comes near. After a gap everything is elsewhere, and a corridor looks like every other.
    fn is_believed(&self, p: &Placement) -> bool {
        let settings = self.settings;
        let predicted = self.motion.predicted().map_from_scan;
        let off_m = predicted.distance(p.alignment.map_from_scan);
        let off_rad = wrap_rad(predicted.theta_rad - p.alignment.map_from_scan.theta_rad).abs();
        let (fit, known) = (p.agreement.fit(), p.agreement.known_share());
        if off_m < self.usual_reach_m() && off_rad < 0.2 + 3.0 * self.motion.usual.turn_rad {
            return fit >= settings.least_fit && known >= settings.least_known;
        }
        fit >= settings.far_fit && known >= settings.far_known && p.alignment.matched_share() >= 0.5
    }

    /// What is believed and differs from what is better, best first.
    pub fn believed(&self) -> Vec<Placement> {
        let mut out: Vec<Placement> = Vec::new();
        for p in &self.found {
            let pose = p.alignment.map_from_scan;
            let differs = |other: &Placement| {
                let other = other.alignment.map_from_scan;
                other.distance(pose) > 0.25 || wrap_rad(other.theta_rad - pose.theta_rad).abs() > 0.07
            };
            if self.is_believed(p) && out.iter().all(differs) {
                out.push(*p);
            }
        }
        out
    }

    /// The motion so far, as an estimate for matching in the frame of the last pose; wide, because matching is asked
    /// when the prediction has failed.
    pub fn estimate(&self) -> PoseGaussian {
        let wider = 1.0 + 0.5 * f64::from(self.motion.lost_scans.min(10));
        PoseGaussian {
            mean: self.motion.expected_step(),
            information: unmoved().information.scaled(1.0 / (wider * wider)),
        }
    }

    /// Sorts what was found, best first, and says how far the best leads.
    pub fn best(&mut self) -> Option<Placement> {
        let all = &mut self.found;
        all.sort_by(|a, b| b.merit.total_cmp(&a.merit));
        let winner = all.first().copied()?;
        let pose = winner.alignment.map_from_scan;
        let second = all.iter().find(|p| {
            let other = p.alignment.map_from_scan;
            other.distance(pose) > 0.5 || wrap_rad(other.theta_rad - pose.theta_rad).abs() > 0.17
        });
        Some(Placement {
            lead: second.map(|s| winner.merit - s.merit),
            ..winner
        })
    }

    /// Candidates from the search of all poses in a window.
    pub fn search(&mut self) {
        let predicted = self.motion.predicted().map_from_scan;
        let lost = f64::from(self.motion.lost_scans);
        let window = Window {
            centre: predicted,
            half_m: self.reach_m(),
            half_rad: self.settings.window_rad + (0.1 * lost).min(1.4),
            wanted: self.settings.candidates,
            min_score: 0.25,
        };
        let reach_m = self.points.iter().map(|p| p.point.norm()).fold(0.0, f64::max) + window.half_m + 1.0;
        let sides = self.map.sides().map(|s| s.segment);
        let Some(field) = Field::new(sides, predicted.translation(), reach_m) else {
            return;
        };
        for c in search(&field, &thinned(self.points), &window) {
            self.try_guess(&Guess {
                map_from_scan: c.map_from_scan,
                sigma_m: 0.07,
                sigma_rad: 0.02,
            });
        }
    }
}

/// At most sixty of the returns; each stands for those left out.
fn every_few(points: &[SidePoint]) -> Vec<SidePoint> {
    let step = points.len().div_ceil(FEW).max(1);
    let worth = step as f64;
    let few = points.iter().step_by(step);
    few.map(|p| SidePoint {
        worth: p.worth * worth,
        ..*p
    })
    .collect()
}
