//! Where a scan is in the map: prediction when that settles it, matching by shape and search when it does not.
//!
//! In: a scan's polylines and returns, the map around, the motion so far. Out: the pose that agrees best with the whole
//! scan, or none.
//!
//! 1. The predicted pose is aligned. Full-rate scans move a few centimetres, and this settles nearly all of them.
//! 2. When the scan disagrees with it (a standstill after motion, somebody walking along), standing still, a wider
//!    guess, and steps made before are tried.
//!    Where the walls have not told the heading for some time (a round room), a beam or two that the map contradicts is
//!    disagreement enough, and all headings are searched: only what comes into sight now can tell it.
//! 3. The paper's way (sections 2 and 3.3): the polylines are matched by shape with the virtual scan, and every pose that
//!    the correspondences induce is aligned.
//! 4. If none of these stands out, all poses in a window around are searched (`search`).
//!
//! Every pose is judged by what the whole scan says of the map, fit and two-way visibility (`judge`), and by what
//! the motion so far makes likely. The best is taken if it is good enough; otherwise the scan has no place.

pub(crate) mod judge;
mod motion;
mod origin;
pub(crate) mod search;
mod stage;
mod virtual_scan;

use crate::align::{AlignSettings, Alignment, Guess, SidePoint};
use crate::extract::ScanPolyline;
use crate::geometry::{Point, Polyline};
use crate::matching::{Matching, match_polylines};
use crate::merge::growing_map::GrowingMap;
pub use judge::Agreement;
pub(crate) use motion::Motion;
pub use origin::Origin;
use stage::Stage;
use virtual_scan::virtual_scan;

/// A pose and what speaks for it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    /// Which guess led to it.
    pub origin: Origin,
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
    /// The same where the walls have not told the heading for some time: a beam or two that the map contradicts may tell it.
    pub open_fit: f64,
    /// Meanwhile contradicted scans are not merged, unless the map says something of no more than this share of the beams: a
    /// scanner that drives on must map what it comes to.
    pub open_known: f64,
    /// A pose near the predicted one with a smaller share of agreeing beams is not believed,
    pub least_fit: f64,
    /// nor one from which the map says something of fewer beams.
    pub least_known: f64,
    /// The same for a pose elsewhere,
    pub far_fit: f64,
    /// see `least_known`.
    pub far_known: f64,
    /// By how much a pose in a map that was left must lead the next best one there.
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
            open_fit: 0.99,
            open_known: 0.9,
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
    let mut stage = Stage::new(points, &map.skeleton, motion, align, settings);
    if let Some(p) = stage.predicted() {
        if stage.is_unsurprising(&p) {
            return Answer::settled(p);
        }
        stage.take(p);
    }
    // Nothing but the heading is in doubt, and the walls have not told it for some time: what they tell now, by contradicting
    // the map, is looked for all round. Nothing is merged meanwhile, so that the next scan tells more.
    if motion.open_sigmas().is_some() && stage.best().is_some_and(|p| stage.is_good(&p)) {
        stage.search();
        let placement = stage.best();
        return Answer {
            placement,
            believed: placement.into_iter().collect(),
            hypotheses: stage.into_found(),
            ..Answer::default()
        };
    }
    stage.try_guess(Origin::Standing, &motion.standing());
    let wide = Guess {
        sigma_m: 0.2,
        sigma_rad: 0.1,
        ..motion.predicted()
    };
    stage.try_guess(Origin::Wide, &wide);
    for guess in motion.as_before(6) {
        stage.try_guess(Origin::AsBefore, &guess);
    }
    if let Some(p) = stage.best()
        && stage.is_good(&p)
        && motion.is_smooth()
    {
        return Answer {
            hypotheses: stage.into_found(),
            ..Answer::settled(p)
        };
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
        hypotheses: stage.into_found(),
    }
}

/// The paper's way (section 3.3): the scan's polylines are matched by shape with the virtual scan, and every alignment
/// that the correspondences induce is a candidate.
fn match_by_shape(polylines: &[ScanPolyline], reference: &[Polyline], stage: &mut Stage) -> Matching {
    let map_from_last = stage.motion().map_from_scan;
    let scan: Vec<Polyline> = polylines.iter().map(|p| p.polyline.clone()).collect();
    let matching = match_polylines(&scan, reference, &stage.estimate());
    for h in &matching.hypotheses {
        let guess = Guess {
            map_from_scan: map_from_last * h.reference_from_scan,
            sigma_m: 0.1,
            sigma_rad: 0.03,
        };
        stage.try_guess(Origin::Shape, &guess);
    }
    matching
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
