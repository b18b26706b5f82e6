//! The map around: what the next scan is matched with (the paper's G(t−1), as far as it agrees with itself).
//!
//! In: the keyframes, and which of those within reach along the pose graph are needed ([`super::enough`]). Out: their
//! map, a function of the keyframes and their poses and of the order in which they were taken in: the same as if it were
//! merged from nothing.
//!
//! A keyframe that comes into reach is merged into what is there. All is merged anew when poses move, and when there is
//! something in it that may have drifted. When something in the newest keyframes is found to have moved, these are merged
//! again into the map as it was before them: a copy of that is kept, which shares most polylines with the map.

use std::sync::Arc;

use crate::keyframe::Keyframe;
use crate::map::EraserBox;
use crate::mapper::Settings;
use crate::merge::eraser::boxes;
use crate::merge::growing_map::GrowingMap;
use crate::merge::{MergeReport, merge_all};

/// Copies of the map that are kept. What moved is found within a few keyframes; the older copy serves just after the
/// newer one was made.
const COPIES: usize = 2;

/// See the module.
#[derive(Clone, Default)]
pub(super) struct Local {
    map: GrowingMap,
    /// Where nothing is merged.
    boxes: Vec<EraserBox>,
    /// The keyframes it is made of, in the order in which they were merged.
    order: Vec<usize>,
    /// The polylines that the last keyframe was merged into.
    merged_into: Vec<u32>,
    /// The map as it was, oldest first.
    copies: Vec<Arc<Copy>>,
}

/// The map when it was made of so many keyframes.
struct Copy {
    count: usize,
    map: GrowingMap,
}

impl Local {
    pub fn map(&self) -> &GrowingMap {
        &self.map
    }

    /// The polylines that the last keyframe was merged into, by slot.
    pub fn merged_into(&self) -> &[u32] {
        &self.merged_into
    }

    /// The keyframes it is made of, in the order in which they were merged.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// Merges a keyframe.
    pub fn add(&mut self, keyframes: &[Keyframe], new: usize, settings: &Settings) -> MergeReport {
        self.merge(keyframes, &[new], settings)
    }

    /// Merges all of `within` from nothing.
    pub fn renew(&mut self, keyframes: &[Keyframe], within: &[usize], settings: &Settings) {
        self.map = GrowingMap::default();
        self.boxes = boxes(keyframes, &settings.eraser);
        self.order.clear();
        self.copies.clear();
        self.merge(keyframes, within, settings);
        self.keep_copy();
    }

    /// Merges those of `within` that are not in it yet.
    pub fn take_in(&mut self, keyframes: &[Keyframe], within: &[usize], settings: &Settings) {
        let mut is_new = vec![true; keyframes.len()];
        for &k in &self.order {
            is_new[k] = false;
        }
        let new: Vec<usize> = within.iter().copied().filter(|&k| is_new[k]).collect();
        if !new.is_empty() {
            self.merge(keyframes, &new, settings);
        }
        self.keep_copy();
    }

    /// Merges again what was merged from keyframe `first` on, as the keyframes are now.
    pub fn merge_again(&mut self, keyframes: &[Keyframe], first: usize, settings: &Settings) {
        let sound = self.order.iter().take_while(|&&k| k < first).count();
        self.copies.retain(|copy| copy.count <= sound);
        let (map, count) = self
            .copies
            .last()
            .map_or_else(Default::default, |copy| (copy.map.clone(), copy.count));
        self.map = map;
        let again = self.order.split_off(count);
        self.merge(keyframes, &again, settings);
    }

    fn merge(&mut self, keyframes: &[Keyframe], new: &[usize], settings: &Settings) -> MergeReport {
        let numbered = new.iter().map(|&k| (k as u32, &keyframes[k]));
        let report = merge_all(&mut self.map, numbered, &self.boxes, &settings.merge);
        self.order.extend(new);
        self.merged_into.clone_from(&report.into);
        report
    }

