//! The pipeline: scan → polylines → match → alignment → merge → map (paper section 2).
//!
//! In: scans, in order. Out: a pose and all that happened for each, and the polygonal map.
//!
//! ```
//! use polymapper_core::mapper::{Mapper, Outcome, Settings};
//! use polymapper_core::scan::{Scan, ScanGeometry};
//!
//! // A scanner in the middle of a room of 6 m × 4 m looks all round, twice.
//! let geometry = ScanGeometry::new(0.0, 1_f64.to_radians(), 360)?;
//! let ranges_m: Vec<f64> = (0..360)
//!     .map(|beam| {
//!         let (sin, cos) = geometry.bearing_rad(beam).sin_cos();
//!         (3.0 / cos.abs()).min(2.0 / sin.abs())
//!     })
//!     .collect();
//! let scan = Scan::new(geometry, ranges_m)?;
//!
//! let mut mapper = Mapper::new(Settings::default());
//! mapper.add_scan(&scan, None);
//! let step = mapper.add_scan(&scan, None);
//! assert!(matches!(step.outcome, Outcome::Placed { map_from_scan } if map_from_scan.translation().norm() < 0.01));
//!
//! let map = mapper.map();
//! let wall_m: f64 = map.polylines.iter().filter_map(|p| p.polyline()).map(|p| p.length_m()).sum();
//! assert!((wall_m - 20.0).abs() < 0.3, "{wall_m}");
//! # Ok::<(), polymapper_core::scan::ScanError>(())
//! ```

mod atlas;
mod settings;
mod step;

use crate::align::SidePoint;
use crate::align::side_points;
use crate::extract::{ExtractSettings, Extraction, RunningNoise, extract};
use crate::geometry::Pose;
use crate::map::Map;
use crate::place::{Answer, Motion, Question, place};
use crate::scan::Scan;
use atlas::Atlas;

pub use settings::Settings;
pub use step::{NotPlaced, Outcome, Stage, Step};

/// Builds a map scan by scan.
pub struct Mapper {
    settings: Settings,
    noise: RunningNoise,
    motion: Option<Motion>,
    /// Odometry of the last placed scan.
    odometry: Option<Pose>,
    scans: Vec<Held>,
    atlas: Atlas,
}

/// How a scan is held: by a keyframe, with which it moves when loops are closed, or not at all.
#[derive(Clone, Copy)]
enum Held {
    By {
        keyframe: usize,
        keyframe_from_scan: Pose,
    },
    Nowhere(NotPlaced),
}

/// Returns on polylines that an alignment needs.
const LEAST_POINTS: usize = 10;

