//! Throw-away.
use polymapper_core::{
    mapper::{Mapper, Outcome, Settings},
    scan::{Scan, ScanGeometry},
};
use std::io::BufRead;
fn main() {
    let mut mapper = Mapper::new(Settings::default());
    for line in std::io::stdin().lock().lines() {
        let line = line.expect("utf8");
        let t: Vec<&str> = line.split_whitespace().collect();
        if t.is_empty() || t[0] != "FLASER" {
            continue;
        }
        let f = |k: usize| t[k].parse::<f64>().unwrap_or(f64::NAN);
        let beams = f(1) as usize;
        let step = if beams >= 359 { 0.5_f64 } else { 1.0 }.to_radians();
        let g = ScanGeometry::new(-std::f64::consts::FRAC_PI_2, step, beams).unwrap();
        let ranges: Vec<f64> = (2..2 + beams)
            .map(f)
            .map(|r| if r > 50.0 { f64::NAN } else { r })
            .collect();
        mapper.add_scan(&Scan::new(g, ranges).unwrap(), None);
    }
    let a: Vec<String> = std::env::args().skip(1).collect();
    let prefix = &a[0];
    for (i, knobs) in a[1..].iter().enumerate() {
        let mut m = &mut mapper;
        let t = std::time::Instant::now();
        if knobs != "none" {
            m.settle();
        }
        let settle = t.elapsed();
        let t = std::time::Instant::now();
        let mut csv = String::from("scan,stamp_s,x_m,y_m,theta_rad,outcome\n");
        for (k, o) in m.outcomes().iter().enumerate() {
            match *o {
                Outcome::Placed { map_from_scan: p } => {
                    csv += &format!("{k},0,{},{},{},placed\n", p.x, p.y, p.theta_rad)
                }
                _ => csv += &format!("{k},0,,,,not_placed\n"),
            }
        }
        std::fs::write(format!("{prefix}-{i}.csv"), csv).unwrap();
        let map = m.map();
        let lines: Vec<String> = map
            .polylines
            .iter()
            .map(|p| {
                let v: Vec<String> = p
                    .vertices
                    .iter()
                    .map(|v| format!("[{:.4},{:.4}]", v.point.x, v.point.y))
                    .collect();
                format!("{{\"vertices\":[{}]}}", v.join(","))
            })
            .collect();
        std::fs::write(
            format!("{prefix}-{i}.json"),
            format!("{{\"polylines\":[{}]}}", lines.join(",")),
        )
        .unwrap();
        eprintln!("{i} {knobs} settle {settle:?} map {:?}", t.elapsed());
    }
}
