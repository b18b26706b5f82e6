//! Throw-away driver.
use polymapper_core::{
    mapper::{Mapper, Outcome, Settings},
    scan::{Scan, ScanGeometry},
};
use std::io::{BufRead, Write};
fn main() {
    let out = std::env::args().nth(1).expect("out dir");
    let limit: usize = std::env::args()
        .nth(2)
        .and_then(|s| s.parse().ok())
        .unwrap_or(usize::MAX);
    std::fs::create_dir_all(&out).expect("out");
    let mut mapper = Mapper::new(Settings::default());
    let mut n = 0;
    let mut notes = String::new();
    let t0 = std::time::Instant::now();
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("utf8");
        let t: Vec<&str> = line.split_whitespace().collect();
        if t.is_empty() {
            continue;
        }
        let f = |k: usize| t[k].parse::<f64>().unwrap_or(f64::NAN);
        let (geometry, first) = match t[0] {
            "FLASER" => {
                let n = f(1) as usize;
                let step = if n >= 359 { 0.5_f64 } else { 1.0 }.to_radians();
                (ScanGeometry::new(-std::f64::consts::FRAC_PI_2, step, n), (2, n))
            }
            "ROBOTLASER1" => {
                let n = f(8) as usize;
                (
                    ScanGeometry::new(f(2), f(4), n).map(|g| g.with_limits(0.02, f(5))),
                    (9, n),
                )
            }
            _ => continue,
        };
        let Ok(g) = geometry else { continue };
        let ranges: Vec<f64> = (first.0..first.0 + first.1).map(f).collect();
        let Ok(scan) = Scan::new(g, ranges) else { continue };
        let step = mapper.add_scan(&scan, None);
        if let Some(a) = step.alignment {
            let g = step.agreement.unwrap_or_default();
            notes += &format!(
                "{} share {:.2} rms {:.3} rounds {} unobs {} fit {:.2} known {:.2} through {} short {} vertices {} noise {:.4} merged {}\n",
                step.scan,
                a.matched_share(),
                a.rms_m,
                a.rounds,
                a.unobservable.is_some(),
                g.fit(),
                g.known_share(),
                g.through,
                g.short,
                step.extraction.vertices(),
                step.extraction.noise_m,
                step.merged.is_some()
            );
        }
        if let Some(r) = step.recognised {
            notes += &format!("{} recognised {r}\n", step.scan);
        }
        n += 1;
        if n >= limit {
            break;
        }
    }
    let dt = t0.elapsed().as_secs_f64();
    let t1 = std::time::Instant::now();
    let mut csv = String::from("scan,stamp_s,x_m,y_m,theta_rad,outcome\n");
    let mut lost = 0;
    for (k, o) in mapper.outcomes().iter().enumerate() {
        match o {
            Outcome::Placed { map_from_scan: p } => {
                csv += &format!("{k},0,{},{},{},placed\n", p.x, p.y, p.theta_rad)
            }
            Outcome::NotPlaced { .. } => {
                lost += 1;
                csv += &format!("{k},0,,,,not_placed\n")
            }
        }
    }
    let map = mapper.map();
    let lines: Vec<String> = map
        .polylines
        .iter()
        .map(|p| {
            let v: Vec<String> = p
                .vertices
                .iter()
                .map(|v| format!("[{:.4},{:.4}]", v.point.x, v.point.y))
                .collect();
            format!("{{\"id\":{},\"vertices\":[{}]}}", p.id, v.join(","))
        })
        .collect();
    std::fs::File::create(format!("{out}/map.json"))
        .and_then(|mut f| write!(f, "{{\"polylines\":[{}]}}", lines.join(",\n")))
        .expect("map");
    std::fs::write(format!("{out}/trajectory.csv"), csv).expect("csv");
    std::fs::write(format!("{out}/notes.txt"), notes).expect("notes");
    println!("{} boxes", map.eraser_boxes.len());
    println!("final {:.3} s", t1.elapsed().as_secs_f64());
    println!(
        "{n} scans, {lost} lost, {:.3} ms a scan, {} polylines, {} vertices",
        dt * 1e3 / n as f64,
        map.polylines.len(),
        map.polylines.iter().map(|p| p.vertices.len()).sum::<usize>()
    );
}
