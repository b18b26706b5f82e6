//! A second look at steps from keyframe to keyframe.
//!
//! In: all keyframes, and which of them were placed when other places came near. Out: those whose step was another one, by what
//! was seen on both sides of it. When a scan is placed, that scan alone is matched with what was seen before. A row of
//! niches lets it slip by one of them; the scans that follow slip along, and no scan by itself lies wrong among its
//! neighbours. Afterwards the scans of the next metres tell, too, and those of the metres before are matched with them.

use super::elsewhere::{WINDOW_M, is_elsewhere};
use super::oddity::{ENOUGH_AFTER, oddity};
use super::recognise::{Place, View, stretch};
use crate::align::{AlignSettings, Alignment};
use crate::geometry::Pose;
use crate::keyframe::Keyframe;
use crate::place::judge::Agreement;

/// Way on either side of a step whose scans are compared, metres (a turn by 1 rad counts as one).
const STRETCH_M: f64 = 4.0;
/// How far turned a keyframe is looked for, radians.
const WINDOW_RAD: f64 = 0.3;
/// Share of the beams that must agree afterwards, of those that the other side says something of, as for ties.
const LEAST_FIT: f64 = 0.7;
/// By how much the scans fit better after it, [`Agreement::fit`]. It may be odder, metres, by no more than they fit better: most
/// poses that fit better by chance go back where the scanner came from, because there all is known.
const LEAST_GAIN: f64 = 0.05;
/// Or by how much it is more ordinary, metres, if they fit no worse; the share that must agree then, as for a scan where
/// it was expected.
const LESS_ODD_M: f64 = 0.25;
const LEAST_ORDINARY_FIT: f64 = 0.5;
/// Or how often the beams that are contradicted are halved, if few are after it; and once more for every so many metres that it
/// is odder. A step that was three times as long as others leads where less is known, and a score that counts what is known
/// prefers the shorter one. (Steps and candidates of 27 keyframe logs: right ones that go farther halve them 1.6 and 3.9
/// times, wrong ones at most 0.96 times, and those 1.9 m odder.)
const LEAST_HALVED: f64 = 1.0;
const ODDER_PER_HALVED_M: f64 = 2.0;
/// Share of the beams that must agree for few to be contradicted, and the share of contradicted ones that is always there.
const FEW_FIT: f64 = 0.9;
const ALWAYS_CONTRADICTED: f64 = 0.01;

/// A step that was another one.
pub(crate) struct StepAgain {
    /// The keyframe after it.
    pub to: usize,
    /// That keyframe, aligned with those of the metres after it to what those of the metres before saw.
    pub alignment: Alignment,
}

/// The steps to keyframes of `doubtful` that were others.
pub(crate) fn steps_again(
    keyframes: &[Keyframe],
    doubtful: &[usize],
    align: &AlignSettings,
) -> Vec<StepAgain> {
    let step_again = |&to: &usize| {
        let alignment = Seam::at(keyframes, to)?.other_step(align)?;
        Some(StepAgain { to, alignment })
    };
    doubtful.iter().filter_map(step_again).collect()
}

/// Whether enough has followed keyframe `to` to judge the step to it: scans that tell, and steps that show what is ordinary.
pub(crate) fn is_to_judge(keyframes: &[Keyframe], to: usize) -> bool {
    let newest = keyframes.len() - 1;
    keyframes[newest].way_m - keyframes[to].way_m >= STRETCH_M && newest - to >= ENOUGH_AFTER
}

/// What was seen before and after a step.
struct Seam<'a> {
    keyframes: &'a [Keyframe],
    /// The keyframe after the step, and where it lies.
    to: usize,
    here: Pose,
    before: Side<'a>,
    after: Side<'a>,
}

struct Side<'a> {
    place: Place,
    views: Vec<View<'a>>,
}

impl<'a> Side<'a> {
    fn of(keyframes: &'a [Keyframe], stretch: &[usize], here: Pose) -> Self {
        let members = || stretch.iter().map(|&k| &keyframes[k]);
        Self {
            place: Place::of(members()),
            views: members().map(|k| View::new(k, here)).collect(),
        }
    }
}

/// How the scans agree after a step.
struct Judged {
    agreement: Agreement,
    oddity_m: f64,
}

impl<'a> Seam<'a> {
    /// The step to keyframe `to`; `None` for the first.
    fn at(keyframes: &'a [Keyframe], to: usize) -> Option<Self> {
        let from = to.checked_sub(1)?;
        let here = keyframes[to].map_from_scan;
        let before = stretch(keyframes, from, STRETCH_M, |k| k <= from);
        let after = stretch(keyframes, to, STRETCH_M, |k| k >= to);
        Some(Self {
            keyframes,
            to,
            here,
            before: Side::of(keyframes, &before, here),
            after: Side::of(keyframes, &after, here),
        })
    }

    /// How the scans of either side agree with what the other saw if the step led to `pose`.
    fn judged(&self, pose: Pose) -> Judged {
        let back = self.here * pose.inverse() * self.here;
        let onward = self.before.place.agreement(&self.after.views, pose);
        let step = self.keyframes[self.to - 1].map_from_scan.inverse() * pose;
        Judged {
            agreement: onward.plus(self.after.place.agreement(&self.before.views, back)),
            oddity_m: oddity(self.keyframes, self.to, step),
        }
    }

