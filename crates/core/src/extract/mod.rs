//! Scan → polylines (paper sections 2 and 3.1).

use crate::geometry::Polyline;
use crate::scan::Scan;

/// A polyline of a scan and the beams it came from.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanPolyline {
    /// Laser frame, metres; runs counter-clockwise round the scanner, so that free space is on the left.
    pub polyline: Polyline,
    /// First beam of its group.
    pub first_beam: usize,
    /// Last beam of its group; smaller than `first_beam` when the group runs over the end of a full circle.
    pub last_beam: usize,
}

/// The polylines of a scan, counter-clockwise.
#[must_use]
pub fn extract(_scan: &Scan) -> Vec<ScanPolyline> {
    Vec::new()
}