    fn keep_copy(&mut self) {
        if self.copies.len() == COPIES {
            self.copies.remove(0);
        }
        self.copies.push(Arc::new(Copy {
            count: self.order.len(),
            map: self.map.clone(),
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::keyframe::drawn::keyframe;

    /// A scanner goes through a room; a box stands in it in the last keyframes.
    fn walk() -> Vec<Keyframe> {
        let room = [
            (-3.0, -3.0),
            (5.0, -3.0),
            (5.0, 3.0),
            (1.0, 3.0),
            (1.0, 5.0),
            (-3.0, 5.0),
            (-3.0, -3.0),
        ];
        let thing = [(2.0, -1.2), (2.0, -0.8), (2.4, -0.8)];
        (0..12)
            .map(|k| {
                let pose = Pose::new(
                    0.25 * f64::from(k) - 2.0,
                    0.1 * f64::from(k % 3),
                    0.2 * f64::from(k),
                );
                if k < 9 {
                    keyframe(&[&room], pose)
                } else {
                    keyframe(&[&room, &thing], pose)
                }
            })
            .collect()
    }

    /// All there is in the map, to the last bit.
    fn written(local: &Local) -> String {
        let polylines: Vec<_> = local.map.polylines().collect();
        let sides: Vec<_> = local.map.skeleton.sides().collect();
        format!("{polylines:?} {sides:?}")
    }

    fn from_nothing(keyframes: &[Keyframe], order: &[usize], settings: &Settings) -> String {
        let mut local = Local::default();
        local.renew(keyframes, order, settings);
        written(&local)
    }

    #[test]
    fn what_was_merged_bit_by_bit_is_the_same_as_from_nothing() {
        let (keyframes, settings) = (walk(), Settings::default());
        let mut local = Local::default();
        local.renew(&keyframes, &[4, 5], &settings);
        local.add(&keyframes, 6, &settings);
        local.take_in(&keyframes, &[1, 2, 5, 6], &settings);
        local.add(&keyframes, 7, &settings);
        assert_eq!(local.order(), [4, 5, 6, 1, 2, 7]);
        assert_eq!(
            written(&local),
            from_nothing(&keyframes, &[4, 5, 6, 1, 2, 7], &settings)
        );
    }

    #[test]
    fn what_turns_out_to_move_leaves_no_trace() {
        let (mut keyframes, settings) = (walk(), Settings::default());
        let mut local = Local::default();
        local.renew(&keyframes, &[0, 1, 2, 3, 4, 5, 6], &settings);
        for k in 7..12 {
            local.add(&keyframes, k, &settings);
        }
        let before = written(&local);
        for keyframe in &mut keyframes[9..] {
            let is_small = keyframe
                .extraction
                .polylines
                .iter()
                .map(|p| p.polyline.length_m() < 1.2);
            keyframe.is_moving = is_small.collect();
            assert!(keyframe.is_moving.contains(&true), "the thing is seen");
        }
        local.merge_again(&keyframes, 9, &settings);
        assert_ne!(written(&local), before);
        let order: Vec<usize> = (0..12).collect();
        assert_eq!(local.order(), order);
        assert_eq!(written(&local), from_nothing(&keyframes, &order, &settings));
        // Farther back than the copies reach.
        local.merge_again(&keyframes, 2, &settings);
        assert_eq!(written(&local), from_nothing(&keyframes, &order, &settings));
    }

    #[test]
    fn what_an_older_keyframe_could_not_see_yet_is_not_looked_through() {
        // The thing was put there after keyframes 0 to 5, which come into reach later.
        let (keyframes, settings) = (walk(), Settings::default());
        let is_there = |local: &Local| {
            let near = |x: f64, y: f64| (x - 2.0).abs() < 0.1 && (y + 1.0).abs() < 0.3;
            let mut vertices = local.map.polylines().flat_map(|(_, p)| &p.vertices);
            vertices.any(|v| near(v.point.x, v.point.y))
        };
        let mut local = Local::default();
        local.renew(&keyframes, &[9, 10], &settings);
        assert!(is_there(&local));
        local.take_in(&keyframes, &[0, 1, 2, 3, 4, 5, 9, 10], &settings);
        assert!(is_there(&local));
    }
}
