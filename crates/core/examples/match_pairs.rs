//! How often matching finds the motion between consecutive scans of a log, and how long it takes.
//!
//! `zcat keyframes.log.gz | cargo run --release -p polymapper-core --example match_pairs [-- --list]`
//!
//! Reads CARMEN FLASER lines; the pose behind the ranges is taken as the truth to compare with and for nothing
//! else. `--list` prints a line for each pair whose best hypothesis is wrong.

mod common;

use std::time::Instant;

use common::{Keyframe, read_keyframes};
use polymapper_core::geometry::{Pose, wrap_rad};
use polymapper_core::matching::{judged, match_polylines, unmoved};

/// What counts as the right pose.
const RIGHT: (f64, f64) = (0.25, 3.0);
/// From where least squares on whole scans finds the right pose.
const BASIN: (f64, f64) = (0.5, 10.0);

fn main() -> std::io::Result<()> {
    let list = std::env::args().any(|a| a == "--list");
    let keyframes = read_keyframes(std::io::stdin().lock())?;
    let mut tally = Tally::default();
    for (k, pair) in keyframes.windows(2).enumerate() {
        tally.add(k, &pair[0], &pair[1], list);
    }
    tally.print();
    Ok(())
}

#[derive(Default)]
struct Tally {
    pairs: usize,
    best_right: usize,
    best_basin: usize,
    any_right: usize,
    any_basin: usize,
    corresponding: usize,
    times_ms: Vec<f64>,
}

impl Tally {
    fn add(&mut self, k: usize, reference: &Keyframe, scan: &Keyframe, list: bool) {
        let truth = reference.pose.inverse() * scan.pose;
        let start = Instant::now();
        let matching = match_polylines(&scan.polylines, &reference.polylines, &unmoved());
        self.times_ms.push(start.elapsed().as_secs_f64() * 1e3);
        self.pairs += 1;
        let within = |pose: Pose, (m, deg): (f64, f64)| {
            pose.distance(truth) < m && wrap_rad(pose.theta_rad - truth.theta_rad).abs().to_degrees() < deg
        };
        let poses: Vec<Pose> = matching
            .hypotheses
            .iter()
            .map(|h| h.reference_from_scan)
            .collect();
        let best = poses.first().copied();
        let right = best.is_some_and(|p| within(p, RIGHT));
        self.best_right += usize::from(right);
        self.best_basin += usize::from(best.is_some_and(|p| within(p, BASIN)));
        self.any_right += usize::from(poses.iter().any(|&p| within(p, RIGHT)));
        let rank = poses.iter().position(|&p| within(p, BASIN));
        self.any_basin += usize::from(rank.is_some());
        self.corresponding += matching.correspondences.len();
        if list && !right {
            let true_one = judged(&scan.polylines, &reference.polylines, &unmoved(), truth);
            let show = |p: Pose| format!("({:.2} {:.2} {:.0}°)", p.x, p.y, p.theta_rad.to_degrees());
            println!(
                "pair {k}: truth {} best {} {:.3}, true place refined {} {:.3}, rank in basin {rank:?}",
                show(truth),
                best.map(show).unwrap_or_default(),
                matching.hypotheses.first().map_or(f64::NAN, |h| h.score),
                show(true_one.reference_from_scan),
                true_one.score,
            );
        }
    }

    fn print(&mut self) {
        let share = |n: usize| 100.0 * n as f64 / self.pairs.max(1) as f64;
        println!(
            "{} pairs: best right {:.1} % (basin {:.1} %), any right {:.1} % (basin {:.1} %), {:.1} correspondences",
            self.pairs,
            share(self.best_right),
            share(self.best_basin),
            share(self.any_right),
            share(self.any_basin),
            self.corresponding as f64 / self.pairs.max(1) as f64,
        );
        self.times_ms.sort_by(f64::total_cmp);
        let quantile = |q: f64| {
            let place = (q * self.times_ms.len() as f64) as usize;
            self.times_ms.get(place).copied().unwrap_or(f64::NAN)
        };
        let mean = self.times_ms.iter().sum::<f64>() / self.pairs.max(1) as f64;
        println!(
            "ms a pair: mean {mean:.2}, median {:.2}, 95 % {:.2}",
            quantile(0.5),
            quantile(0.95)
        );
    }
}
