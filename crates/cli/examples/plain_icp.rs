//! Plain ICP, the baseline that maps by shape are compared with.
//!
//! `plain_icp LOG TRAJECTORY.csv`: in goes a laser log, out comes a trajectory in the format of `polymapper build`.
//!
//! Every scan starts where constant velocity puts it and is aligned, point to line, with the points of the last 20
//! keyframes (Censi, "An ICP variant using a point-to-line metric", 2008, without its refinements): the nearest map
//! point p within the gate, with its normal n, gives the residual n · (q − p), and Gauss-Newton solves for the
//! motion. No shapes, no test of the result, no loops: what is lost stays lost.

use std::collections::{HashMap, VecDeque};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use anyhow::Context;
use polymapper_core::align::Information;
use polymapper_core::geometry::{Point, Pose, wrap_rad};
use polymapper_core::mapper::Quality;
use polymapper_core::scan::Scan;
use polymapper_io::log::{self, Entry, ReadOptions};
use polymapper_io::out::{Outcome, TrajectoryRow, write_trajectory_csv};

/// Keyframes that make up the local map.
const KEYFRAMES: usize = 20;
/// A scan becomes a keyframe when it has moved this far, metres ...
const KEYFRAME_M: f64 = 0.25;
/// ... or turned this far, radians.
const KEYFRAME_RAD: f64 = 0.17;
/// Farthest map point that a return is compared with in the first round, metres; what returns at 5 m are off by when
/// constant velocity misses a turn of 11°.
const GATE_M: f64 = 1.0;
/// The same in late rounds, metres. Left wide throughout, the ends of walls that come into view pull the pose along.
const LAST_GATE_M: f64 = 0.1;
/// From round to round the gate becomes so much of itself.
const GATE_RATIO: f64 = 0.7;
/// Rounds of Gauss-Newton at most; most scans need five to ten.
const ROUNDS: usize = 30;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [log, trajectory] = &arguments[..] else {
        anyhow::bail!("usage: plain_icp LOG TRAJECTORY.csv");
    };
    let rows = follow(Path::new(log))?;
    let mut out = BufWriter::new(File::create(trajectory).context(trajectory.clone())?);
    write_trajectory_csv(&mut out, &rows)?;
    Ok(())
}

/// Aligns one scan after the other.
fn follow(log: &Path) -> anyhow::Result<Vec<TrajectoryRow>> {
    let mut rows = Vec::new();
    let mut map = LocalMap::default();
    let (mut pose, mut step) = (Pose::IDENTITY, Pose::IDENTITY);
    for entry in log::open(log, ReadOptions::default())? {
        let (scan, stamp_s, outcome) = match entry? {
            Entry::Bad(bad) => (
                bad.index,
                None,
                Outcome::NotPlaced {
                    reason: bad.fault.to_string(),
                },
            ),
            Entry::Scan(entry) => {
                let map_from_scan = map.aligned(&entry.scan, pose * step);
                if !rows.is_empty() {
                    step = pose.inverse() * map_from_scan;
                }
                pose = map_from_scan;
                map.offer(&entry.scan, pose);
                (entry.index, entry.stamp_s, Outcome::Placed { map_from_scan })
            }
        };
        rows.push(TrajectoryRow {
            recognised: None,
            quality: Quality::default(),
            scan,
            stamp_s,
            outcome,
        });
    }
    Ok(rows)
}

/// A return and the unit normal of the wall it lies on.
#[derive(Clone, Copy)]
struct WallPoint {
    at: Point,
    normal: Point,
}

/// The points of the last keyframes, map frame, by cells as wide as the gate.
#[derive(Default)]
struct LocalMap {
    keyframes: VecDeque<(Pose, Vec<WallPoint>)>,
    cells: HashMap<(i64, i64), Vec<WallPoint>>,
}

impl LocalMap {
    /// The pose of a scan, from the one expected; the expected one where nothing can be solved for.
    fn aligned(&self, scan: &Scan, expected: Pose) -> Pose {
        let mut pose = expected;
        let mut gate_m = GATE_M;
        for _ in 0..ROUNDS {
            let (mut information, mut pull) = (Information::default(), [0.0; 3]);
            for (_, point) in scan.points() {
                let arm = pose.rotate(point);
                let at = pose.translation() + arm;
                let Some(wall) = self.nearest(at, gate_m) else {
                    continue;
                };
                // d(n · q) for a motion of the scanner by dx, dy and a turn about it.
                let jacobian = [wall.normal.x, wall.normal.y, arm.cross(wall.normal)];
                let residual_m = wall.normal.dot(at - wall.at);
                information.add_residual(jacobian, 1.0);
                for (sum, j) in pull.iter_mut().zip(jacobian) {
                    *sum -= j * residual_m;
                }
            }
            let Some([dx, dy, turn_rad]) = information.solve(pull) else {
                return pose;
            };
            pose = Pose::new(pose.x + dx, pose.y + dy, wrap_rad(pose.theta_rad + turn_rad));
            if gate_m <= LAST_GATE_M && dx.abs() + dy.abs() + turn_rad.abs() < 1e-5 {
                break;
            }
            gate_m = LAST_GATE_M.max(gate_m * GATE_RATIO);
        }
        pose
    }

    /// Makes a scan a keyframe when it shows something new.
    fn offer(&mut self, scan: &Scan, pose: Pose) {
        let is_near = |&(last, _): &(Pose, _)| {
            last.distance(pose) < KEYFRAME_M && wrap_rad(last.theta_rad - pose.theta_rad).abs() < KEYFRAME_RAD
        };
        if self.keyframes.back().is_some_and(is_near) {
            return;
        }
        self.keyframes.push_back((pose, wall_points(scan, pose)));
        if self.keyframes.len() > KEYFRAMES {
            self.keyframes.pop_front();
        }
        self.cells.clear();
        for &point in self.keyframes.iter().flat_map(|(_, points)| points) {
            self.cells.entry(cell(point.at)).or_default().push(point);
        }
    }

    /// The nearest map point within the gate.
    fn nearest(&self, at: Point, gate_m: f64) -> Option<WallPoint> {
        let (column, row) = cell(at);
        let mut best = None;
        let mut best_m = gate_m;
        for key in (-1..=1).flat_map(|c| (-1..=1).map(move |r| (column + c, row + r))) {
            for point in self.cells.get(&key).into_iter().flatten() {
                let distance_m = point.at.distance(at);
                if distance_m < best_m {
                    (best, best_m) = (Some(*point), distance_m);
                }
            }
        }
        best
    }
}

fn cell(p: Point) -> (i64, i64) {
    ((p.x / GATE_M).floor() as i64, (p.y / GATE_M).floor() as i64)
}

/// Returns whose neighbours on both sides lie on the same wall, with the normal across the line through those.
fn wall_points(scan: &Scan, map_from_scan: Pose) -> Vec<WallPoint> {
    let beams = 1..scan.geometry().beams().saturating_sub(1);
    let wall_point = |beam: usize| {
        let (before, at, after) = (scan.point(beam - 1)?, scan.point(beam)?, scan.point(beam + 1)?);
        let across = (after - before).left();
        // Farther apart than the beams are at 60° to the wall: an edge.
        let widest_m = 0.1 + 4.0 * scan.geometry().step_rad() * at.norm();
        let is_wall = across.norm() > 0.0 && before.distance(at).max(at.distance(after)) < widest_m;
        is_wall.then(|| WallPoint {
            at: map_from_scan * at,
            normal: map_from_scan.rotate(across / across.norm()),
        })
    };
    beams.filter_map(wall_point).collect()
}
