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

pub(crate) mod atlas;
mod left;
mod quality;
mod settings;
mod step;
mod track;
mod tracks;

use std::sync::Arc;

use crate::align::side_points;
use crate::extract::{ExtractSettings, Extraction, RunningNoise, extract};
use crate::geometry::Pose;
use crate::join::SavedMap;
use crate::keyframe::Seen;
use crate::map::Map;
use crate::place::Answer;
use crate::scan::Scan;
use crate::sweep::Sweep;
use track::Track;
use tracks::{Onward, onward};

pub use crate::place::Origin;
pub use atlas::loose::LooseStretch;
pub use quality::Quality;
pub use settings::Settings;
pub use step::{Hypothesis, NotPlaced, Outcome, Revoked, Stage, Step};

/// Builds a map scan by scan.
pub struct Mapper {
    settings: Settings,
    noise: RunningNoise,
    /// Number of the next scan.
    next: usize,
    /// Accounts of the motion so far, best first; more than one while the walls cannot tell.
    tracks: Vec<Track>,
    /// Scans since there was but one.
    scans_undecided: usize,
    /// How far the scanner moves while its beam goes round.
    sweep: Sweep,
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
            next: 0,
            tracks: vec![Track::default()],
            scans_undecided: 0,
            sweep: Sweep::default(),
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
        let number = self.next;
        self.next += 1;
        let straight = self.straightened(scan);
        let scan = straight.as_ref().unwrap_or(scan);
        let extraction = Arc::new(self.extract(scan));
        let points = side_points(scan, &extraction.polylines, extraction.noise_m);
        let seen = Seen {
            scan,
            extraction: Arc::clone(&extraction),
            points: points.into(),
        };
        if seen.points.len() < LEAST_POINTS {
            self.tracks
                .iter_mut()
                .for_each(|t| t.miss(NotPlaced::TooFewReturns));
            return Step::new(number, extraction, NotPlaced::TooFewReturns);
        }

        enter(Stage::Place);
        let settings = &self.settings;
        let answers: Vec<Answer> = self
            .tracks
            .iter()
            .map(|track| track.place(&seen, odometry, settings))
            .collect();
        let backs: Vec<Option<(usize, Answer)>> = self
            .tracks
            .iter()
            .zip(&answers)
            .map(|(track, answer)| {
                let is_lost = answer.believed.is_empty();
                is_lost.then(|| track.place_back(&seen, settings)).flatten()
            })
            .collect();
        let ways = onward(&self.tracks, &answers, &backs, self.scans_undecided);

        let mut steps: Vec<Step> = Vec::with_capacity(ways.len());
        let mut tracks: Vec<Track> = Vec::with_capacity(ways.len());
        for way in &ways {
            let mut track = if ways.len() == 1 {
                std::mem::take(&mut self.tracks[way.track])
            } else {
                self.tracks[way.track].clone()
            };
            track.merit = way.merit;
            let mut step = Step::new(number, Arc::clone(&extraction), NotPlaced::SeparateSubmap);
            let back = backs[way.track].as_ref().map(|(_, answer)| answer);
            step.tell(back.unwrap_or(&answers[way.track]), &way.way, &settings.align);
            self.go_on(&mut track, &mut step, way, &seen, odometry, enter);
            tracks.push(track);
            steps.push(step);
        }
        self.tracks = tracks;
        if let [only] = self.tracks.as_mut_slice() {
            only.merit = 0.0;
            self.scans_undecided = 0;
            if steps[0].merged.is_some() && self.sweep.observe(only.keyframes(), &self.settings.align) {
                only.straighten(self.sweep.applied(), &self.settings);
            }
        } else {
            self.scans_undecided += 1;
        }
        let mut step = steps.swap_remove(0);
        step.tracks = self.tracks.len();
        step
    }

    fn go_on(
        &self,
        track: &mut Track,
        step: &mut Step,
        way: &Onward,
        seen: &Seen,
        odometry: Option<Pose>,
        enter: &mut dyn FnMut(Stage),
    ) {
        let (pose, covariance) = track.advance(&way.way, odometry);
        step.covariance = covariance;
        enter(Stage::Merge);
        if track.wants(pose, step, &self.settings) {
            track.merge(pose, step, seen, &self.settings);
            enter(Stage::Loops);
            track.close_loops(step, &self.settings);
            // The others look when they lead: two in three of these searches were for accounts that were given up.
            if way.leads {
                track.join_left(step, &self.settings);
            }
        }
        step.outcome = track.hold();
    }

    /// The scan as it would have been taken at once, by the speed so far; `None` when that is how it was taken.
    fn straightened(&self, scan: &Scan) -> Option<Scan> {
        let speed = self.tracks.first().map_or(Pose::IDENTITY, Track::speed);
        let turn_motion = speed.scaled(self.sweep.applied());
        (turn_motion != Pose::IDENTITY).then(|| scan.straightened(turn_motion))
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

    /// To be called when no scan follows, before the outcomes and the map are asked for: the best account of the motion is
    /// taken, and poses and walls are adjusted together. Scans may follow all the same. Returns the numbers of the scans
    /// that the finished map contradicted and that were given another place.
    pub fn settle(&mut self) -> Vec<usize> {
        self.tracks.truncate(1);
        let is_changed = self.sweep.settle();
        let Some(track) = self.tracks.first_mut() else {
            return Vec::new();
        };
        if is_changed {
            track.straighten(self.sweep.applied(), &self.settings);
        }
        track.settle(&self.settings)
    }

    /// The share of the motion from scan to scan that the scanner makes while its beam goes round once, negative clockwise, as
    /// far as the log has shown it; scans are made straight with it. 0 while there is no sign of any.
    #[must_use]
    pub fn sweep_share(&self) -> f64 {
        self.sweep.applied()
    }

    /// What became of every scan so far, in the map frame as it is now.
    #[must_use]
    pub fn outcomes(&self) -> Vec<Outcome> {
        self.tracks.first().map_or_else(Vec::new, Track::outcomes)
    }

    /// Where the map hangs together loosely: stretches of the way that all that was measured leaves open by more than 0.25 m
    /// or 0.1 rad (one standard deviation). A map may be wrong there and fit all the same. For a map that is settled.
    #[must_use]
    pub fn loose_stretches(&self) -> Vec<LooseStretch> {
        self.tracks.first().map_or_else(Vec::new, Track::loose_stretches)
    }

    /// What must be kept of the map so that it can be continued another day.
    #[must_use]
    pub fn saved(&self) -> SavedMap {
        self.tracks.first().map_or_else(SavedMap::default, Track::saved)
    }

    /// The map of all scans so far: a function of the keyframes and their poses.
    #[must_use]
    pub fn map(&self) -> Map {
        self.tracks
            .first()
            .map_or_else(Map::default, |track| track.map(&self.settings))
    }
}
