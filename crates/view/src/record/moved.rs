//! Poses that have changed after the fact: a closed loop moves hundreds of scans, most of them together.
//!
//! In: the poses as they were told, and as they are. Out: runs of scans that one motion of the map frame takes to where
//! they are, to within 2 mm and 0.5 mrad. What was told is kept as its reader has it, so that errors do not add up.

use polymapper_core::geometry::{Pose, wrap_rad};
use polymapper_core::mapper::Outcome;
use serde::{Deserialize, Serialize};

use super::{PoseRecord, pose_record, rounded};

/// How far off a pose may be shown.
const NEAR_M: f64 = 0.002;
const NEAR_RAD: f64 = 0.0005;

/// Which poses have changed, and how.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Moved {
    /// Scans that move together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<Run>,
    /// Scans that have a place now and had none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub found: Vec<(usize, PoseRecord)>,
    /// Scans that have lost theirs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lost: Vec<usize>,
}

/// Scans that move together.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Number of the first.
    pub first: usize,
    /// Number of the last.
    pub last: usize,
    /// Motion of the map frame: the new pose is this times the old one.
    pub by: PoseRecord,
}

/// The poses as a reader of the record has them.
#[derive(Debug, Default)]
pub struct ShownPoses(Vec<Option<Pose>>);

impl ShownPoses {
    /// Takes note of the next scan.
    pub fn push(&mut self, pose: Option<PoseRecord>) {
        self.0
            .push(pose.map(|[x, y, theta_rad]| Pose::new(x, y, theta_rad)));
    }

    /// Number and pose of the last scan that has a place.
    #[must_use]
    pub fn last_placed(&self) -> Option<(usize, Pose)> {
        let n = self.0.iter().rposition(Option::is_some)?;
        Some((n, self.0[n]?))
    }

    /// What has to be told so that `outcomes` are known; `None` if they are.
    pub fn change_to(&mut self, outcomes: &[Outcome]) -> Option<Moved> {
        let mut moved = Moved::default();
        let mut run: Option<Run> = None;
        for (n, (shown, outcome)) in self.0.iter_mut().zip(outcomes).enumerate() {
            let now = match *outcome {
                Outcome::Placed { map_from_scan } => Some(map_from_scan),
                Outcome::NotPlaced { .. } => None,
            };
            match (*shown, now) {
                (Some(was), Some(now)) => {
                    let goes_on = run.filter(|r| is_near(pose(r.by) * was, now));
                    if let Some(mut on) = goes_on {
                        on.last = n;
                        run = Some(on);
                    } else {
                        moved.runs.extend(run.take());
                        run = (!is_near(was, now)).then(|| Run {
                            first: n,
                            last: n,
                            by: motion(was, now),
                        });
                    }
                    if let Some(run) = &run {
                        *shown = Some(pose(run.by) * was);
                    }
                }
                (None, Some(now)) => {
                    moved.found.push((n, pose_record(now)));
                    *shown = Some(pose(pose_record(now)));
                }
                (Some(_), None) => {
                    moved.lost.push(n);
                    *shown = None;
                }
                (None, None) => {}
            }
        }
        moved.runs.extend(run);
        (moved != Moved::default()).then_some(moved)
    }
}

/// The motion of the map frame between two poses, as it is written. With enough digits that it can be applied far
/// from the origin.
fn motion(was: Pose, now: Pose) -> PoseRecord {
    let by = now * was.inverse();
    [rounded(by.x, 1e5), rounded(by.y, 1e5), rounded(by.theta_rad, 1e7)]
}

fn pose([x, y, theta_rad]: PoseRecord) -> Pose {
    Pose::new(x, y, theta_rad)
}

fn is_near(a: Pose, b: Pose) -> bool {
    a.distance(b) < NEAR_M && wrap_rad(a.theta_rad - b.theta_rad).abs() < NEAR_RAD
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(map_from_scan: Pose) -> Outcome {
        Outcome::Placed { map_from_scan }
    }

    #[test]
    fn what_moves_together_is_one_run() {
        let mut shown = ShownPoses::default();
        let old: Vec<Pose> = (0..100)
            .map(|k| Pose::new(f64::from(k) * 0.1, 0.0, 0.01 * f64::from(k)))
            .collect();
        for pose in &old {
            shown.push(Some(pose_record(*pose)));
        }
        let by = Pose::new(0.3, -0.2, 0.05);
        let now: Vec<Outcome> = (0..100)
            .map(|k| placed(if k < 40 { old[k] } else { by * old[k] }))
            .collect();
        let moved = shown.change_to(&now).unwrap();
        assert_eq!(
            moved.runs.iter().map(|r| (r.first, r.last)).collect::<Vec<_>>(),
            [(40, 99)]
        );
        assert_eq!(shown.change_to(&now), None, "told once");
    }

    #[test]
    fn a_place_that_is_found_or_lost_later_is_told() {
        let mut shown = ShownPoses::default();
        shown.push(None);
        shown.push(Some([1.0, 2.0, 0.0]));
        let lost = Outcome::NotPlaced {
            reason: polymapper_core::mapper::NotPlaced::SeparateSubmap,
        };
        let moved = shown
            .change_to(&[placed(Pose::new(3.0, 0.0, 0.5)), lost])
            .unwrap();
        assert_eq!(moved.found, [(0, [3.0, 0.0, 0.5])]);
        assert_eq!(moved.lost, [1]);
        assert_eq!(shown.last_placed().map(|(n, _)| n), Some(0));
    }
}
