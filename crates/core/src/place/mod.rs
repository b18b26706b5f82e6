//! Where a scan is in the map: prediction when that settles it, matching by shape and search when it does not.
//!
//! In: a scan's polylines and returns, the map around, the motion so far. Out: the pose that agrees best with the whole
//! scan, or none.
//!
//! 1. The predicted pose is aligned. Full-rate scans move a few centimetres, and this settles nearly all of them.
//! 2. When the scan disagrees with it (a standstill after motion, somebody walking along), standing still and a
//!    wider guess are tried.
//! 3. The paper's way (sections 2 and 3.3): the polylines are matched by shape with the virtual scan, and every pose that
//!    the correspondences induce is aligned.
//! 4. If none of these stands out, all poses in a window around are searched (`search`).
//!
//! Every pose is judged by what the whole scan says of the map, fit and two-way visibility (`judge`), and by what
//! the motion so far makes likely. The best is taken if it is good enough; otherwise the scan has no place.

pub(crate) mod judge;
mod motion;
pub(crate) mod search;
mod virtual_scan;

use std::cell::OnceCell;

use crate::align::{AlignSettings, Alignment, Guess, SidePoint, align_to_grid};
use crate::extract::ScanPolyline;
use crate::geometry::{Point, Polyline, SideGrid, wrap_rad};
use crate::matching::{Matching, PoseGaussian, match_polylines, unmoved};
use crate::merge::growing_map::GrowingMap;
pub use judge::Agreement;
use judge::judge;
pub(crate) use motion::Motion;
use search::{Field, Window, search};
use virtual_scan::virtual_scan;

/// A pose and what speaks for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    pub alignment: Alignment,
    pub agreement: Agreement,
    /// [`Agreement::score`] less what the motion so far makes unlikely.
    pub merit: f64,
    /// How much worse the best other pose is, at least 0.5 m or 10° away; `None` when none was looked for.
    pub lead: Option<f64>,
}

/// When a pose is believed.
#[derive(Clone, Copy, Debug)]
pub struct PlaceSettings {
    /// Distance at which a return still lies on a side of the map, metres.
    pub gate_m: f64,
    /// A predicted pose with this share of agreeing beams needs no second look.
    pub good_fit: f64,
    /// A pose near the predicted one with a smaller share of agreeing beams is not believed,
    pub least_fit: f64,
    /// nor one from which the map says something of fewer beams.
    pub least_known: f64,
    /// The same for a pose elsewhere,
    pub far_fit: f64,
    /// see `least_known`,
    pub far_known: f64,
    /// and by how much it must lead the next best one.
    pub far_lead: f64,
    /// A pose that leads the next best, different one by so much needs no further search.
    pub clear_lead: f64,
    /// Half the width of the search window, metres; it grows while scans cannot be placed.
    pub window_m: f64,
    /// Half the range of headings searched, radians.
    pub window_rad: f64,
    /// What a pose loses of its merit for every e-fold that the motion so far makes it less likely.
    pub merit_per_nat: f64,
    /// Poses that the search hands on to alignment.
    pub candidates: usize,
}

impl Default for PlaceSettings {
    fn default() -> Self {
        Self {
            gate_m: 0.10,
            good_fit: 0.8,
            least_fit: 0.5,
            least_known: 0.3,
            far_fit: 0.7,
            far_known: 0.5,
            far_lead: 0.1,
            clear_lead: 0.15,
            window_m: 2.5,
            window_rad: 1.75,
            merit_per_nat: 0.03,
            candidates: 8,
        }
    }
}

/// What is to be placed, and where.
#[derive(Clone, Copy)]
pub(crate) struct Question<'a> {
    /// The scan's returns on their sides, laser frame.
    pub points: &'a [SidePoint],
    /// The scan's polylines, laser frame.
    pub polylines: &'a [ScanPolyline],
    /// The map around.
    pub map: &'a GrowingMap,
    /// The polylines of the map that the last scan was merged into.
    pub merged_into: &'a [u32],
    /// The motion so far.
    pub motion: &'a Motion,
}

/// The answer, and the shape matching if one was needed.
#[derive(Default)]
pub(crate) struct Answer {
    /// `None` when no pose is believed.
    pub placement: Option<Placement>,
    pub matching: Option<Matching>,
    /// What it was matched with, frame of the last placed scan.
    pub virtual_scan: Option<Vec<Polyline>>,
    /// Every pose that was aligned and judged, best first.
    pub hypotheses: Vec<Placement>,
    /// Those of them that are believed and differ, best first; `placement` is the first.
    pub believed: Vec<Placement>,
}

impl Answer {
    /// Nothing else needed to be looked at.
    fn settled(placement: Placement) -> Self {
        Self {
            placement: Some(placement),
            believed: vec![placement],
            hypotheses: vec![placement],
            ..Self::default()
        }
    }
}

