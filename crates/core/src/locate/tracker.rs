//! From scan to scan in a map that does not change.
//!
//! In: scans in order, with their stamps. Out: the pose of each. A pose is carried on only where the log itself has shown
//! that scans follow each other closely: the last few were each found without a guess and lie within a step of one
//! another. Then the next is expected where going on as before leads, and the walls correct that, with the covariance of
//! both (a Kalman filter in information form), so that along a bare corridor the doubt grows until it is said. A
//! scan that does not fit there, or comes after a longer gap than usual, is looked for in the whole map again.

use super::likelihood::Pieces;
use super::{Fix, Localisation, Locator, Verdict};
use crate::align::{Guess, Information, Prior, SidePoint, align_to_grid};
use crate::geometry::{Pose, wrap_rad};
use crate::scan::Scan;

/// Scans found one by one before the next is expected near.
const LEAST_RUN: u32 = 4;
/// Steps longer than this are no going on, metres and radians.
const CLOSE_M: f64 = 0.5;
const CLOSE_RAD: f64 = 0.5;
/// A gap so many times as long as usual is no going on.
const LONG_GAP: f64 = 2.5;
/// Standard deviations of a step that is made again: a scanner speeds up and turns.
const STEP_SIGMA_M: f64 = 0.02;
const STEP_SIGMA_RAD: f64 = 0.02;
const STEP_SIGMA_SHARE: f64 = 0.3;
/// Farther from the expected pose than this many standard deviations is a surprise.
const SURPRISE_SIGMAS: f64 = 3.0;
/// What the walls of a map know is worse than their noise says, metres and radians.
const MAP_SIGMA_M: f64 = 0.01;
const MAP_SIGMA_RAD: f64 = 0.004;
/// A pose that is known worse than this in some direction is said to be ambiguous, metres.
const KNOWN_SIGMA_M: f64 = 0.1;
/// A score this much below the usual is a surprise.
const SCORE_DROP: f64 = 0.15;

/// Finds the scans of a log in a map.
pub struct Tracker {
    locator: Locator,
    last: Option<Last>,
}

/// Where the last scan was found.
#[derive(Clone, Copy)]
struct Last {
    map_from_scan: Pose,
    /// From the scan before, in its frame.
    step: Pose,
    information: Information,
    /// Running mean of the score.
    score: f64,
    stamp_s: Option<f64>,
    /// Usual time between scans, seconds.
    gap_s: Option<f64>,
    /// Scans in a row that followed each other closely.
    run: u32,
}

/// A scan's place, and whether it was carried on from the scan before.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// The place.
    pub localisation: Localisation,
    /// `true`: expected from the scans before and corrected by the walls. `false`: found without a guess.
    pub is_carried_on: bool,
}

impl Tracker {
    /// Nothing is known of the scanner yet.
    #[must_use]
    pub fn new(locator: Locator) -> Self {
        Self { locator, last: None }
    }

    /// What is known of the scanner's place is forgotten: the next scan is found without a guess.
    pub fn forget(&mut self) {
        self.last = None;
    }

    /// Finds the next scan.
    pub fn add_scan(&mut self, scan: &Scan, stamp_s: Option<f64>) -> Tracked {
        let points = self.locator.points_of(scan);
        if let Some((fix, information)) = self.carried_on(&points, stamp_s) {
            let verdict = if is_known(&information) {
                Verdict::Located
            } else {
                Verdict::Ambiguous
            };
            self.note(&fix, information, stamp_s);
            return Tracked {
                localisation: Localisation {
                    verdict,
                    confidence: 1.0,
                    fixes: vec![fix],
                },
                is_carried_on: true,
            };
        }
        let localisation = self.locator.find_points(&points);
        match localisation.fixes.first() {
            Some(fix) if localisation.verdict == Verdict::Located => {
                self.note(
                    fix,
                    fix.information.with_noise(MAP_SIGMA_M, MAP_SIGMA_RAD),
                    stamp_s,
                );
            }
            _ => self.last = None,
        }
        Tracked {
            localisation,
            is_carried_on: false,
        }
    }

