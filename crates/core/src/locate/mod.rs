//! Where a scan was taken in a finished map, without a guess; and then from scan to scan.
//!
//! In: a map, scans. Out for each scan: poses that explain it, best first, and whether the best is the only one.
//!
//! 1. All poses of the map are searched by branch and bound (`search`).
//! 2. The best few dozen are aligned (`align`) and judged by how likely the whole scan is from them (`likelihood`): where
//!    every beam ends, what it went through, and of what the map says nothing.
//! 3. *Located* is a scan that fits, and from no other pose nearly as well; *ambiguous* one that fits, but from another
//!    pose as well or anywhere along a wall; *not found* one that fits nowhere.
//!
//! Many scans of one map, each located in another, vote on where the one lies in the other (`votes`).

mod field;
mod likelihood;
mod search;
mod tracker;
pub(crate) mod votes;

use crate::align::{AlignSettings, Alignment, Guess, Information, SidePoint, align_to_grid, side_points};
use crate::extract::{ExtractSettings, RunningNoise, extract};
use crate::geometry::{Pose, SideGrid};
use crate::map::Map;
use crate::place::{Agreement, thinned};
use crate::scan::Scan;
use field::Field;
use likelihood::Pieces;
use search::{Wanted, search};
pub use tracker::{Tracked, Tracker};

/// When a pose in a finished map is believed.
#[derive(Clone, Copy, Debug)]
pub struct LocateSettings {
    /// Poses that the search hands on to alignment.
    pub candidates: usize,
    /// Smallest score of the search worth a look, 0..=1.
    pub min_score: f64,
    /// How far below the best score.
    pub below_best: f64,
    /// Distance at which a return still lies on a side of the map, metres.
    pub gate_m: f64,
    /// Share of the beams that must end on the map, of those that it says something of.
    pub least_fit: f64,
    /// Share of the beams that the map must say something of.
    pub least_known: f64,
    /// Least score of a pose that is believed.
    pub least_score: f64,
    /// Probability, among all poses found, with which the best must be the right one: 1 in 200 may be wrong.
    pub least_confidence: f64,
    /// Poses farther apart than this are different, metres.
    pub different_m: f64,
    /// Headings farther apart than this are different, radians.
    pub different_rad: f64,
}

impl Default for LocateSettings {
    fn default() -> Self {
        Self {
            candidates: 32,
            min_score: 0.3,
            below_best: 0.3,
            gate_m: 0.12,
            least_fit: 0.7,
            least_known: 0.6,
            least_score: 0.5,
            least_confidence: 0.995,
            different_m: 0.3,
            different_rad: 0.087,
        }
    }
}

/// A pose and what speaks for it.
#[derive(Clone, Copy, Debug)]
pub struct Fix {
    /// The scanner in the map.
    pub map_from_scan: Pose,
    /// Information of the walls, map axes, turn about the scanner.
    pub information: Information,
    /// Whether the walls leave the place open along some direction.
    pub is_open: bool,
    /// What becomes of the beams.
    pub agreement: Agreement,
    /// How much less likely the scan is from here than from a pose that explains every beam, nats; 0 is best.
    pub loss_nats: f64,
    /// [`Self::loss_nats`] as a share of what there was to lose, taken from 1: 1 is a perfect fit, 0 none.
    pub score: f64,
}

/// What is known of a scan's place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The first pose is the only one.
    Located,
    /// Another pose explains the scan as well, or the walls leave a direction open.
    Ambiguous,
    /// No pose explains the scan.
    NotFound,
}

/// The answer for a scan.
#[derive(Clone, Debug)]
pub struct Localisation {
    /// Whether the first pose is to be believed.
    pub verdict: Verdict,
    /// Probability that the first pose is the right one, given that the scan is of this map.
    pub confidence: f64,
    /// Different poses, best first.
    pub fixes: Vec<Fix>,
}

impl Localisation {
    fn nowhere() -> Self {
        Self {
            verdict: Verdict::NotFound,
            confidence: 0.0,
            fixes: Vec::new(),
        }
    }

    /// The best pose, if there is one.
    #[must_use]
    pub fn best(&self) -> Option<&Fix> {
        self.fixes.first()
    }
}

/// A map prepared for finding scans in it.
pub struct Locator {
    sides: SideGrid,
    field: Option<Field>,
    settings: LocateSettings,
    align: AlignSettings,
    noise: RunningNoise,
}

/// Returns on polylines that a pose needs.
const LEAST_POINTS: usize = 10;
/// Points that are searched with, at most; the sums of the search hold 257.
const MOST_SEARCHED: usize = 150;

impl Locator {
    /// Prepares `map`.
    #[must_use]
    pub fn new(map: &Map, settings: LocateSettings) -> Self {
        let mut sides = SideGrid::default();
        for (owner, polyline) in (0_u32..).zip(&map.polylines) {
            sides.insert(owner, polyline.vertices.iter().map(|v| v.point));
        }
        Self::of_sides(sides, settings)
    }

