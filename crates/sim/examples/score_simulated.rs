//! Builds maps of simulated logs and prints how good they are, a line a log.
//!
//! `score_simulated PLANS SCANNERS MOTIONS PEOPLE SEEDS`: lists separated by commas, or `all`; motions are `full` and
//! `keyframes`. The columns:
//!
//! - `lost`: scans that were not placed;
//! - `P5`, `R5`, `F5`, `F2`, `double%`, `people%`: the map, see [`polymapper_sim::MapScore`];
//! - `mean`, `max`: how far the placed scans are off, metres, and `turn`, the most, degrees, after the best fit;
//! - `jump@scan`: the largest error of the motion from one placed scan to the next, metres, and where it was made:
//!   where a map begins to go wrong;
//! - `off@scan`: the first such error above 0.3 m;
//! - `loops`: places that were recognised, and how many of them wrongly (more than 0.5 m off against each other);
//! - `ms`: time a scan takes;
//! - `wrong`: the first place that was recognised wrongly: scan > old scan, and how far they truly are apart, metres.

use std::process::ExitCode;
use std::str::FromStr;
use std::time::Instant;

use polymapper_core::geometry::{Polyline, Pose, wrap_rad};
use polymapper_core::map::MapPolyline;
use polymapper_core::mapper::{Mapper, Outcome, Settings};
use polymapper_sim::{
    Motion, PlanKind, Scanner, ScannerKind, SimLog, SimSettings, fit_trajectory, score_map, simulate,
    trajectory_error,
};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[String]) -> Result<(), Box<dyn std::error::Error>> {
    let [plans, scanners, motions, people, seeds] = arguments else {
        return Err("usage: score_simulated PLANS SCANNERS MOTIONS PEOPLE SEEDS".into());
    };
    println!(
        "plan          scanner    motion    people seed scans lost    P5    R5    F5    F2 double% people%  mean    max  turn jump@scan     off@scan      loops    ms wrong"
    );
    for plan in list(plans, &PlanKind::ALL)? {
        for kind in list(scanners, &ScannerKind::ALL)? {
            for motion in list(motions, &["full".to_owned(), "keyframes".to_owned()])? {
                for people in list::<usize>(people, &[0, 3])? {
                    for seed in list(seeds, &[1, 2, 3])? {
                        let settings = SimSettings {
                            scanner: Scanner::new(kind),
                            motion: match motion.as_str() {
                                "full" => Motion::full_rate(),
                                "keyframes" => Motion::keyframes(),
                                _ => return Err(format!("no motion {motion:?}").into()),
                            },
                            people,
                            ..SimSettings::new(plan, seed)
                        };
                        print!("{plan:13} {kind:10} {motion:9} {people:6} {seed:4} ");
                        println!("{}", Row::measure(&simulate(&settings)?));
                    }
                }
            }
        }
    }
    Ok(())
}

fn list<T: FromStr + Clone>(text: &str, all: &[T]) -> Result<Vec<T>, T::Err> {
    if text == "all" {
        return Ok(all.to_vec());
    }
    text.split(',').map(str::parse).collect()
}

/// A line of the table.
struct Row(String);

impl std::fmt::Display for Row {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl Row {
    /// Builds the map of a log and measures it.
    fn measure(log: &SimLog) -> Self {
        let mut mapper = Mapper::new(Settings::default());
        let (mut loops, mut wrong, mut first_wrong) = (0, 0, String::new());
        let started = Instant::now();
        for scan in &log.scans {
            let step = mapper.add_scan(scan, None);
            if let Some(old) = step.recognised {
                loops += 1;
                let outcomes = mapper.outcomes();
                let off_m = placed_pose(&outcomes, old)
                    .zip(placed_pose(&outcomes, step.scan))
                    .map_or(0.0, |(a, b)| motion_error_m(log, (old, a), (step.scan, b)));
                if off_m > 0.5 {
                    if wrong == 0 {
                        let truly_m = log.truth_poses[old].distance(log.truth_poses[step.scan]);
                        first_wrong = format!("{} > {old}, {truly_m:.1} m", step.scan);
                    }
                    wrong += 1;
                }
            }
        }
        mapper.settle();
        let map = mapper.map();
        let ms = started.elapsed().as_secs_f64() * 1e3 / log.scans.len() as f64;
        let outcomes = mapper.outcomes();
        let placed: Vec<(usize, Pose)> = (0..outcomes.len())
            .filter_map(|scan| Some((scan, placed_pose(&outcomes, scan)?)))
            .collect();
        let world_from_map = fit_trajectory(&placed, &log.truth_poses).unwrap_or(Pose::IDENTITY);
        let error = trajectory_error(&placed, &log.truth_poses, world_from_map);
        let (mean_m, max_m, turn_deg) = error.map_or((f64::NAN, f64::NAN, f64::NAN), |e| {
            (
                e.mean_translation_m,
                e.max_translation_m,
                e.max_rotation_rad.to_degrees(),
            )
        });
        let walls: Vec<Polyline> = map.polylines.iter().filter_map(MapPolyline::polyline).collect();
        let score = score_map(&walls, world_from_map, &log.map_truth());
        let jumps = jumps(log, &placed);
        let jump = told(jumps.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)));
        let off = told(jumps.iter().copied().find(|j| j.0 > 0.3));
        Self(format!(
            "{:5} {:4} {:.3} {:.3} {:.3} {:.3} {:7.1} {:7.1} {mean_m:5.3} {max_m:6.3} {turn_deg:5.2} {jump:13} {off:13} {loops:3}/{wrong:<2} {ms:5.1} {first_wrong}",
            log.scans.len(),
            log.scans.len() - placed.len(),
            score.within_5cm.precision_ratio,
            score.within_5cm.recall_ratio,
            score.within_5cm.f_score(),
            score.within_2cm.f_score(),
            100.0 * score.doubled_ratio,
            100.0 * score.people_ratio,
        ))
    }
}

fn placed_pose(outcomes: &[Outcome], scan: usize) -> Option<Pose> {
    match outcomes.get(scan)? {
        Outcome::Placed { map_from_scan } => Some(*map_from_scan),
        Outcome::NotPlaced { .. } => None,
    }
}

/// How much the motion between two placed scans is off, metres; a radian counts as a metre.
fn motion_error_m(log: &SimLog, (a, map_from_a): (usize, Pose), (b, map_from_b): (usize, Pose)) -> f64 {
    let true_motion = log.truth_poses[a].inverse() * log.truth_poses[b];
    let motion = map_from_a.inverse() * map_from_b;
    motion.distance(true_motion) + wrap_rad(motion.theta_rad - true_motion.theta_rad).abs()
}

/// The error of every motion from one placed scan to the next, and the scan it was made at.
fn jumps(log: &SimLog, placed: &[(usize, Pose)]) -> Vec<(f64, usize)> {
    placed
        .windows(2)
        .map(|pair| (motion_error_m(log, pair[0], pair[1]), pair[1].0))
        .collect()
}

fn told(jump: Option<(f64, usize)>) -> String {
    jump.map_or("-".to_owned(), |(off_m, scan)| format!("{off_m:.3}@{scan}"))
}
