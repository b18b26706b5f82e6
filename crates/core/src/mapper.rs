//! The pipeline: scan → polylines → match → alignment → merge → map.

use crate::align::{AlignSettings, Alignment, Guess, Prior, SidePoint, align_to_grid};
use crate::extract::{ExtractSettings, Extraction, extract};
use crate::geometry::{Pose, wrap_rad};
use crate::judge::{Agreement, judge};
use crate::keyframe::Keyframe;
use crate::map::Map;
use crate::merge::growing_map::GrowingMap;
use crate::merge::{MergeReport, MergeSettings, merge};
use crate::scan::Scan;
use crate::side_points::side_points;

/// All settings of the mapper.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// Scan → polylines.
    pub extract: ExtractSettings,
    /// Alignment.
    pub align: AlignSettings,
    /// Merging.
    pub merge: MergeSettings,
}

/// Why a scan has no place in the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum NotPlaced {
    /// Fewer returns on polylines than an alignment needs.
    TooFewReturns,
    /// No pose lets the scan agree with the map.
    NoMatch,
}

/// What became of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// It has a pose in the map.
    Placed {
        /// The laser in the map frame.
        map_from_scan: Pose,
    },
    /// It has none.
    NotPlaced {
        /// Why.
        reason: NotPlaced,
    },
}

/// Everything that happened to one scan.
#[derive(Clone, Debug)]
pub struct Step {
    /// Number of the scan, from 0.
    pub scan: usize,
    /// What became of it.
    pub outcome: Outcome,
    /// Its polylines.
    pub extraction: Extraction,
    /// Its alignment to the map; `None` for the first scan and for those that could not be aligned.
    pub alignment: Option<Alignment>,
    /// How the whole scan agrees with the map.
    pub agreement: Option<Agreement>,
    /// What was merged, when it was.
    pub merged: Option<MergeReport>,
}

#[derive(Clone, Copy)]
struct Motion {
    map_from_scan: Pose,
    step: Pose,
}

/// Builds a map scan by scan.
pub struct Mapper {
    settings: Settings,
    map: GrowingMap,
    outcomes: Vec<Outcome>,
    motion: Option<Motion>,
    keyframes: Vec<Keyframe>,
}

struct Placement {
    alignment: Alignment,
    agreement: Agreement,
}

impl Mapper {
    /// An empty map.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            map: GrowingMap::default(),
            outcomes: Vec::new(),
            motion: None,
            keyframes: Vec::new(),
        }
    }

    /// Places the next scan and merges it.
    pub fn add_scan(&mut self, scan: &Scan) -> Step {
        let number = self.outcomes.len();
        let extraction = extract(scan, &self.settings.extract);
        let points = side_points(scan, &extraction.polylines, extraction.noise_m);
        let mut step = Step {
            scan: number,
            outcome: Outcome::NotPlaced { reason: NotPlaced::TooFewReturns },
            extraction,
            alignment: None,
            agreement: None,
            merged: None,
        };
        if points.len() >= 10 {
            self.place(&mut step, scan, &points);
        }
        self.outcomes.push(step.outcome);
        step
    }

    fn place(&mut self, step: &mut Step, scan: &Scan, points: &[SidePoint]) {
        let pose = match self.motion {
            None => Pose::IDENTITY,
            Some(motion) => {
                let Some(found) = self.find(points, motion) else {
                    step.outcome = Outcome::NotPlaced { reason: NotPlaced::NoMatch };
                    return;
                };
                step.alignment = Some(found.alignment);
                step.agreement = Some(found.agreement);
                found.alignment.map_from_scan
            }
        };
        step.outcome = Outcome::Placed { map_from_scan: pose };
        let last = self.motion.map_or(pose, |m| m.map_from_scan);
        self.motion = Some(Motion { map_from_scan: pose, step: last.inverse() * pose });
        if self.is_keyframe(pose, step) {
            let keyframe = Keyframe {
                number: step.scan,
                scan: scan.clone(),
                polylines: step.extraction.polylines.clone(),
                map_from_scan: pose,
            };
            let merged = merge(&mut self.map, &keyframe, self.keyframes.len() as u32, &self.settings.merge);
            step.merged = Some(merged);
            self.keyframes.push(keyframe);
        }
    }

    fn is_keyframe(&self, pose: Pose, step: &Step) -> bool {
        let Some(keyframe) = self.keyframes.last() else { return true };
        let last = keyframe.map_from_scan;
        let new_share = step.agreement.map_or(1.0, |a| 1.0 - a.known_share());
        last.distance(pose) > 0.25
            || wrap_rad(last.theta_rad - pose.theta_rad).abs() > 0.17
            || new_share > 0.2
            || step.scan - keyframe.number >= 10
    }

    fn find(&self, points: &[SidePoint], motion: Motion) -> Option<Placement> {
        let predicted = Guess {
            map_from_scan: motion.map_from_scan * motion.step,
            sigma_m: 0.02 + 0.3 * motion.step.translation().norm(),
            sigma_rad: 0.02 + 0.3 * motion.step.theta_rad.abs(),
        };
        let good = |p: &Placement| p.agreement.fit() > 0.75 && p.alignment.matched_share() > 0.5;
        let first = self.try_pose(points, &predicted, Some(&predicted.prior()));
        if first.as_ref().is_some_and(good) {
            return first;
        }
        let mut best = first;
        for k in -18..=18 {
            let turned = motion.map_from_scan * Pose::new(0.0, 0.0, f64::from(k) * 0.0873);
            let guess = Guess { map_from_scan: turned, sigma_m: 0.15, sigma_rad: 0.05 };
            let other = self.try_pose(points, &guess, None);
            if let Some(o) = other
                && best.as_ref().is_none_or(|b| o.agreement.score() > b.agreement.score())
            {
                best = Some(o);
            }
        }
        best.filter(|p| p.agreement.fit() > 0.5)
    }

    fn try_pose(&self, points: &[SidePoint], guess: &Guess, prior: Option<&Prior>) -> Option<Placement> {
        let alignment =
            align_to_grid(points, &self.map.skeleton, |_, _| true, guess, prior, &self.settings.align)?;
        let agreement = judge(points, &self.map.skeleton, alignment.map_from_scan, 0.10);
        Some(Placement { alignment, agreement })
    }

    /// What became of every scan so far.
    #[must_use]
    pub fn outcomes(&self) -> &[Outcome] {
        &self.outcomes
    }

    /// The map as it stands.
    #[must_use]
    pub fn map(&self) -> Map {
        crate::finish::finish(&self.map, &self.keyframes, &self.settings.merge)
    }
}
