use std::fmt;
use std::sync::Arc;

use super::track::Way;
use crate::align::{AlignSettings, Alignment, Covariance};
use crate::extract::Extraction;
use crate::geometry::{Polyline, Pose};
use crate::matching::Matching;
use crate::merge::MergeReport;
use crate::place::judge::Agreement;
use crate::place::{Answer, Origin};

/// Why a scan has no place in the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum NotPlaced {
    /// Fewer returns on polylines than an alignment needs.
    TooFewReturns,
    /// No pose lets the scan agree with the map: it is part of a map of its own, which has not been recognised in the main one yet.
    SeparateSubmap,
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

/// The stages of the pipeline, in order, for whoever wants to take their time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Scan → polylines.
    Extract,
    /// Virtual scan, match and alignment.
    Place,
    /// Moving objects and merging.
    Merge,
    /// Places seen before, the pose graph, the map around made anew.
    Loops,
    /// The map of all keyframes and its final pass.
    Finish,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Self; 5] = [Self::Extract, Self::Place, Self::Merge, Self::Loops, Self::Finish];

    /// The stage's name: `extract`, `place`, `merge`, `loops`, `finish`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Extract => "extract",
            Self::Place => "place",
            Self::Merge => "merge",
            Self::Loops => "loops",
            Self::Finish => "finish",
        }
    }
}

/// A pose that a scan might have.
#[derive(Clone, Copy, Debug)]
pub struct Hypothesis {
    /// Where it came from.
    pub origin: Origin,
    /// The laser in the map frame.
    pub map_from_scan: Pose,
    /// How the whole scan agrees with the map from there.
    pub agreement: Agreement,
    /// The agreement's score less what the motion so far makes unlikely: hypotheses are ranked by it.
    pub merit: f64,
}

/// A place that was recognised, and no longer counts: what was measured since, or before, contradicts it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Revoked {
    /// Number of the scan that was recognised to be at an old place.
    pub scan: usize,
    /// Number of the old scan.
    pub recognised: usize,
    /// How far the scan lies from where the place would have it, metres.
    pub off_m: f64,
    /// The same in standard deviations of what the walls said, heading included.
    pub sigmas: f64,
}

impl fmt::Display for Revoked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            scan,
            recognised,
            off_m,
            sigmas,
        } = self;
        write!(
            f,
            "scan {scan} is not at the place of scan {recognised}: by all others it is {off_m:.2} m away, {sigmas:.0} standard deviations"
        )
    }
}

/// Everything that happened to one scan.
#[derive(Clone, Debug)]
pub struct Step {
    /// Number of the scan, from 0.
    pub scan: usize,
    /// What became of it.
    pub outcome: Outcome,
    /// Its polylines, laser frame.
    pub extraction: Arc<Extraction>,
    /// The virtual scan, frame of the last placed scan, when the predicted pose did not settle the place.
    pub virtual_scan: Option<Vec<Polyline>>,
    /// The matching by shape of the polylines with the virtual scan.
    pub matching: Option<Matching>,
    /// Every pose that was looked at, best first.
    pub hypotheses: Vec<Hypothesis>,
    /// Accounts of the motion that are carried on after this scan; 1 when it is clear where the scanner is.
    pub tracks: usize,
    /// Where the pose came from; `None` for a scan that could not be aligned.
    pub won: Option<Origin>,
    /// By how much the pose leads the best other one, when others were found.
    pub lead: Option<f64>,
    /// Its alignment to the map; `None` for the first scan and for those that could not be aligned.
    pub alignment: Option<Alignment>,
    /// In how many directions of x, y and the heading the walls alone tell the pose, 0 to 3: to within
    /// [`AlignSettings::observable_sigma_m`] and [`AlignSettings::observable_sigma_rad`]. `None` where there is no alignment.
    pub rank: Option<u8>,
    /// How far off the pose may be in the map around it, by walls and motion together; axes of the map as in `alignment`, about the
    /// scanner. Along a corridor it grows from scan to scan until something tells the place. It is 0 for the first scan, with which the
    /// map begins, and does not say how far off the map around may be; `None` for a scan without a place, or that begins a map of its own.
    pub covariance: Option<Covariance>,
    /// How the whole scan agrees with the map.
    pub agreement: Option<Agreement>,
    /// What was merged; `None` when the scan shows nothing new.
    pub merged: Option<MergeReport>,
    /// Numbers of its polylines that belong to moving objects.
    pub moving: Vec<usize>,
    /// Number of the old scan at whose place this one was recognised to be.
    pub recognised: Option<usize>,
    /// Places recognised before that do not count any more, and why.
    pub revoked: Vec<Revoked>,
    /// Numbers of earlier scans that were placed again, with all that follow: by what has been seen since, the step to
    /// them was another one.
    pub made_again: Vec<usize>,
}

impl Step {
    /// A scan that has no place so far.
    pub(super) fn new(scan: usize, extraction: Arc<Extraction>, reason: NotPlaced) -> Self {
        Self {
            scan,
            outcome: Outcome::NotPlaced { reason },
            extraction,
            virtual_scan: None,
            matching: None,
            hypotheses: Vec::new(),
            tracks: 1,
            won: None,
            lead: None,
            alignment: None,
            rank: None,
            covariance: None,
            agreement: None,
            merged: None,
            moving: Vec::new(),
            recognised: None,
            revoked: Vec::new(),
            made_again: Vec::new(),
        }
    }

    /// Takes note of how the scan was placed.
    pub(super) fn tell(&mut self, answer: &Answer, way: &Way, settings: &AlignSettings) {
        let (origin, placement) = match way {
            Way::On(None) => (Origin::First, None),
            Way::On(Some(placement)) => (placement.origin, Some(*placement)),
            Way::Back(_, placement) => (Origin::Back, Some(*placement)),
            Way::Apart => (Origin::Apart, None),
        };
        self.virtual_scan.clone_from(&answer.virtual_scan);
        self.matching.clone_from(&answer.matching);
        self.hypotheses = answer
            .hypotheses
            .iter()
            .map(|p| Hypothesis {
                origin: p.origin,
                map_from_scan: p.alignment.map_from_scan,
                agreement: p.agreement,
                merit: p.merit,
            })
            .collect();
        self.won = Some(origin);
        self.lead = answer.placement.and_then(|p| p.lead);
        self.alignment = placement.map(|p| p.alignment);
        let (sigma_m, sigma_rad) = (settings.observable_sigma_m, settings.observable_sigma_rad);
        self.rank = placement.map(|p| p.alignment.information.rank(sigma_m, sigma_rad));
        self.agreement = placement.map(|p| p.agreement);
    }
}
