//! The pipeline: scan → polylines → match → alignment → merge → map.

use crate::align::{AlignSettings, Alignment, Information, SidePoint};
use crate::eraser::{EraserSettings, boxes, disordered_runs};
use crate::extract::{ExtractSettings, Extraction, RunningNoise, extract};
use crate::finish::finish;
use crate::geometry::{Pose, wrap_rad};
use crate::graph::{Edge, optimise};
use crate::judge::Agreement;
use crate::keyframe::{Keyframe, ways_m};
use crate::map::{EraserBox, Map};
use crate::matching::Matching;
use crate::merge::growing_map::GrowingMap;
use crate::merge::{MergeReport, MergeSettings, merge};
use crate::moving::{MovingSettings, find_moving};
use crate::placement::{Motion, PlaceSettings, Placement, Question, place};
use crate::recognise::{RecogniseSettings, recognise};
use crate::scan::Scan;
use crate::side_points::side_points;

/// All settings of the mapper.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// Scan → polylines.
    pub extract: ExtractSettings,
    /// Alignment.
    pub align: AlignSettings,
    /// Finding the pose.
    pub place: PlaceSettings,
    /// Finding what has no stable shape.
    pub eraser: EraserSettings,
    /// Finding moving objects.
    pub moving: MovingSettings,
    /// Merging.
    pub merge: MergeSettings,
    /// Closing loops.
    pub recognise: RecogniseSettings,
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
    /// The matching by shape with the virtual scan, when the predicted pose did not settle it.
    pub matching: Option<Matching>,
    /// By how much the pose leads the best other one, when others were found.
    pub lead: Option<f64>,
    /// Its alignment to the map; `None` for the first scan and for those that could not be aligned.
    pub alignment: Option<Alignment>,
    /// How the whole scan agrees with the map.
    pub agreement: Option<Agreement>,
    /// What was merged, when it was.
    pub merged: Option<MergeReport>,
    /// Numbers of its polylines that belong to moving objects.
    pub moving: Vec<usize>,
    /// The scan of the old keyframe at which the place was recognised.
    pub recognised: Option<usize>,
}

/// A placed scan, held by its keyframe: it moves with it when loops are closed.
#[derive(Clone, Copy)]
enum Held {
    By {
        keyframe: usize,
        keyframe_from_scan: Pose,
    },
    Nowhere(NotPlaced),
}

/// Builds a map scan by scan.
pub struct Mapper {
    settings: Settings,
    /// The part of the map around that agrees with itself.
    local: GrowingMap,
    /// Where nothing is merged, as known when the local map was last made anew.
    boxes: Vec<EraserBox>,
    /// Way since the local map was last made anew, metres.
    local_way_m: f64,
    merges: u32,
    /// Polylines of the local map that the last keyframe was merged into.
    merged_into: Vec<u32>,
    noise: RunningNoise,
    scans: Vec<Held>,
    motion: Option<Motion>,
    keyframes: Vec<Keyframe>,
    edges: Vec<Edge>,
    /// Way since the last look for a known place, metres.
    unlooked_m: f64,
}

/// Returns on polylines that an alignment needs.
const LEAST_POINTS: usize = 10;

/// Keyframes within this way along the graph make up the local map, metres.
const LOCAL_M: f64 = 12.0;