impl Mapper {
    /// An empty map.
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            noise: RunningNoise::default(),
            motion: None,
            odometry: None,
            scans: Vec::new(),
            atlas: Atlas::default(),
        }
    }

    /// Places the next scan and merges it. `odometry` is the pose of the laser by wheel odometry, in any fixed frame:
    /// a prior for where to look, with its own noise.
    pub fn add_scan(&mut self, scan: &Scan, odometry: Option<Pose>) -> Step {
        self.add_scan_watched(scan, odometry, &mut |_| ())
    }

    /// [`Self::add_scan`], calling `enter` as each stage begins.
    pub fn add_scan_watched(
        &mut self,
        scan: &Scan,
        odometry: Option<Pose>,
        enter: &mut dyn FnMut(Stage),
    ) -> Step {
        enter(Stage::Extract);
        let extraction = self.extract(scan);
        let points = side_points(scan, &extraction.polylines, extraction.noise_m);

        enter(Stage::Place);
        let answer = self.place(&extraction, &points, odometry);
        let mut step = Step::new(self.scans.len(), extraction, &answer);
        let Some(pose) = step.placed() else {
            self.miss(&step);
            return step;
        };
        self.advance(pose, odometry);

        enter(Stage::Merge);
        if self.atlas.wants(pose, &step) {
            self.atlas
                .add_keyframe(&mut step, scan, points, pose, &self.settings);
            enter(Stage::Loops);
            let moved = self.atlas.close_loops(&mut step, &self.settings);
            self.follow(moved);
        }
        self.hold(&mut step);
        step
    }

    fn extract(&mut self, scan: &Scan) -> Extraction {
        self.noise.observe(scan);
        let noise_m = self.settings.extract.noise_m.or(self.noise.sigma_m());
        extract(
            scan,
            &ExtractSettings {
                noise_m,
                ..self.settings.extract
            },
        )
    }

    fn place(
        &self,
        extraction: &Extraction,
        points: &[SidePoint],
        odometry: Option<Pose>,
    ) -> Result<Answer, NotPlaced> {
        if points.len() < LEAST_POINTS {
            return Err(NotPlaced::TooFewReturns);
        }
        let Some(mut motion) = self.motion else {
            return Ok(Answer::default());
        };
        if let (Some(before), Some(now)) = (self.odometry, odometry) {
            motion.driven = Some(before.inverse() * now);
        }
        let question = Question {
            points,
            polylines: &extraction.polylines,
            map: self.atlas.local(),
            merged_into: self.atlas.merged_into(),
            motion: &motion,
        };
        let answer = place(question, &self.settings.align, &self.settings.place);
        if answer.placement.is_some() {
            Ok(answer)
        } else {
            Err(NotPlaced::NoMatch)
        }
    }

    /// Takes note of a scan that has no place.
    fn miss(&mut self, step: &Step) {
        let reason = match step.outcome {
            Outcome::NotPlaced { reason } => reason,
            Outcome::Placed { .. } => NotPlaced::NoMatch,
        };
        self.scans.push(Held::Nowhere(reason));
        if let Some(motion) = &mut self.motion {
            motion.lost_scans += 1;
        }
    }

    /// The motion goes on from a new pose.
    fn advance(&mut self, pose: Pose, odometry: Option<Pose>) {
        self.motion = Some(
            self.motion
                .map_or_else(|| Motion::starting_at(pose), |m| m.advanced(pose)),
        );
        self.odometry = odometry;
    }

    /// Moves along with the newest keyframe when a closed loop has moved it.
    fn follow(&mut self, map_moved: Pose) {
        if let Some(motion) = &mut self.motion {
            motion.map_from_scan = map_moved * motion.map_from_scan;
        }
    }

    fn hold(&mut self, step: &mut Step) {
        let pose = self.motion.map_or(Pose::IDENTITY, |m| m.map_from_scan);
        step.outcome = Outcome::Placed { map_from_scan: pose };
        let (keyframe, map_from_keyframe) = self.atlas.newest();
        self.scans.push(Held::By {
            keyframe,
            keyframe_from_scan: map_from_keyframe.inverse() * pose,
        });
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
                    map_from_scan: self.atlas.pose(keyframe) * keyframe_from_scan,
                },
                Held::Nowhere(reason) => Outcome::NotPlaced { reason },
            })
            .collect()
    }

    /// The map of all scans so far: a function of the keyframes and their poses.
    #[must_use]
    pub fn map(&self) -> Map {
        self.atlas.map(&self.settings)
    }
}

impl Step {
    fn new(scan: usize, extraction: Extraction, answer: &Result<Answer, NotPlaced>) -> Self {
        let placement = answer.as_ref().ok().and_then(|a| a.placement);
        let outcome = match answer {
            Ok(answer) => Outcome::Placed {
                // The first scan makes the frame of the map.
                map_from_scan: answer
                    .placement
                    .map_or(Pose::IDENTITY, |p| p.alignment.map_from_scan),
            },
            Err(reason) => Outcome::NotPlaced { reason: *reason },
        };
        Self {
            scan,
            outcome,
            extraction,
            virtual_scan: answer.as_ref().ok().and_then(|a| a.virtual_scan.clone()),
            matching: answer.as_ref().ok().and_then(|a| a.matching.clone()),
            lead: placement.and_then(|p| p.lead),
            alignment: placement.map(|p| p.alignment),
            agreement: placement.map(|p| p.agreement),
            merged: None,
            moving: Vec::new(),
            recognised: None,
        }
    }

    fn placed(&self) -> Option<Pose> {
        match self.outcome {
            Outcome::Placed { map_from_scan } => Some(map_from_scan),
            Outcome::NotPlaced { .. } => None,
        }
    }
}