    /// Where the step led if not where it was believed to lead.
    fn other_step(&self, align: &AlignSettings) -> Option<Alignment> {
        let now = self.judged(self.here);
        if now.agreement.fit() > 1.0 - LEAST_GAIN {
            return None;
        }
        let found = self
            .before
            .place
            .alignments(&self.after.views, self.here, (WINDOW_M, WINDOW_RAD), align);
        let (mut others, near): (Vec<Alignment>, Vec<Alignment>) = found
            .into_iter()
            .partition(|a| is_elsewhere(a.map_from_scan, self.here));
        // Along a corridor that tells nothing of the way, any step fits.
        others.retain(|a| a.unobservable.is_none());
        // Where it was believed to lead, a better alignment counts for that.
        let now = near
            .iter()
            .map(|a| self.judged(a.map_from_scan))
            .fold(now, |best, j| if j.score() > best.score() { j } else { best });
        others
            .into_iter()
            .map(|a| (self.judged(a.map_from_scan), a))
            .filter(|(judged, _)| judged.outdoes(&now))
            .max_by(|a, b| a.0.score().total_cmp(&b.0.score()))
            .map(|best| best.1)
    }
}

impl Judged {
    fn score(&self) -> f64 {
        self.agreement.score()
    }

    fn outdoes(&self, now: &Self) -> bool {
        let better = self.agreement.fit() - now.agreement.fit();
        let odder_m = self.oddity_m - now.oddity_m;
        let fit = self.agreement.fit();
        let fits_better = fit >= LEAST_FIT && better >= LEAST_GAIN && odder_m <= better;
        let is_more_ordinary = fit >= LEAST_ORDINARY_FIT && better >= 0.0 && odder_m <= -LESS_ODD_M;
        let halved = (now.contradicted_share() / self.contradicted_share()).log2();
        let is_hardly_contradicted = fit >= FEW_FIT
            && odder_m.is_finite()
            && halved >= LEAST_HALVED + odder_m.max(0.0) / ODDER_PER_HALVED_M;
        (self.score() >= now.score() && (fits_better || is_more_ordinary)) || is_hardly_contradicted
    }

    /// Of the beams that the other side says something of, the share that it contradicts.
    fn contradicted_share(&self) -> f64 {
        (1.0 - self.agreement.fit()).max(ALWAYS_CONTRADICTED)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keyframe::drawn::{HALL, keyframe};

    /// A walk through the hall; from its seventh scan on all are believed to be 1.2 m farther than they are.
    fn walk_that_slipped() -> Vec<Keyframe> {
        (0..15)
            .map(|k| {
                let truth = Pose::new(f64::from(k) - 7.0, 0.2, 0.0);
                let slipped_m = if k >= 6 { 1.2 } else { 0.0 };
                Keyframe {
                    map_from_scan: Pose::new(truth.x + slipped_m, truth.y, 0.0),
                    ..keyframe(HALL, truth)
                }
            })
            .collect()
    }

    #[test]
    fn a_step_after_which_all_scans_lie_wrong_is_made_again() {
        let keyframes = walk_that_slipped();
        let all: Vec<usize> = (0..keyframes.len()).collect();
        let again = steps_again(&keyframes, &all, &AlignSettings::default());
        assert_eq!(again.iter().map(|s| s.to).collect::<Vec<_>>(), [6]);
        let off_m = again[0]
            .alignment
            .map_from_scan
            .distance(Pose::new(-1.0, 0.2, 0.0));
        assert!(off_m < 0.03, "{off_m}");
    }

    #[test]
    fn a_step_that_was_three_times_as_long_is_found() {
        // Ordinary steps are 1 m, this one was 3 m; believed 1 m long, too, all scans after it lie 2 m back.
        let keyframes: Vec<Keyframe> = (0..15)
            .map(|k| {
                let x_m = f64::from(k) - 8.0;
                let truth = Pose::new(if k >= 7 { x_m + 2.0 } else { x_m }, 0.2, 0.0);
                Keyframe {
                    map_from_scan: Pose::new(x_m, 0.2, 0.0),
                    ..keyframe(HALL, truth)
                }
            })
            .collect();
        let again = steps_again(&keyframes, &[7], &AlignSettings::default());
        assert_eq!(again.len(), 1);
        let off_m = again[0]
            .alignment
            .map_from_scan
            .distance(Pose::new(1.0, 0.2, 0.0));
        assert!(off_m < 0.03, "{off_m}");
    }

    #[test]
    fn a_step_that_was_clear_stays_as_it_was() {
        let keyframes = walk_that_slipped();
        let others: Vec<usize> = (0..keyframes.len()).filter(|&k| k != 6).collect();
        assert!(steps_again(&keyframes, &others, &AlignSettings::default()).is_empty());
    }

    #[test]
    fn in_a_corridor_that_tells_nothing_of_the_way_a_step_stays_as_it_was() {
        let walls: &[crate::keyframe::drawn::Wall] =
            &[&[(-60.0, -1.0), (60.0, -1.0)], &[(60.0, 1.0), (-60.0, 1.0)]];
        let keyframes: Vec<Keyframe> = (0..15)
            .map(|k| {
                let x_m = f64::from(k) + if k >= 6 { 0.6 } else { 0.0 };
                keyframe(walls, Pose::new(x_m, 0.0, 0.0))
            })
            .collect();
        let all: Vec<usize> = (0..keyframes.len()).collect();
        assert!(steps_again(&keyframes, &all, &AlignSettings::default()).is_empty());
    }
}
