//! What is done when no scan follows: poses and walls are adjusted together.

use super::Atlas;
use crate::adjust::adjusted;
use crate::geometry::{Pose, SideGrid};
use crate::mapper::Settings;
use crate::merge::eraser::boxes;
use crate::merge::growing_map::GrowingMap;
use crate::merge::overlap::merge_overlaps;
use crate::merge::{MergeSettings, merge_all};

impl Atlas {
    /// Adjusts the poses of all keyframes and the walls together. A wall that stood twice stands once after it, and is
    /// straighter: the returns are assigned again as long as something moves. Returns the motion of the map frame that
    /// the newest keyframe has made.
    pub fn settle(&mut self, settings: &Settings) -> Pose {
        let (newest, before) = self.newest();
        for _ in 0..settings.adjust.rounds {
            let sides = self.walls(settings);
            let poses = adjusted(&self.keyframes, &self.edges, &sides, &settings.adjust);
            let mut farthest_m = 0.0_f64;
            for (keyframe, pose) in self.keyframes.iter_mut().zip(poses) {
                farthest_m = farthest_m.max(keyframe.map_from_scan.distance(pose));
                keyframe.map_from_scan = pose;
            }
            if farthest_m < settings.adjust.again_beyond_m {
                break;
            }
        }
        self.has_moved = true;
        self.pose(newest) * before.inverse()
    }

    /// The sides of a map of all keyframes, with few corners.
    fn walls(&self, settings: &Settings) -> SideGrid {
        let merge = MergeSettings {
            skeleton_sigma_m: settings.adjust.skeleton_sigma_m,
            ..settings.merge
        };
        let erased = boxes(&self.keyframes, &settings.eraser);
        let mut map = GrowingMap::default();
        merge_all(&mut map, (0..).zip(&self.keyframes), &erased, &merge);
        merge_overlaps(&mut map, &merge);
        map.skeleton
    }
}
