//! What `polymapper match` says of two scans.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn sample(scan: usize) -> String {
    let log = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/killian.log.gz");
    format!("{}:{scan}", log.display())
}

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_polymapper"))
        .arg("match")
        .args(args)
        .output()
        .unwrap()
}

fn answer(args: &[&str]) -> Value {
    let output = run(args);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

fn number(hypothesis: &Value, name: &str) -> f64 {
    hypothesis[name].as_f64().unwrap()
}

/// A scan over 180° from the middle of a place with walls at these distances ahead and to both sides.
fn place(ahead_m: f64, aside_m: f64) -> String {
    let ranges: String = (-90..=90)
        .map(|deg| {
            let (sin, cos) = f64::from(deg).to_radians().sin_cos();
            let range_m = (ahead_m / cos.abs().max(1e-9)).min(aside_m / sin.abs().max(1e-9));
            format!(" {range_m:.3}")
        })
        .collect();
    format!("FLASER 181{ranges} 0 0 0 0 0 0 5.5 host 1\n")
}

#[test]
fn a_metre_and_a_turn_are_found_both_ways_round() {
    let folder = tempfile::tempdir().unwrap();
    let svg = folder.path().join("pair.svg");
    let (a, b) = (sample(270), sample(272));
    let there = answer(&[&a, &b, "--svg", &svg.display().to_string()]);
    assert_eq!(there["verdict"], "sure");
    let best = &there["hypotheses"][0];
    let (x, y, theta) = (
        number(best, "x_m"),
        number(best, "y_m"),
        number(best, "theta_rad"),
    );
    // The poses of the published graph put the second scan 0.975 m and 36.0° from the first.
    assert!((x.hypot(y) - 0.975).abs() < 0.1, "{best}");
    assert!((theta.abs().to_degrees() - 36.0).abs() < 2.0, "{best}");
    assert!(best["unobservable"].is_null() && number(best, "sigma_x_m") < 0.1);
    assert!(there["correspondences"].as_array().unwrap().len() >= 3);
    assert!(fs::read_to_string(&svg).unwrap().contains("stroke-dasharray"));

    let back = answer(&[&b, &a]);
    let back = &back["hypotheses"][0];
    let turn_back = number(back, "theta_rad");
    assert!((turn_back + theta).abs() < 0.03, "{back}");
    // b_from_a · a_from_b is the identity.
    let (sin, cos) = turn_back.sin_cos();
    assert!((number(back, "x_m") + cos * x - sin * y).abs() < 0.1);
    assert!((number(back, "y_m") + sin * x + cos * y).abs() < 0.1);
}

#[test]
fn a_corridor_is_ambiguous_and_says_along_which_way() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("corridor.log");
    fs::write(&log, place(200.0, 1.0).repeat(2)).unwrap();
    let scan = |k: usize| format!("{}:{k}", log.display());
    let answer = answer(&[&scan(0), &scan(1)]);
    assert_eq!(answer["verdict"], "ambiguous");
    let best = &answer["hypotheses"][0];
    assert!(best["unobservable"][1].as_f64().unwrap().abs() < 0.05, "{best}");
    assert!(best["sigma_x_m"].is_null());
}

#[test]
fn logs_of_one_scan_need_no_number_and_others_do() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: String| {
        let path = folder.path().join(name);
        fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    let (one, two) = (
        file("one.log", place(3.0, 2.0)),
        file("two.log", place(3.0, 2.0).repeat(2)),
    );
    let same = answer(&[&one, &one]);
    assert!(number(&same["hypotheses"][0], "x_m").abs() < 0.02, "{same}");
    for (args, expected) in [
        ([&one, &two], "two.log has more than one scan; say which"),
        (
            [&format!("{two}:2"), &one],
            "two.log has no scan 2: its 2 scans count from 0",
        ),
        (
            [&"-".to_owned(), &"-".to_owned()],
            "only one of the two scans can come from standard input",
        ),
    ] {
        let output = run(&args.map(String::as_str));
        let talk = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{talk}");
        assert!(talk.contains(expected), "{talk}");
        assert!(output.stdout.is_empty());
    }
}