/// Finds the scan's pose.
pub(crate) fn place(question: Question, align: &AlignSettings, settings: &PlaceSettings) -> Answer {
    let Question {
        points, map, motion, ..
    } = question;
    let mut stage = Stage {
        points,
        map: &map.skeleton,
        motion,
        peak: OnceCell::new(),
        align,
        settings,
        found: Vec::new(),
    };
    if let Some(p) = stage.aligned(&motion.predicted()) {
        if stage.is_unsurprising(&p) {
            return Answer::settled(p);
        }
        stage.take(p);
    }
    stage.try_guess(&motion.standing());
    let wide = Guess {
        sigma_m: 0.2,
        sigma_rad: 0.1,
        ..motion.predicted()
    };
    stage.try_guess(&wide);
    for guess in motion.as_before(6) {
        stage.try_guess(&guess);
    }
    if let Some(p) = stage.best()
        && stage.is_good(&p)
        && motion.is_smooth()
    {
        return Answer::settled(p);
    }
    let reference = virtual_scan(map, motion.map_from_scan, question.merged_into);
    let matching = match_by_shape(question.polylines, &reference, &mut stage);
    let mut best = stage.best();
    if !best.is_some_and(|p| stage.is_good(&p) && p.lead.is_none_or(|lead| lead > settings.clear_lead)) {
        stage.search();
        best = stage.best();
    }
    let believed = stage.believed();
    Answer {
        placement: believed.first().map(|b| Placement {
            lead: best.and_then(|p| p.lead),
            ..*b
        }),
        believed,
        matching: Some(matching),
        virtual_scan: Some(reference),
        hypotheses: stage.found,
    }
}

/// The paper's way (section 3.3): the scan's polylines are matched by shape with the virtual scan, and every alignment
/// that the correspondences induce is a candidate.
fn match_by_shape(polylines: &[ScanPolyline], reference: &[Polyline], stage: &mut Stage) -> Matching {
    let map_from_last = stage.motion.map_from_scan;
    let scan: Vec<Polyline> = polylines.iter().map(|p| p.polyline.clone()).collect();
    let matching = match_polylines(&scan, reference, &stage.estimate());
    for h in &matching.hypotheses {
        stage.try_guess(&Guess {
            map_from_scan: map_from_last * h.reference_from_scan,
            sigma_m: 0.1,
            sigma_rad: 0.03,
        });
    }
    matching
}

/// A guess nearer than this to a pose that was found leads there, metres and radians.
const SAME_GUESS_M: f64 = 0.05;
const SAME_GUESS_RAD: f64 = 0.02;

struct Stage<'a> {
    points: &'a [SidePoint],
    map: &'a SideGrid,
    motion: &'a Motion,
    /// [`Motion::peak`], computed once.
    peak: OnceCell<f64>,
    align: &'a AlignSettings,
    settings: &'a PlaceSettings,
    /// What was found so far.
    found: Vec<Placement>,
}

impl Stage<'_> {
    /// Aligns from a guess and judges the result. The guess is its own prior: along a corridor the scan stays where
    /// it was guessed to be, instead of sliding to where the noise of the walls would have it.
    fn aligned(&self, guess: &Guess) -> Option<Placement> {
        let prior = guess.prior();
        let alignment = align_to_grid(
            self.points,
            self.map,
            |_, _| true,
            guess,
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

    /// Aligns from a guess and adds the result, unless the guess leads where another has led already.
    fn try_guess(&mut self, guess: &Guess) {
        let is_known = |p: &Placement| {
            let pose = p.alignment.map_from_scan;
            pose.distance(guess.map_from_scan) < SAME_GUESS_M
                && wrap_rad(pose.theta_rad - guess.map_from_scan.theta_rad).abs() < SAME_GUESS_RAD
        };
        if !self.found.iter().any(is_known)
            && let Some(placement) = self.aligned(guess)
        {
            self.take(placement);
        }
    }

    /// Adds a pose; what the motion so far makes unlikely counts against it.
    fn take(&mut self, placement: Placement) {
        let merit = placement.merit - self.unlikely(&placement.alignment);
        self.found.push(Placement { merit, ..placement });
    }

    /// What a pose far from the predicted one loses: a weak prior of going on as before, at most 0.15. Along a
    /// direction that the walls leave open, the motion is all there is to go by.
    fn unlikely(&self, alignment: &Alignment) -> f64 {
        let peak = *self.peak.get_or_init(|| self.motion.peak());
        -self.settings.merit_per_nat * self.motion.log_likelihood(alignment.map_from_scan, peak)
    }

    fn is_unsurprising(&self, p: &Placement) -> bool {
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

    fn is_good(&self, p: &Placement) -> bool {
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
    fn believed(&self) -> Vec<Placement> {
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
    fn estimate(&self) -> PoseGaussian {
        let wider = 1.0 + 0.5 * f64::from(self.motion.lost_scans.min(10));
        PoseGaussian {
            mean: self.motion.expected_step(),
            information: unmoved().information.scaled(1.0 / (wider * wider)),
        }
    }

    /// Sorts what was found, best first, and says how far the best leads.
    fn best(&mut self) -> Option<Placement> {
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
    fn search(&mut self) {
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

/// Distance between points of a scan that are searched with, metres.
const THINNED_M: f64 = 0.15;

/// Points with the direction of their sides, some 0.15 m apart, so that near walls do not outvote far ones.
pub(crate) fn thinned(points: &[SidePoint]) -> Vec<(Point, Point)> {
    let mut out: Vec<(Point, Point)> = Vec::new();
    for p in points {
        if out
            .last()
            .is_none_or(|(last, _)| last.distance(p.point) >= THINNED_M)
        {
            out.push((p.point, p.direction));
        }
    }
    out
}