impl Mapper {
    /// An empty map.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            local: GrowingMap::default(),
            boxes: Vec::new(),
            local_way_m: 0.0,
            merges: 0,
            merged_into: Vec::new(),
            noise: RunningNoise::default(),
            scans: Vec::new(),
            motion: None,
            keyframes: Vec::new(),
            edges: Vec::new(),
            unlooked_m: 0.0,
        }
    }

    /// Places the next scan and merges it.
    pub fn add_scan(&mut self, scan: &Scan) -> Step {
        let number = self.scans.len();
        self.noise.observe(scan);
        let settings = ExtractSettings {
            noise_m: self.settings.extract.noise_m.or(self.noise.sigma_m()),
            ..self.settings.extract
        };
        let extraction = extract(scan, &settings);
        let points = side_points(scan, &extraction.polylines, extraction.noise_m);
        let mut step = Step {
            scan: number,
            outcome: Outcome::NotPlaced {
                reason: NotPlaced::TooFewReturns,
            },
            extraction,
            matching: None,
            lead: None,
            alignment: None,
            agreement: None,
            merged: None,
            moving: Vec::new(),
            recognised: None,
        };
        let held = if points.len() >= LEAST_POINTS {
            self.place(&mut step, scan, points)
        } else {
            None
        };
        let reason = match step.outcome {
            Outcome::NotPlaced { reason } => reason,
            Outcome::Placed { .. } => NotPlaced::NoMatch,
        };
        self.scans.push(held.unwrap_or(Held::Nowhere(reason)));
        if held.is_none()
            && let Some(motion) = &mut self.motion
        {
            motion.lost_scans += 1;
        }
        step
    }

    fn place(&mut self, step: &mut Step, scan: &Scan, points: Vec<SidePoint>) -> Option<Held> {
        let mut pose = Pose::IDENTITY;
        if let Some(motion) = self.motion {
            let question = Question {
                points: &points,
                polylines: &step.extraction.polylines,
                map: &self.local,
                merged_into: &self.merged_into,
                motion: &motion,
            };
            let answer = place(question, &self.settings.align, &self.settings.place);
            step.matching = answer.matching;
            let Some(Placement {
                alignment,
                agreement,
                lead,
                ..
            }) = answer.placement
            else {
                step.outcome = Outcome::NotPlaced {
                    reason: NotPlaced::NoMatch,
                };
                return None;
            };
            step.lead = lead;
            step.alignment = Some(alignment);
            step.agreement = Some(agreement);
            pose = alignment.map_from_scan;
        }
        let last = self.motion.map_or(pose, |m| m.map_from_scan);
        let gap = self.motion.map_or(0, |m| m.lost_scans);
        let moved = if gap == 0 {
            last.inverse() * pose
        } else {
            Pose::IDENTITY
        };
        self.motion = Some(Motion {
            map_from_scan: pose,
            step: moved,
            lost_scans: 0,
        });
        if self.is_keyframe(pose, step) {
            self.add_keyframe(step, scan, points, pose);
            pose = self.motion.map_or(pose, |m| m.map_from_scan);
        }
        step.outcome = Outcome::Placed { map_from_scan: pose };
        let keyframe = self.keyframes.len() - 1;
        let keyframe_from_scan = self.keyframes[keyframe].map_from_scan.inverse() * pose;
        Some(Held::By {
            keyframe,
            keyframe_from_scan,
        })
    }

    fn is_keyframe(&self, pose: Pose, step: &Step) -> bool {
        let Some(keyframe) = self.keyframes.last() else {
            return true;
        };
        let last = keyframe.map_from_scan;
        let new_share = step.agreement.map_or(1.0, |a| 1.0 - a.known_share());
        last.distance(pose) > 0.25
            || wrap_rad(last.theta_rad - pose.theta_rad).abs() > 0.17
            || new_share > 0.2
            || step.scan - keyframe.number >= 10
    }

    fn add_keyframe(&mut self, step: &mut Step, scan: &Scan, points: Vec<SidePoint>, pose: Pose) {
        let keyframe = Keyframe {
            number: step.scan,
            scan: scan.clone(),
            is_moving: vec![false; step.extraction.polylines.len()],
            polylines: step.extraction.polylines.clone(),
            points,
            disordered_runs: disordered_runs(scan, step.extraction.noise_m, &self.settings.eraser),
            map_from_scan: pose,
        };
        if let Some(last) = self.keyframes.last() {
            let motion = last.map_from_scan.inverse() * pose;
            let information = step
                .alignment
                .map_or_else(Information::default, |a| edge_information(&a, last.map_from_scan));
            let from = self.keyframes.len() - 1;
            self.edges.push(Edge {
                from,
                to: from + 1,
                motion,
                information,
                is_loop: false,
            });
            self.local_way_m += motion.translation().norm();
            self.unlooked_m += motion.translation().norm();
        }
        self.keyframes.push(keyframe);
        let mut moved = self.take_moving_out(step);
        let report = self.merge_newest();
        self.merged_into.clone_from(&report.into);
        step.merged = Some(report);
        if self.unlooked_m > 1.0 {
            moved |= self.look_for_known_place(step);
        }
        if moved || self.local_way_m > 6.0 {
            self.renew_local_map();
        }
    }

    /// Returns whether something had been merged that is now known to move.
    fn take_moving_out(&mut self, step: &mut Step) -> bool {
        let newest = self.keyframes.len() - 1;
        let found = find_moving(&self.keyframes, &self.local, &self.settings.moving);
        for &(keyframe, polyline) in &found {
            self.keyframes[keyframe].is_moving[polyline] = true;
        }
        step.moving = found.iter().filter(|f| f.0 == newest).map(|f| f.1).collect();
        found.iter().any(|f| f.0 < newest)
    }

    fn merge_newest(&mut self) -> MergeReport {
        self.merges += 1;
        let newest = self.keyframes.len() - 1;
        merge(
            &mut self.local,
            &self.keyframes[newest],
            &self.boxes,
            self.merges,
            &self.settings.merge,
        )
    }

    /// Returns whether a place was recognised.
    fn look_for_known_place(&mut self, step: &mut Step) -> bool {
        let newest = self.keyframes.len() - 1;
        let ways = ways_m(self.keyframes.len(), &self.edges, newest, f64::INFINITY);
        self.unlooked_m = 0.0;
        let found = recognise(
            &self.keyframes,
            &ways,
            2.0 * LOCAL_M,
            &self.settings.align,
            &self.settings.recognise,
        );
        let Some(mut edge) = found else { return false };
        edge.information = loosened(&edge.information);
        step.recognised = Some(self.keyframes[edge.from].number);
        self.edges.push(edge);
        self.optimise();
        true
    }

    fn optimise(&mut self) {
        let mut poses: Vec<Pose> = self.keyframes.iter().map(|k| k.map_from_scan).collect();
        let last = poses[poses.len() - 1];
        optimise(&mut poses, &self.edges);
        for (keyframe, pose) in self.keyframes.iter_mut().zip(&poses) {
            keyframe.map_from_scan = *pose;
        }
        if let Some(motion) = &mut self.motion {
            motion.map_from_scan = poses[poses.len() - 1] * last.inverse() * motion.map_from_scan;
        }
    }

    fn renew_local_map(&mut self) {
        let newest = self.keyframes.len() - 1;
        let ways = ways_m(self.keyframes.len(), &self.edges, newest, LOCAL_M);
        self.boxes = boxes(&self.keyframes, &self.settings.eraser);
        self.local = GrowingMap::default();
        self.merged_into.clear();
        self.local_way_m = 0.0;
        for (k, way) in ways.iter().enumerate() {
            if way.is_some() {
                self.merges += 1;
                merge(
                    &mut self.local,
                    &self.keyframes[k],
                    &self.boxes,
                    self.merges,
                    &self.settings.merge,
                );
            }
        }
    }

    /// What became of every scan so far, in the map frame as it is now.
    #[must_use]
    pub fn outcomes(&self) -> Vec<Outcome> {
        self.scans
            .iter()
            .map(|held| match *held {
                Held::By {
                    keyframe,
                    keyframe_from_scan,
                } => Outcome::Placed {
                    map_from_scan: self.keyframes[keyframe].map_from_scan * keyframe_from_scan,
                },
                Held::Nowhere(reason) => Outcome::NotPlaced { reason },
            })
            .collect()
    }

    /// The map of all scans so far.
    #[must_use]
    pub fn map(&self) -> Map {
        let boxes = boxes(&self.keyframes, &self.settings.eraser);
        finish(&self.keyframes, boxes, &self.settings.merge)
    }
}

/// The information of an alignment, as that of an edge from the keyframe at `map_from_from`.
fn edge_information(alignment: &Alignment, map_from_from: Pose) -> Information {
    loosened(&alignment.information.turned(-map_from_from.theta_rad))
}

/// What the walls say is more than they know: the map they are compared with has errors of its own. Standard
/// deviations of 5 mm and 0.1° are added.
fn loosened(information: &Information) -> Information {
    information.with_noise(0.005, 0.002)
}
