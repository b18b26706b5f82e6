//! The sides of the map as unknown lines, and which returns lie on them.

use super::equations::Line;
use crate::geometry::{Near, SideGrid};
use crate::keyframe::Keyframe;

/// A return may differ from its side by 20° in direction.
const MIN_COS: f64 = 0.94;

/// Returns of one keyframe on one line.
pub(super) struct View {
    pub keyframe: usize,
    pub line: usize,
    /// Numbers of the returns among the keyframe's points.
    pub points: Vec<u32>,
}

/// Lines, and who sees them.
pub(super) struct Walls {
    pub lines: Vec<Line>,
    pub views: Vec<View>,
}

impl Walls {
    /// Which returns lie within `gate_m` of which side. What moves is left out.
    pub fn seen_by(keyframes: &[Keyframe], sides: &SideGrid, gate_m: f64) -> Self {
        let line = |side: &crate::geometry::Side| Line {
            middle: side.segment.at(0.5),
            direction: side.direction,
        };
        Self {
            lines: sides.numbered().iter().map(line).collect(),
            views: keyframes
                .iter()
                .enumerate()
                .flat_map(|(number, keyframe)| views(number, keyframe, sides, gate_m))
                .collect(),
        }
    }

    /// Moves the lines by a shift along their normal, metres, and a turn about their middle, radians.
    pub fn follow(&mut self, moves: &[[f64; 2]]) {
        for (line, [shift_m, turn_rad]) in self.lines.iter_mut().zip(moves) {
            let normal = line.direction.left();
            line.middle += normal * *shift_m;
            line.direction = (line.direction + normal * *turn_rad)
                .unit()
                .unwrap_or(line.direction);
        }
    }
}

/// The lines that a keyframe sees.
fn views(number: usize, keyframe: &Keyframe, sides: &SideGrid, gate_m: f64) -> Vec<View> {
    let map_from_scan = keyframe.map_from_scan.isometry();
    let mut found: Vec<(u32, u32)> = Vec::new();
    let mut reader = sides.reader();
    for (k, p) in (0_u32..).zip(keyframe.points.iter()) {
        if keyframe.moves(p) {
            continue;
        }
        let near = Near {
            direction: map_from_scan.rotate(p.direction),
            min_cos: MIN_COS,
            max_distance_m: gate_m,
            beyond_ends: false,
        };
        let foot = reader.nearest(map_from_scan * p.point, &near, |_| true);
        found.extend(foot.map(|foot| (foot.side, k)));
    }
    found.sort_unstable();
    found
        .chunk_by(|a, b| a.0 == b.0)
        .map(|on_one| View {
            keyframe: number,
            line: on_one[0].0 as usize,
            points: on_one.iter().map(|&(_, k)| k).collect(),
        })
        .collect()
}
