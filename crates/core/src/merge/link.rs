//! Closest points (paper section 4): which point of the map each simulated scan point belongs to.

use super::growing_map::GrowingMap;
use super::simulate::ScanPoint;
use crate::geometry::{GridReader, Near, Point};

/// A place on a polyline of the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link {
    /// The polyline's slot.
    pub slot: u32,
    /// Number of the vertex before, plus the share of the side.
    pub at: f64,
    /// The point itself.
    pub point: Point,
}

/// Consecutive scan points with the same fate.
#[derive(Clone, Debug)]
pub(crate) struct Run {
    /// The polyline of the map they belong to; `None` for what the map does not hold yet.
    pub slot: Option<u32>,
    /// Number of its first point among all points of the scan's polyline.
    pub first: usize,
    /// The points, in the order of the scan.
    pub points: Vec<(ScanPoint, Option<Link>)>,
}

impl Run {
    /// First and last place on the map's polyline.
    pub fn reach(&self) -> Option<(f64, f64)> {
        Some((self.points.first()?.1?.at, self.points.last()?.1?.at))
    }
}

/// The runs of one polyline of the scan. A point stays with the polyline of the point before it as long as that is
/// within the gate: where two polylines of the map lie side by side, taking the nearer one point by point would tear
/// both to pieces.
pub(crate) fn runs(map: &GrowingMap, points: &[ScanPoint], gate_m: f64) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut reader = map.dense.reader();
    for (number, &point) in points.iter().enumerate() {
        let previous = runs.last().and_then(|r| r.slot);
        let link = previous
            .and_then(|slot| closest(&mut reader, &point, gate_m, |s| s == slot))
            .or_else(|| closest(&mut reader, &point, gate_m, |_| true));
        push(&mut runs, number, point, link);
    }
    without_flickers(runs, gate_m)
}

pub(super) fn closest(
    sides: &mut GridReader,
    p: &ScanPoint,
    gate_m: f64,
    allowed: impl Fn(u32) -> bool,
) -> Option<Link> {
    // 60°: the sides between map vertices a few centimetres apart carry ±20° of noise, and the two walls of a
    // corner differ by 90°.
    let near = Near {
        direction: p.direction,
        min_cos: 0.5,
        max_distance_m: gate_m,
        beyond_ends: false,
    };
    let foot = sides.nearest(p.vertex.point, &near, allowed)?;
    let side = sides.side(foot.side);
    Some(Link {
        slot: side.owner,
        at: f64::from(side.index) + foot.share,
        point: foot.point,
    })
}

/// How far a link may slip back along the map's polyline and still continue the run, in vertices.
const SLIP_VERTICES: f64 = 2.0;

fn push(runs: &mut Vec<Run>, number: usize, point: ScanPoint, link: Option<Link>) {
    if let Some(run) = runs.last_mut()
        && run.slot == link.map(|l| l.slot)
    {
        match (run.points.last().and_then(|p| p.1), link) {
            (Some(before), Some(mut link)) if link.at >= before.at - SLIP_VERTICES => {
                if link.at < before.at {
                    link = before;
                }
                run.points.push((point, Some(link)));
                return;
            }
            (None, None) => {
                run.points.push((point, None));
                return;
            }
            _ => {}
        }
    }
    runs.push(Run {
        slot: link.map(|l| l.slot),
        first: number,
        points: vec![(point, link)],
    });
}

/// Joins two runs on the same polyline that one or two unlinked points hold apart: outliers, not a new object.
fn without_flickers(runs: Vec<Run>, gate_m: f64) -> Vec<Run> {
    let mut out: Vec<Run> = Vec::with_capacity(runs.len());
    for run in runs {
        let continues = |older: &Run| {
            older.slot.is_some()
                && older.slot == run.slot
                && older
                    .reach()
                    .zip(run.reach())
                    .is_some_and(|(o, n)| n.0 >= o.1 - SLIP_VERTICES)
        };
        let length_m = |r: &Run| {
            let ends = r.points.first().zip(r.points.last());
            ends.map_or(0.0, |(a, b)| a.0.vertex.point.distance(b.0.vertex.point))
        };
        let n = out.len();
        let flicker = n >= 2
            && out[n - 1].slot.is_none()
            && out[n - 1].points.len() <= 2
            && length_m(&out[n - 1]) <= gate_m
            && continues(&out[n - 2]);
        if flicker {
            out.pop();
            out[n - 2].points.extend(run.points);
        } else {
            out.push(run);
        }
    }
    out
}
