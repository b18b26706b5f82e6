//! What a kept scan shows, found again from the scan.

use std::sync::Arc;

use crate::align::{SidePoint, side_points};
use crate::extract::{ExtractSettings, Extraction, extract};
use crate::geometry::Point;
use crate::keyframe::middle_of;
use crate::mapper::Settings;
use crate::merge::eraser::disordered_runs;
use crate::scan::Scan;

/// The parts of a [`crate::keyframe::Keyframe`] that follow from its scan alone, laser frame.
pub(super) struct Shown {
    pub extraction: Arc<Extraction>,
    pub points: Arc<[SidePoint]>,
    pub middle: Point,
    pub disordered_runs: Arc<[Vec<Point>]>,
}

impl Shown {
    /// `noise_m` is the range noise that the scan was extracted with the first time, metres.
    pub fn by(scan: &Scan, noise_m: f64, settings: &Settings) -> Self {
        let extraction = extract(
            scan,
            &ExtractSettings {
                noise_m: Some(noise_m),
                ..settings.extract
            },
        );
        let points: Arc<[SidePoint]> = side_points(scan, &extraction.polylines, extraction.noise_m).into();
        Self {
            middle: middle_of(&points),
            points,
            disordered_runs: disordered_runs(scan, extraction.noise_m, &settings.eraser).into(),
            extraction: Arc::new(extraction),
        }
    }
}
