//! Quantiles of S over true and false pairs of polylines: where the penalty C of the matching comes from.
//!
//! `zcat keyframes.log.gz | cargo run --release -p polymapper-core --example shape_quantiles`
//!
//! A pair of consecutive scans' polylines is true if 70 % of the shorter one lies on the other at the pose of the log, and false
//! if less than 10 % does.

mod common;

use common::read_keyframes;
use polymapper_core::geometry::Polyline;
use polymapper_core::shape::{Shape, similarity};

/// Distance at which two pictures of a wall are one, metres: poses are good to 5 to 12 cm.
const NEAR_M: f64 = 0.15;
/// Shorter polylines are left out, metres: at this noise of the poses they prove nothing.
const SHORTEST_M: f64 = 0.3;

fn main() -> std::io::Result<()> {
    let keyframes = read_keyframes(std::io::stdin().lock())?;
    let (mut of_true, mut of_false) = (Vec::new(), Vec::new());
    for pair in keyframes.windows(2) {
        let reference_from_scan = pair[0].pose.inverse() * pair[1].pose;
        for c in pair[1]
            .polylines
            .iter()
            .map(|p| p.transformed(reference_from_scan))
        {
            for d in &pair[0].polylines {
                let share = share_on(&c, d);
                if let Some(s) = cost_rad2(&c, d).filter(|_| c.length_m().min(d.length_m()) > SHORTEST_M) {
                    match share {
                        x if x > 0.7 => of_true.push(s),
                        x if x < 0.1 => of_false.push(s),
                        _ => {}
                    }
                }
            }
        }
    }
    print("true", of_true);
    print("false", of_false);
    Ok(())
}

fn cost_rad2(c: &Polyline, d: &Polyline) -> Option<f64> {
    Some(similarity(&Shape::new(c)?, &Shape::new(d)?, f64::INFINITY)?.cost_rad2)
}

/// Share of the shorter polyline that lies on the longer one, facing the same way.
fn share_on(a: &Polyline, b: &Polyline) -> f64 {
    let (short, long) = if a.length_m() < b.length_m() {
        (a, b)
    } else {
        (b, a)
    };
    let (mut on, mut all) = (0.0, 0.0);
    for side in short.sides() {
        let count = (side.length_m() / 0.05).ceil().max(1.0) as usize;
        for k in 0..count {
            let point = side.at((k as f64 + 0.5) / count as f64);
            let faces = |other: Option<_>| side.direction().zip(other).is_some_and(|(a, b)| a.dot(b) > 0.8);
            all += 1.0;
            on += f64::from(u8::from(
                long.sides()
                    .any(|s| s.distance(point) < NEAR_M && faces(s.direction())),
            ));
        }
    }
    on / all
}

fn print(name: &str, mut costs: Vec<f64>) {
    costs.sort_by(f64::total_cmp);
    print!("{name}, {} pairs:", costs.len());
    for percent in [5, 25, 50, 75, 90, 95, 99] {
        let place = costs.len() * percent / 100;
        print!(
            "  {percent} % {:.4}",
            costs.get(place).copied().unwrap_or(f64::NAN)
        );
    }
    println!();
}
