//! The poses in the log, as they are and with the rotation corrected, for Fig. 1 (a) and (b).

use polymapper_core::extract::{ExtractSettings, extract};
use polymapper_core::geometry::{Pose, Segment};

use super::rotation::rotation_corrected;
use super::survey::{Survey, SurveyedScan};

/// Poses of all scans of a survey; those of the first scan are the identity, as in the map.
pub struct Paths {
    /// As the log has them.
    pub raw: Vec<Pose>,
    /// With large errors of rotation taken out.
    pub rotation_corrected: Vec<Pose>,
}

impl Paths {
    /// `None` for a log without poses, or with one and the same for all scans.
    pub fn of(survey: &Survey) -> Option<Self> {
        let poses: Vec<Pose> = survey.scans.iter().map(|s| s.log_pose).collect::<Option<_>>()?;
        let first = *poses.first()?;
        // A log without odometry fills its fields with zeros.
        if poses.iter().all(|pose| *pose == first) {
            return None;
        }
        let raw: Vec<Pose> = poses.iter().map(|&pose| first.inverse() * pose).collect();
        let sides: Vec<Vec<Segment>> = survey.scans.iter().map(sides).collect();
        let rotation_corrected = rotation_corrected(&raw, &sides);
        Some(Self {
            raw,
            rotation_corrected,
        })
    }
}

fn sides(scan: &SurveyedScan) -> Vec<Segment> {
    extract(&scan.scan, &ExtractSettings::default())
        .polylines
        .iter()
        .flat_map(|p| p.polyline.sides())
        .collect()
}
