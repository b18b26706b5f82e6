//! The poses looked at for one scan: aligned, judged, and what is believed of them.

use std::cell::OnceCell;

use super::judge::judge;
use super::search::{Field, Window, search};
use super::{Motion, Origin, PlaceSettings, Placement, thinned};
use crate::align::{AlignSettings, Alignment, FULL_WORTH, Guess, Prior, SidePoint, align_to_grid, worth};
use crate::geometry::{SideGrid, wrap_rad};
use crate::matching::{PoseGaussian, unmoved};

/// A guess nearer than this to a pose that was found leads there, metres and radians.
const SAME_GUESS_M: f64 = 0.05;
const SAME_GUESS_RAD: f64 = 0.02;

pub(super) struct Stage<'a> {
    points: &'a [SidePoint],
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
    pub fn aligned(&self, origin: Origin, guess: &Guess) -> Option<Placement> {
        self.aligned_to(origin, guess, &guess.prior())
    }

    /// The same from the predicted pose.
    pub fn predicted(&self) -> Option<Placement> {
        self.aligned_to(Origin::Predicted, &self.motion.predicted(), &self.motion.prior())
    }

    fn aligned_to(&self, origin: Origin, guess: &Guess, prior: &Prior) -> Option<Placement> {
        let alignment = align_to_grid(self.points, self.map, |_, _| true, guess, Some(prior), self.align)?;
        let agreement = judge(
            self.points,
            self.map,
            alignment.map_from_scan,
            self.settings.gate_m,
        )
        .with_other_faces();
        Some(Placement {
            origin,
            alignment,
            agreement,
            merit: agreement.score(),
            lead: None,
        })
    }

    /// Aligns from a guess and adds the result, unless the guess leads where another has led already.
    pub fn try_guess(&mut self, origin: Origin, guess: &Guess) {
        let is_known = |p: &Placement| {
            let pose = p.alignment.map_from_scan;
            pose.is_within(SAME_GUESS_M, SAME_GUESS_RAD, guess.map_from_scan)
        };
        if !self.found.iter().any(is_known)
            && let Some(placement) = self.aligned(origin, guess)
        {
            self.take(placement);
        }
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
            && p.agreement.fit() >= self.fit_to_go_on()
            && p.agreement.known_share() >= 0.5
            && p.alignment.matched_share() >= 0.5
            && off_m <= 2.0 * predicted.sigma_m
            && off_rad <= 2.0 * predicted.sigma_rad
    }

    fn fit_to_go_on(&self) -> f64 {
        match self.motion.open_sigmas() {
            Some(_) => self.settings.open_fit,
            None => self.settings.good_fit,
        }
    }

    /// How far from the predicted place a scanner can be that has moved as before, metres: ten times as far as
    /// usual. While scans cannot be placed it may wander off.
    fn reach_m(&self) -> f64 {
        self.usual_reach_m() + (0.5 * f64::from(self.motion.lost_scans)).min(6.0)
    }

    fn usual_reach_m(&self) -> f64 {
        let usual_m = 0.5 + 10.0 * self.motion.usual.shift_m;
        usual_m.min(self.settings.window_m) + self.motion.step().translation().norm()
    }

    pub fn is_good(&self, p: &Placement) -> bool {
        p.agreement.fit() >= self.settings.good_fit && p.agreement.known_share() >= 0.5
    }

    /// Whether a pose is believed: where the scanner was expected, on fair evidence; elsewhere only on good evidence and
    /// when nothing else comes near. After a gap everything is elsewhere, and a corridor looks like every other. A scan that shows
    /// little does not tell of places elsewhere: 33 returns of a simulated warehouse fitted 6 m away.
    fn is_believed(&self, p: &Placement) -> bool {
        let settings = self.settings;
        let predicted = self.motion.predicted().map_from_scan;
        let off_m = predicted.distance(p.alignment.map_from_scan);
        let off_rad = wrap_rad(predicted.theta_rad - p.alignment.map_from_scan.theta_rad).abs();
        let (fit, known) = (p.agreement.fit(), p.agreement.known_share());
        if off_m < self.usual_reach_m() && off_rad < 0.2 + 3.0 * self.motion.usual.turn_rad {
            return fit >= settings.least_fit && known >= settings.least_known;
        }
        let matched = p.alignment.matched_share();
        // Returns of which the map says nothing cannot be matched: where no more than a beam or two contradict it, they do not
        // speak against a pose. (Asked for half of all, the right pose at a door, 63 % known and all of it fitting, was given up
        // for one 3.9 m away.)
        let is_matched = matched >= 0.5 || (fit >= settings.open_fit && matched >= 0.5 * known);
        self.weight >= 1.0 && fit >= settings.far_fit && known >= settings.far_known && is_matched
    }

    /// What is believed and differs from what is better, best first.
    pub fn believed(&self) -> Vec<Placement> {
        let mut out: Vec<Placement> = Vec::new();
        for p in &self.found {
            let pose = p.alignment.map_from_scan;
            let differs = |other: &Placement| !other.alignment.map_from_scan.is_within(0.25, 0.07, pose);
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
        let differs = |p: &&Placement| !p.alignment.map_from_scan.is_within(0.5, 0.17, pose);
        let second = all.iter().find(differs);
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
            let guess = Guess {
                map_from_scan: c.map_from_scan,
                sigma_m: 0.07,
                sigma_rad: 0.02,
            };
            self.try_guess(Origin::Search, &guess);
        }
    }
}
