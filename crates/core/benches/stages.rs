//! Time of every stage of the pipeline, on simulated scans of an office.
//!
//! `cargo bench -p polymapper-core` (with `-- --quick`: in half a minute). Two scans 1 m apart stand for the pairs
//! of a log; the whole pipeline gets the first 300 scans of a tour at 10 Hz.

use std::hint::black_box;

use criterion::{Criterion, Throughput};
use polymapper_core::align::{AlignSettings, Guess, SidePoint, align};
use polymapper_core::extract::{ExtractSettings, Extraction, extract, extract_with_budget};
use polymapper_core::geometry::{Polyline, Pose};
use polymapper_core::mapper::{Mapper, Settings};
use polymapper_core::matching::{match_polylines, unmoved};
use polymapper_core::scan::Scan;
use polymapper_core::shape::{Shape, similarity};
use polymapper_sim::{Motion, PlanKind, Scanner, ScannerKind, SimError, SimLog, SimSettings, simulate};

/// Vertices of a scan in the paper's examples.
const BUDGET: usize = 20;
/// Scans that the whole pipeline gets.
const SCANS: usize = 300;

fn main() -> Result<(), SimError> {
    let mut criterion = Criterion::default().configure_from_args();
    for kind in ScannerKind::ALL {
        let pair = Pair::of(&tour(kind, Motion::keyframes(), 20)?);
        extraction(&mut criterion, kind, &pair);
        shapes(&mut criterion, kind, &pair);
        matching(&mut criterion, kind, &pair);
        alignment(&mut criterion, kind, &pair);
        pipeline(&mut criterion, kind, &tour(kind, Motion::full_rate(), SCANS)?);
    }
    criterion.final_summary();
    Ok(())
}

fn tour(kind: ScannerKind, motion: Motion, max_scans: usize) -> Result<SimLog, SimError> {
    simulate(&SimSettings {
        scanner: Scanner::new(kind),
        motion: Motion { max_scans, ..motion },
        ..SimSettings::new(PlanKind::Office, 1)
    })
}

/// Two scans, the second about 1 m from the first.
struct Pair {
    scan: Scan,
    extraction: Extraction,
    polylines: [Vec<Polyline>; 2],
    first_from_second: Pose,
}

impl Pair {
    fn of(log: &SimLog) -> Self {
        let at = log.scans.len() / 2;
        let extractions = [at - 1, at].map(|k| extract(&log.scans[k], &ExtractSettings::default()));
        let polylines = extractions
            .each_ref()
            .map(|e| e.polylines.iter().map(|p| p.polyline.clone()).collect());
        let [_, extraction] = extractions;
        Self {
            scan: log.scans[at].clone(),
            extraction,
            polylines,
            first_from_second: log.truth_poses[at - 1].inverse() * log.truth_poses[at],
        }
    }

    /// The returns of the second scan with the sides they lie on.
    fn side_points(&self) -> Vec<SidePoint> {
        let sides: Vec<_> = (0..)
            .zip(&self.polylines[1])
            .flat_map(|(owner, p)| p.sides().map(move |side| (owner, side)))
            .collect();
        let on_side = |(_, point)| {
            let distance = |s: &(u32, polymapper_core::geometry::Segment)| s.1.distance(point);
            let (polyline, side) = sides.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            Some(SidePoint {
                point,
                direction: side.direction()?,
                sigma_m: self.extraction.noise_m,
                worth: 1.0,
                is_on_short_side: false,
                polyline: *polyline,
            })
        };
        self.scan.points().filter_map(on_side).collect()
    }
}

fn extraction(criterion: &mut Criterion, kind: ScannerKind, pair: &Pair) {
    let settings = ExtractSettings::default();
    criterion.bench_function(&format!("extract, by noise/{kind}"), |b| {
        b.iter(|| extract(black_box(&pair.scan), &settings));
    });
    criterion.bench_function(&format!("extract, {BUDGET} vertices/{kind}"), |b| {
        b.iter(|| extract_with_budget(black_box(&pair.scan), BUDGET, &settings));
    });
}

fn shapes(criterion: &mut Criterion, kind: ScannerKind, pair: &Pair) {
    let [Some(first), Some(second)] = pair.polylines.each_ref().map(Shape::joined) else {
        return;
    };
    criterion.bench_function(&format!("similarity of two scans/{kind}"), |b| {
        b.iter(|| similarity(black_box(&first), black_box(&second), f64::INFINITY));
    });
}

fn matching(criterion: &mut Criterion, kind: ScannerKind, pair: &Pair) {
    let [first, second] = &pair.polylines;
    criterion.bench_function(&format!("match two scans/{kind}"), |b| {
        b.iter(|| match_polylines(black_box(second), black_box(first), &unmoved()));
    });
}

fn alignment(criterion: &mut Criterion, kind: ScannerKind, pair: &Pair) {
    let points = pair.side_points();
    let off = Pose::new(0.1, -0.05, 0.03);
    let guess = Guess {
        map_from_scan: pair.first_from_second * off,
        sigma_m: 0.1,
        sigma_rad: 0.05,
    };
    criterion.bench_function(&format!("align/{kind}"), |b| {
        b.iter(|| {
            align(
                black_box(&points),
                &pair.polylines[0],
                None,
                &guess,
                None,
                &AlignSettings::default(),
            )
        });
    });
}

/// Placing and merging scan by scan, and merging all keyframes anew into the map that is handed out.
fn pipeline(criterion: &mut Criterion, kind: ScannerKind, log: &SimLog) {
    let build = || {
        let mut mapper = Mapper::new(Settings::default());
        for scan in &log.scans {
            mapper.add_scan(scan, None);
        }
        mapper
    };
    let mut group = criterion.benchmark_group("pipeline");
    group.sample_size(10);
    group.throughput(Throughput::Elements(log.scans.len() as u64));
    group.bench_function(format!("add {SCANS} scans/{kind}"), |b| b.iter(build));
    let mapper = build();
    group.bench_function(format!("map of {SCANS} scans/{kind}"), |b| {
        b.iter(|| mapper.map());
    });
    group.finish();
}
