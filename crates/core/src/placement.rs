//! Where a scan is in the map: prediction when that settles it, search when it does not.
//!
//! In: the scan's returns on their sides, the map around, the motion so far. Out: the pose that agrees best with the
//! whole scan. Full-rate scans move a few centimetres, and the first alignment from the predicted pose is right; when
//! the scan disagrees with it (a jump, a standstill after motion, somebody walking along), other poses are tried, and
//! if none agrees, all poses in a window around ([`crate::search`]).

use crate::align::{AlignSettings, Alignment, Guess, Prior, SidePoint, align_to_grid};
use crate::geometry::{Point, Pose, SideGrid, wrap_rad};
use crate::judge::{Agreement, judge};
use crate::search::{Field, Window, search};

/// The scanner's last pose and how it moved to it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub map_from_scan: Pose,
    /// From the last scan but one to the last, in the frame of the former.
    pub step: Pose,
    /// Scans since, that could not be placed.
    pub lost_scans: u32,
}

impl Motion {
    /// Where the scanner is when it keeps on moving as before.
    fn predicted(&self) -> Guess {
        Guess {
            map_from_scan: self.map_from_scan * self.step,
            ..self.standing()
        }
    }

    /// Where it is when it has stopped. Speeds change by some centimetres a scan, the more the faster it is.
    fn standing(&self) -> Guess {
        Guess {
            map_from_scan: self.map_from_scan,
            sigma_m: 0.02 + 0.3 * self.step.translation().norm(),
            sigma_rad: 0.02 + 0.3 * self.step.theta_rad.abs(),
        }
    }
}

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
    /// A pose with a smaller share of agreeing beams is not believed.
    pub least_fit: f64,
    /// A pose from which the map says nothing about so many beams is not believed.
    pub least_known: f64,
    /// Half the width of the search window, metres; it grows while scans cannot be placed.
    pub window_m: f64,
    /// Half the range of headings searched, radians.
    pub window_rad: f64,
    /// Poses that the search hands on to alignment.
    pub candidates: usize,
}

impl Default for PlaceSettings {
    fn default() -> Self {
        Self {
            gate_m: 0.10,
            good_fit: 0.8,
            least_fit: 0.6,
            least_known: 0.3,
            window_m: 2.5,
            window_rad: 1.75,
            candidates: 8,
        }
    }
}

/// Finds the scan's pose among the sides of `map`; `None` when no pose is believed.
pub(crate) fn place(
    points: &[SidePoint],
    map: &SideGrid,
    motion: &Motion,
    align: &AlignSettings,
    settings: &PlaceSettings,
) -> Option<Placement> {
    let stage = Stage {
        points,
        map,
        motion,
        align,
        settings,
    };
    let predicted = stage.try_guess(&motion.predicted(), true);
    if let Some(p) = predicted
        && stage.is_unsurprising(&p)
    {
        return Some(p);
    }
    let standing = stage.try_guess(&motion.standing(), false);
    let wide = Guess {
        sigma_m: 0.2,
        sigma_rad: 0.1,
        ..motion.predicted()
    };
    let wide = stage.try_guess(&wide, false);
    let best = [predicted, standing, wide]
        .into_iter()
        .flatten()
        .max_by(|a, b| a.merit.total_cmp(&b.merit));
    if let Some(p) = best
        && p.agreement.fit() >= settings.good_fit
        && p.agreement.known_share() >= 0.5
        && motion.lost_scans == 0
    {
        return Some(p);
    }
    stage.search(best).filter(|p| {
        p.agreement.fit() >= settings.least_fit && p.agreement.known_share() >= settings.least_known
    })
}

struct Stage<'a> {
    points: &'a [SidePoint],
    map: &'a SideGrid,
    motion: &'a Motion,
    align: &'a AlignSettings,
    settings: &'a PlaceSettings,
}

impl Stage<'_> {
    fn try_guess(&self, guess: &Guess, with_prior: bool) -> Option<Placement> {
        let prior: Option<Prior> = with_prior.then(|| guess.prior());
        let alignment = align_to_grid(
            self.points,
            self.map,
            |_, _| true,
            guess,
            prior.as_ref(),
            self.align,
        )?;
        let agreement = judge(
            self.points,
            self.map,
            alignment.map_from_scan,
            self.settings.gate_m,
        );
        let merit = agreement.score() - self.unlikely(alignment.map_from_scan);
        Some(Placement {
            alignment,
            agreement,
            merit,
            lead: None,
        })
    }

    /// What a pose far from the predicted one loses: a weak prior of going on as before, at most 0.15.
    fn unlikely(&self, map_from_scan: Pose) -> f64 {
        let predicted = self.motion.predicted().map_from_scan;
        let scale = 1.0 + f64::from(self.motion.lost_scans);
        let sigma_m = (0.3 + 0.5 * self.motion.step.translation().norm()) * scale;
        let off_m = predicted.distance(map_from_scan) / sigma_m;
        let off_rad = wrap_rad(predicted.theta_rad - map_from_scan.theta_rad) / (0.4 * scale);
        (0.005 * (off_m * off_m + off_rad * off_rad)).min(0.15)
    }

    fn is_unsurprising(&self, p: &Placement) -> bool {
        let predicted = self.motion.predicted();
        let off_m = p.alignment.map_from_scan.distance(predicted.map_from_scan);
        let off_rad = wrap_rad(p.alignment.map_from_scan.theta_rad - predicted.map_from_scan.theta_rad).abs();
        self.motion.lost_scans == 0
            && p.agreement.fit() >= self.settings.good_fit
            && p.agreement.known_share() >= 0.5
            && p.alignment.matched_share() >= 0.5
            && off_m <= 2.0 * predicted.sigma_m
            && off_rad <= 2.0 * predicted.sigma_rad
    }

    fn search(&self, best: Option<Placement>) -> Option<Placement> {
        let predicted = self.motion.predicted().map_from_scan;
        let lost = f64::from(self.motion.lost_scans);
        let window = Window {
            centre: predicted,
            half_m: self.settings.window_m + self.motion.step.translation().norm() + (0.5 * lost).min(6.0),
            half_rad: self.settings.window_rad + (0.1 * lost).min(1.4),
            wanted: self.settings.candidates,
            min_score: 0.25,
        };
        let reach_m = self.points.iter().map(|p| p.point.norm()).fold(0.0, f64::max) + window.half_m + 1.0;
        let field = Field::new(
            self.map.sides().map(|s| s.segment),
            predicted.translation(),
            reach_m,
        )?;
        let found = search(&field, &thinned(self.points), &window);
        let mut all: Vec<Placement> = best.into_iter().collect();
        all.extend(found.iter().filter_map(|c| {
            let guess = Guess {
                map_from_scan: c.map_from_scan,
                sigma_m: 0.07,
                sigma_rad: 0.02,
            };
            self.try_guess(&guess, false)
        }));
        all.sort_by(|a, b| b.merit.total_cmp(&a.merit));
        let winner = all.first().copied()?;
        let pose = winner.alignment.map_from_scan;
        let second = all.iter().find(|p| {
            let other = p.alignment.map_from_scan;
            other.distance(pose) > 0.5 || wrap_rad(other.theta_rad - pose.theta_rad).abs() > 0.17
        });
        Some(Placement {
            lead: Some(second.map_or(1.0, |s| winner.merit - s.merit)),
            ..winner
        })
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
