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
    /// The middle of the returns, laser frame.
    pub middle: Point,
    /// Returns in a row that come from no stable shape, laser frame.
    pub disordered_runs: Arc<[Vec<Point>]>,
    /// Way of the scanner up to here, metres.
    pub way_m: f64,
    /// When it was placed, other places came near.
    pub is_doubtful: bool,
    /// The scanner's motion from scan to scan when it was taken; none where that is not known.
    pub step: Pose,
    /// The scanner in the map.
    pub map_from_scan: Pose,
}

/// The middle of the returns, laser frame.
pub(crate) fn middle_of(points: &[SidePoint]) -> Point {
    let sum = points.iter().fold(Point::default(), |sum, p| sum + p.point);
    sum / points.len().max(1) as f64
}

impl Keyframe {
    /// The middle of what it saw, map frame: two scans show the same walls when these are near, wherever the scanner stood.
    pub fn seen_around(&self) -> Point {
        self.map_from_scan * self.middle
    }

    /// The returns on the polylines that are merged.
    pub fn standing_points(&self) -> impl Iterator<Item = &SidePoint> {
        self.points.iter().filter(|p| !self.moves(p))
    }

    /// Whether a return lies on something that moves.
    pub fn moves(&self, point: &SidePoint) -> bool {
        let is_moving = self.is_moving.get(point.polyline as usize);
        is_moving.copied().unwrap_or(false)
    }

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

/// Keyframes of small drawn worlds, for tests.
#[cfg(test)]
pub(crate) mod drawn {
    use super::{Arc, Keyframe, Point, Pose, Scan};
    use crate::align::side_points;
    use crate::extract::{ExtractSettings, extract};
    use crate::geometry::SideGrid;
    use crate::scan::ScanGeometry;

    pub(crate) type Wall<'a> = &'a [(f64, f64)];

    /// A hall with pillars at its walls at uneven distances.
    pub(crate) const HALL: &[Wall] = &[
        &[
            (-10.0, -2.0),
            (10.0, -2.0),
            (10.0, 2.0),
            (-10.0, 2.0),
            (-10.0, -2.0),
        ],
        &[(1.0, -2.0), (1.0, -1.4), (0.5, -1.4), (0.5, -2.0)],
        &[(-3.2, -2.0), (-3.2, -1.4), (-4.4, -1.4), (-4.4, -2.0)],
        &[(4.0, 2.0), (4.0, 1.2), (4.3, 1.2), (4.3, 2.0)],
    ];

    /// What a scanner with 0.5° all round sees of the walls.
    pub(crate) fn keyframe(walls: &[Wall], map_from_scan: Pose) -> Keyframe {
        let mut grid = SideGrid::default();
        for (owner, wall) in (0..).zip(walls) {
            grid.insert(owner, wall.iter().map(|&(x, y)| Point::new(x, y)));
        }
        let geometry = ScanGeometry::new(0.0, 0.5_f64.to_radians(), 720).unwrap();
        let mut reader = grid.reader();
        let ranges_m = (0..720)
            .map(|beam| {
                let direction = Point::from_polar(1.0, geometry.bearing_rad(beam) + map_from_scan.theta_rad);
                let hit = reader.first_along_ray(map_from_scan.translation(), direction, 30.0);
                hit.map_or(f64::NAN, |h| h.range_m)
            })
            .collect();
        let scan = Scan::new(geometry, ranges_m).unwrap();
        let extraction = extract(&scan, &ExtractSettings::default());
        let points = side_points(&scan, &extraction.polylines, extraction.noise_m);
        Keyframe {
            number: 0,
            is_moving: vec![false; extraction.polylines.len()],
            extraction: Arc::new(extraction),
            middle: super::middle_of(&points),
            points: points.into(),
            disordered_runs: Arc::new([]),
            scan: Arc::new(scan),
            way_m: 0.0,
            is_doubtful: false,
            step: Pose::IDENTITY,
            map_from_scan,
        }
    }
}
