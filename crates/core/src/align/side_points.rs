//! The returns of a scan with the polyline and the side that each lies on.

use super::SidePoint;
use crate::extract::ScanPolyline;
use crate::geometry::{Bends, Point, Polyline, Segment};
use crate::scan::Scan;

/// A return farther than this from its polyline's sides is an outlier of the extraction.
const OUTLIER_M: f64 = 0.10;
/// Standard deviation that grows with range: unevenness of the floor and of the beams (paper section 2, point 2).
const SIGMA_PER_RANGE: f64 = 0.002;

/// Standard deviation of the map's own sides, metres.
const MAP_SIGMA_M: f64 = 0.01;
/// Independent returns that the returns of one side are worth at most. The worth of a wall saturates where the error
/// of its place (some mm) outweighs the averaged noise of its returns.
const SIDE_WORTH: f64 = 15.0;

/// Polylines shorter than this are worth less, in proportion, metres.
const STEADY_M: f64 = 0.5;

/// The direction of a side shorter than this is not known: a chair leg of 5 cm that three to eight beams hit, with 1 cm of noise, looks
/// turned by 20° and more from scan to scan.
const SHORT_M: f64 = 0.15;
/// What the returns of a scan are worth, in independent ones, when it is to speak for itself: two walls, but for rounding. The leanest scan of nine
/// logs of SICK scanners has 30. A scan that is worth less shows small things, and they must do: asked to be within 32° of the
/// map's sides, half of the returns of a room of chair legs found none (URG, 47 m: 10° off at the end). In other scans small things drag along
/// corridors (raw aces, loops in four of six runs 0.09 to 0.36 m instead of 0.05).
pub(crate) const FULL_WORTH: f64 = 29.0;

/// All returns that lie on a polyline, polyline by polyline; `noise_m` is the range noise.
pub(crate) fn side_points(scan: &Scan, polylines: &[ScanPolyline], noise_m: f64) -> Vec<SidePoint> {
    let beams = scan.geometry().beams();
    let mut out = Vec::with_capacity(beams);
    for (number, polyline) in (0_u32..).zip(polylines) {
        let sides = ScanSide::all_of(&polyline.polyline);
        let mut returns_of_side = vec![0_u32; sides.len()];
        let first = out.len();
        let mut side_of = Vec::new();
        let count = (polyline.last_beam + beams - polyline.first_beam) % beams + 1;
        for beam in (0..count).map(|k| (polyline.first_beam + k) % beams) {
            let Some(point) = scan.point(beam) else { continue };
            let Some(side) = nearest_side(&sides, point) else {
                continue;
            };
            let direction = sides[side].along(point);
            let sigma_m = noise_m.hypot(MAP_SIGMA_M).hypot(SIGMA_PER_RANGE * point.norm());
            out.push(SidePoint {
                point,
                direction,
                sigma_m,
                worth: 1.0,
                is_on_short_side: false,
                polyline: number,
            });
            side_of.push(side);
            returns_of_side[side] += 1;
        }
        // Small things may be legs that walk along with the scanner; a door frame is part of a longer polyline.
        let side_worth = SIDE_WORTH * (polyline.polyline.length_m() / STEADY_M).min(1.0);
        for (p, side) in out[first..].iter_mut().zip(side_of) {
            p.is_on_short_side = sides[side].length_m < SHORT_M;
            p.worth = (side_worth / f64::from(returns_of_side[side])).min(1.0);
        }
    }
    if worth(&out) >= FULL_WORTH {
        out.iter_mut().for_each(|p| p.is_on_short_side = false);
    }
    out
}

/// What returns are worth together, in independent ones.
pub(crate) fn worth(points: &[SidePoint]) -> f64 {
    points.iter().map(|p| p.worth).sum()
}

/// A side of a scan's polyline.
struct ScanSide {
    segment: Segment,
    direction: Point,
    length_m: f64,
    bends: Bends,
}

impl ScanSide {
    fn all_of(polyline: &Polyline) -> Vec<Self> {
        let mut sides: Vec<Self> = Vec::new();
        for segment in polyline.sides() {
            let Some(direction) = segment.direction() else {
                continue;
            };
            let mut side = Self {
                segment,
                direction,
                length_m: segment.length_m(),
                bends: Bends::default(),
            };
            if let Some(last) = sides.last_mut() {
                Bends::join(
                    (&mut last.bends, last.direction, last.length_m),
                    (&mut side.bends, side.direction, side.length_m),
                );
            }
            sides.push(side);
        }
        sides
    }

    /// Unit vector along the wall beside `point`.
    fn along(&self, point: Point) -> Point {
        let share = self.segment.closest_share(point);
        self.bends.along(self.direction, self.length_m, share)
    }
}

/// Number of the side that a return lies on.
fn nearest_side(sides: &[ScanSide], point: Point) -> Option<usize> {
    let (distance_m, k) = sides
        .iter()
        .enumerate()
        .map(|(k, side)| (side.segment.distance(point), k))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    (distance_m < OUTLIER_M).then_some(k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::keyframe::drawn::{HALL, Wall, keyframe};

    /// Two posts, 9 cm wide.
    const POSTS: &[Wall] = &[
        &[(2.0, 0.0), (2.0, 0.09), (2.09, 0.09), (2.09, 0.0), (2.0, 0.0)],
        &[
            (-2.0, 1.0),
            (-2.0, 1.09),
            (-1.91, 1.09),
            (-1.91, 1.0),
            (-2.0, 1.0),
        ],
    ];

    #[test]
    fn small_things_have_no_direction_where_a_scan_shows_nothing_else() {
        let posts = keyframe(POSTS, Pose::IDENTITY);
        assert!(worth(&posts.points) < FULL_WORTH && posts.points.iter().all(|p| p.is_on_short_side));
        let hall: Vec<Wall> = HALL.iter().chain(POSTS).copied().collect();
        let hall = keyframe(&hall, Pose::IDENTITY);
        assert!(worth(&hall.points) >= FULL_WORTH && hall.points.iter().all(|p| !p.is_on_short_side));
    }
}
