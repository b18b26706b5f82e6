//! Keyframes: the scans that are merged, kept so that the map can be made again from them. What they saw is shared
//! between the tracks that place them differently.

use std::sync::Arc;

use crate::align::SidePoint;
use crate::extract::{Extraction, ScanPolyline};
use crate::geometry::{Point, Pose};
use crate::scan::Scan;

/// What a scan shows, wherever it is placed.
pub(crate) struct Seen<'a> {
    pub scan: &'a Scan,
    pub extraction: Arc<Extraction>,
    /// The returns on its polylines.
    pub points: Arc<[SidePoint]>,
}

/// A scan that is part of the map.
#[derive(Clone, Debug)]
pub(crate) struct Keyframe {
    /// Number of the scan in the log.
    pub number: usize,
    pub scan: Arc<Scan>,
    pub extraction: Arc<Extraction>,
    /// Which of the polylines belong to moving objects, and are not merged.
    pub is_moving: Vec<bool>,
    pub points: Arc<[SidePoint]>,
    /// Returns in a row that come from no stable shape, laser frame.
    pub disordered_runs: Arc<[Vec<Point>]>,
    /// Way of the scanner up to here, metres.
    pub way_m: f64,
    /// The scanner in the map.
    pub map_from_scan: Pose,
}

impl Keyframe {
    /// The polylines that are merged.
    pub fn standing_polylines(&self) -> impl Iterator<Item = &ScanPolyline> {
        self.extraction
            .polylines
            .iter()
            .zip(&self.is_moving)
            .filter(|(_, moving)| !**moving)
            .map(|(p, _)| p)
    }
}
