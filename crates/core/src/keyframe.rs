//! Keyframes: the scans that are merged, kept so that the map can be made again from them.

use crate::extract::ScanPolyline;
use crate::geometry::Pose;
use crate::scan::Scan;

/// A scan that is part of the map.
#[derive(Clone, Debug)]
pub(crate) struct Keyframe {
    /// Number of the scan in the log.
    pub number: usize,
    pub scan: Scan,
    pub polylines: Vec<ScanPolyline>,
    pub map_from_scan: Pose,
}