    /// The pose where going on as before leads, corrected by the walls, with its information; `None` where that is
    /// not expected or does not fit.
    fn carried_on(&self, points: &[SidePoint], stamp_s: Option<f64>) -> Option<(Fix, Information)> {
        let last = self.last.filter(|l| l.run >= LEAST_RUN && l.is_soon(stamp_s))?;
        let guess = last.expected();
        let information = last.information.with_noise(guess.sigma_m, guess.sigma_rad);
        let prior = Prior {
            map_from_scan: guess.map_from_scan,
            information,
        };
        let locator = &self.locator;
        let alignment = align_to_grid(
            points,
            &locator.sides,
            |_, _| true,
            &guess,
            Some(&prior),
            &locator.align,
        )?;
        let fix = locator.fix_at(points, &Pieces::of(points), &alignment);
        let off_m = fix.map_from_scan.distance(guess.map_from_scan);
        let off_rad = wrap_rad(fix.map_from_scan.theta_rad - guess.map_from_scan.theta_rad).abs();
        let fits = fix.agreement.fit() >= locator.settings.least_fit
            && fix.agreement.known_share() >= locator.settings.least_known
            && fix.score >= last.score - SCORE_DROP
            && off_m <= SURPRISE_SIGMAS * guess.sigma_m
            && off_rad <= SURPRISE_SIGMAS * guess.sigma_rad;
        let walls = fix.information.with_noise(MAP_SIGMA_M, MAP_SIGMA_RAD);
        fits.then(|| (fix, information.plus(&walls)))
    }

    fn note(&mut self, fix: &Fix, information: Information, stamp_s: Option<f64>) {
        let pose = fix.map_from_scan;
        self.last = Some(match &self.last {
            None => Last {
                map_from_scan: pose,
                step: Pose::IDENTITY,
                information,
                score: fix.score,
                stamp_s,
                gap_s: None,
                run: 0,
            },
            Some(last) => {
                let step = last.map_from_scan.inverse() * pose;
                let is_close = step.translation().norm() < CLOSE_M && step.theta_rad.abs() < CLOSE_RAD;
                let gap_s = last.gap_to(stamp_s);
                Last {
                    map_from_scan: pose,
                    step: if is_close { step } else { Pose::IDENTITY },
                    information,
                    score: last.score + 0.2 * (fix.score - last.score),
                    stamp_s,
                    gap_s: match (last.gap_s, gap_s) {
                        (Some(usual), Some(gap)) => Some(usual + 0.2 * (gap - usual)),
                        (usual, gap) => usual.or(gap),
                    },
                    run: if is_close { last.run + 1 } else { 0 },
                }
            }
        });
    }
}

impl Last {
    fn expected(&self) -> Guess {
        Guess {
            map_from_scan: self.map_from_scan * self.step,
            sigma_m: STEP_SIGMA_M + STEP_SIGMA_SHARE * self.step.translation().norm(),
            sigma_rad: STEP_SIGMA_RAD + STEP_SIGMA_SHARE * self.step.theta_rad.abs(),
        }
    }

    /// Time since, seconds; stamps may run backwards.
    fn gap_to(&self, stamp_s: Option<f64>) -> Option<f64> {
        Some((stamp_s? - self.stamp_s?).abs())
    }

    /// Whether the next scan comes after no longer a time than usual, as far as the log tells.
    fn is_soon(&self, stamp_s: Option<f64>) -> bool {
        match (self.gap_s, self.gap_to(stamp_s)) {
            (Some(usual_s), Some(gap_s)) => gap_s <= LONG_GAP * usual_s,
            _ => true,
        }
    }
}

/// Whether the place is known in every direction.
fn is_known(information: &Information) -> bool {
    information.weakest_direction().1 >= 1.0 / (KNOWN_SIGMA_M * KNOWN_SIGMA_M)
}