    /// Prepares a map of which the sides are known.
    pub(crate) fn of_sides(sides: SideGrid, settings: LocateSettings) -> Self {
        Self {
            field: Field::new(sides.sides().map(|s| s.segment)),
            sides,
            settings,
            align: AlignSettings::default(),
            noise: RunningNoise::default(),
        }
    }

    /// Finds a scan in the whole map. Scans shown before serve to know the scanner's noise, and for nothing else.
    pub fn find(&mut self, scan: &Scan) -> Localisation {
        let points = self.points_of(scan);
        self.find_points(&points)
    }

    fn points_of(&mut self, scan: &Scan) -> Vec<SidePoint> {
        self.noise.observe(scan);
        let settings = ExtractSettings {
            noise_m: self.noise.sigma_m(),
            ..ExtractSettings::default()
        };
        let extraction = extract(scan, &settings);
        side_points(scan, &extraction.polylines, extraction.noise_m)
    }

    /// [`Self::find`] for the returns of a scan on its polylines.
    pub(crate) fn find_points(&self, points: &[SidePoint]) -> Localisation {
        let Some(field) = self.field.as_ref().filter(|_| points.len() >= LEAST_POINTS) else {
            return Localisation::nowhere();
        };
        let searched = thinned(points);
        let step = searched.len().div_ceil(MOST_SEARCHED).max(1);
        let searched: Vec<_> = searched.into_iter().step_by(step).collect();
        let pieces = Pieces::of(points);
        let wanted = Wanted {
            poses: self.settings.candidates,
            min_score: self.settings.min_score,
            below_best: self.settings.below_best,
        };
        let found = search(field, &searched, &wanted);
        let fixes = found
            .iter()
            .filter_map(|c| {
                let guess = Guess {
                    map_from_scan: c.map_from_scan,
                    sigma_m: 0.07,
                    sigma_rad: 0.02,
                };
                self.fix(points, &pieces, &guess)
            })
            .collect();
        self.judged(fixes, &pieces)
    }

    /// The pose near `guess`, whether it fits or not; `sigma_m` is how far off the guess may be.
    pub(crate) fn fix_near(&self, points: &[SidePoint], guess: Pose, sigma_m: f64) -> Option<Fix> {
        let guess = Guess {
            map_from_scan: guess,
            sigma_m,
            sigma_rad: 0.05,
        };
        self.fix(points, &Pieces::of(points), &guess)
    }

    /// Aligns from `guess` and judges the result.
    fn fix(&self, points: &[SidePoint], pieces: &Pieces, guess: &Guess) -> Option<Fix> {
        let prior = guess.prior();
        let alignment = align_to_grid(points, &self.sides, |_, _| true, guess, Some(&prior), &self.align)?;
        Some(self.fix_at(points, pieces, &alignment))
    }

    fn fix_at(&self, points: &[SidePoint], pieces: &Pieces, alignment: &Alignment) -> Fix {
        let (loss_nats, agreement) =
            pieces.loss(points, &self.sides, alignment.map_from_scan, self.settings.gate_m);
        Fix {
            map_from_scan: alignment.map_from_scan,
            information: alignment.information,
            is_open: alignment.unobservable.is_some(),
            agreement,
            loss_nats,
            score: 1.0 - loss_nats / (likelihood::MOST_LOSS * pieces.worth),
        }
    }

    /// Puts the fixes in order, leaves out what is the same as a better one, and says how it stands.
    fn judged(&self, mut fixes: Vec<Fix>, pieces: &Pieces) -> Localisation {
        fixes.sort_by(|a, b| a.loss_nats.total_cmp(&b.loss_nats));
        let mut distinct: Vec<Fix> = Vec::new();
        for fix in fixes {
            if distinct.iter().all(|d| self.is_different(d, &fix)) {
                distinct.push(fix);
            }
        }
        let Some(best) = distinct.first() else {
            return Localisation::nowhere();
        };
        let confidence = pieces.confidence(distinct.iter().map(|f| f.loss_nats));
        let fits = best.score >= self.settings.least_score
            && best.agreement.fit() >= self.settings.least_fit
            && best.agreement.known_share() >= self.settings.least_known;
        let verdict = if !fits {
            Verdict::NotFound
        } else if best.is_open || confidence < self.settings.least_confidence {
            Verdict::Ambiguous
        } else {
            Verdict::Located
        };
        Localisation {
            verdict,
            confidence,
            fixes: distinct,
        }
    }

    fn is_different(&self, a: &Fix, b: &Fix) -> bool {
        let (a, b) = (a.map_from_scan, b.map_from_scan);
        !a.is_within(self.settings.different_m, self.settings.different_rad, b)
    }
}

#[cfg(test)]
mod tests;
