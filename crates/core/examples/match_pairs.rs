//! How often matching finds the motion between consecutive scans of a log, and how long it takes.
//!
//! `zcat keyframes.log.gz | cargo run --release -p polymapper-core --example match_pairs -- [--list] [--ahead] [--apart N]`
//!
//! Reads CARMEN FLASER lines; the pose behind the ranges is taken as the truth to compare with and for nothing
//! else. `--list` prints a line for each pair whose best hypothesis is wrong, `--ahead` estimates that the scanner went 1 m ahead
//! instead of standing still, `--apart N` matches each keyframe with the N-th before it.

#![expect(
    clippy::disallowed_methods,
    reason = "takes the time, which the library does not"
)]

mod common;

use std::time::Instant;

use common::{Keyframe, read_keyframes};
use polymapper_core::geometry::{Pose, wrap_rad};
use polymapper_core::matching::{PoseGaussian, judged, match_polylines, unmoved};

/// What counts as the right pose.
const RIGHT: (f64, f64) = (0.25, 3.0);
/// From where least squares on whole scans finds the right pose.
const BASIN: (f64, f64) = (0.5, 10.0);

fn main() -> std::io::Result<()> {
    let words: Vec<String> = std::env::args().collect();
    let has = |name: &str| words.iter().any(|w| w == name);
    let apart: Option<usize> = words
        .windows(2)
        .find(|w| w[0] == "--apart")
        .and_then(|w| w[1].parse().ok());
    let apart = apart.unwrap_or(1).max(1);
    let mut estimate = unmoved();
    if has("--ahead") {
        estimate.mean.x = 1.0;
    }
    let keyframes = read_keyframes(std::io::stdin().lock())?;
    let mut tally = Tally::default();
    for (k, pair) in keyframes.windows(apart + 1).enumerate() {
        let line = tally.add(k, &pair[0], &pair[apart], &estimate);
        if let Some(line) = line.filter(|_| has("--list")) {
            println!("{line}");
        }
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
    /// Best hypotheses with a direction that the walls leave open, and how many of them are wrong.
    open: usize,
    open_wrong: usize,
    corresponding: usize,
    times_ms: Vec<f64>,
}

impl Tally {
    /// Matches a pair and counts it; a line about it if its best hypothesis is wrong.
    fn add(
        &mut self,
        k: usize,
        reference: &Keyframe,
        scan: &Keyframe,
        estimate: &PoseGaussian,
    ) -> Option<String> {
        let truth = reference.pose.inverse() * scan.pose;
        let start = Instant::now();
        let matching = match_polylines(&scan.polylines, &reference.polylines, estimate);
        self.times_ms.push(start.elapsed().as_secs_f64() * 1e3);
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
        let rank = poses.iter().position(|&p| within(p, BASIN));
        let open = matching
            .hypotheses
            .first()
            .is_some_and(|h| h.unobservable.is_some());
        self.pairs += 1;
        self.best_right += usize::from(right);
        self.best_basin += usize::from(rank == Some(0));
        self.any_right += usize::from(poses.iter().any(|&p| within(p, RIGHT)));
        self.any_basin += usize::from(rank.is_some());
        self.open += usize::from(open);
        self.open_wrong += usize::from(open && !right);
        self.corresponding += matching.correspondences.len();
        if right {
            return None;
        }
        let true_one = judged(&scan.polylines, &reference.polylines, estimate, truth);
        let show = |p: Pose| format!("({:.2} {:.2} {:.0}°)", p.x, p.y, p.theta_rad.to_degrees());
        Some(format!(
            "pair {k}: truth {} best {} {:.3}, true place refined {} {:.3}, rank in basin {rank:?}, open {open}",
            show(truth),
            best.map(show).unwrap_or_default(),
            matching.hypotheses.first().map_or(f64::NAN, |h| h.score),
            show(true_one.reference_from_scan),
            true_one.score,
        ))
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
        println!(
            "unobservable direction: {:.1} %, wrong among them {}",
            share(self.open),
            self.open_wrong
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
