//! What a user finds after `polymapper build` and `polymapper demo`, on the sample log.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/killian.log.gz")
}

fn polymapper(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_polymapper"))
        .args(args)
        .output()
        .unwrap()
}

fn build(log: &Path, folder: &Path) -> Output {
    polymapper(&[
        "build",
        &log.display().to_string(),
        "-o",
        &folder.display().to_string(),
    ])
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

fn json(folder: &Path, name: &str) -> Value {
    serde_json::from_str(&read(folder, name)).unwrap()
}

#[test]
fn the_demo_leaves_every_file_and_says_where_the_picture_is() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("made/on/the/way");
    let output = polymapper(&["demo", "-o", &out.display().to_string()]);
    let talk = String::from_utf8(output.stderr).unwrap();
    let picture = out.join("map.png").display().to_string();
    assert!(talk.contains(&picture), "{talk}");
    assert!(output.stdout.is_empty(), "standard output is for data");
    assert!(fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    assert!(read(&out, "map.svg").contains("<svg"));

    let (report, map) = (json(&out, "report.json"), json(&out, "map.json"));
    let not_placed = report["scans"]["not_placed"].as_u64().unwrap();
    assert_eq!(output.status.code(), Some(if not_placed > 0 { 3 } else { 0 }));
    assert_eq!(report["scans"]["read"], 300);
    assert_eq!(
        report["map"]["polylines"],
        map["polylines"].as_array().unwrap().len()
    );
    let placed = report["scans"]["placed"].as_u64().unwrap() as usize;
    assert_eq!(read(&out, "trajectory.csv").lines().count(), 1 + 300);
    assert_eq!(read(&out, "trajectory.tum").lines().count(), placed);
    let quality = &report["quality"];
    assert!(
        quality["won"]["first"] == 1 && quality["fit_median"].as_f64() > Some(0.9),
        "{quality}"
    );
    assert_eq!(fs::read_dir(&out).unwrap().count(), 9, "no drafts are left");
}

#[test]
fn the_poses_of_the_log_are_not_read_and_the_bytes_are_the_same_twice() {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    flate2::read::MultiGzDecoder::new(fs::File::open(sample()).unwrap())
        .read_to_string(&mut text)
        .unwrap();
    let without_poses: String = text.lines().map(|line| line_without_poses(line) + "\n").collect();
    assert_ne!(text, without_poses);
    let log = folder.path().join("killian.log.gz");
    fs::write(&log, without_poses).unwrap();

    let (with, without) = (folder.path().join("with"), folder.path().join("without"));
    build(&sample(), &with);
    build(&log, &without);
    for name in ["map.json", "map.svg", "trajectory.csv", "trajectory.tum"] {
        assert!(read(&with, name) == read(&without, name), "{name} differs");
    }
    for name in ["map.png", "replay.jsonl.gz"] {
        assert!(
            fs::read(with.join(name)).unwrap() == fs::read(without.join(name)).unwrap(),
            "{name} differs"
        );
    }
}

#[test]
fn the_report_is_one_file_that_does_not_tell_where_the_log_lay() {
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (folder.path().join("killian.log.gz"), folder.path().join("out"));
    fs::copy(sample(), &log).unwrap();
    build(&log, &out);
    let page = read(&out, "report.html");
    assert!(page.contains("<title>killian.log.gz – polymapper</title>"));
    assert!(!page.contains(&folder.path().display().to_string()));
    for outside in ["http://", "https://", "src=\"", "url("] {
        let text = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!text.contains(outside), "{outside}");
    }
    assert!(page.len() < 300_000, "{} bytes", page.len());
}

#[test]
fn without_a_replay_nothing_else_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    polymapper(&[
        "build",
        "--no-replay",
        &sample().display().to_string(),
        "-o",
        &out,
    ]);
    assert!(folder.path().join("report.html").exists());
    assert!(!folder.path().join("replay.jsonl.gz").exists());
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 8);
}

/// The line with 9 in its six pose fields, which stand 14 to 9 fields before the end.
fn line_without_poses(line: &str) -> String {
    let mut fields: Vec<&str> = line.split(' ').collect();
    if fields[0] == "ROBOTLASER1" {
        let end = fields.len();
        fields[end - 14..end - 8].fill("9");
    }
    fields.join(" ")
}

#[test]
fn a_log_that_breaks_leaves_the_map_of_what_came_before_marked_partial() {
    let folder = tempfile::tempdir().unwrap();
    let whole = fs::read(sample()).unwrap();
    let log = folder.path().join("cut.log.gz");
    fs::write(&log, &whole[..whole.len() / 3]).unwrap();
    let out = folder.path().join("out");
    let output = build(&log, &out);
    assert_eq!(output.status.code(), Some(3));
    for name in ["map.json", "report.json"] {
        let partial = json(&out, name)["partial"].as_str().unwrap().to_owned();
        assert!(
            partial.contains("cut.log.gz breaks off after line"),
            "{name}: {partial}"
        );
    }
    assert!(!json(&out, "map.json")["polylines"].as_array().unwrap().is_empty());
    let rows = read(&out, "trajectory.csv").lines().count() - 1;
    assert!((50..200).contains(&rows), "{rows} rows of a third of 300 scans");
}

/// The fields of a column.
fn column(table: &str, name: &str) -> Vec<String> {
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let place = rows[0].iter().position(|field| *field == name).unwrap();
    rows[1..].iter().map(|row| row[place].to_owned()).collect()
}

#[test]
fn every_scan_of_a_simulated_log_says_how_well_it_was_placed() {
    let folder = tempfile::tempdir().unwrap();
    let (log, out) = (folder.path().join("clutter.log"), folder.path().join("out"));
    let name = log.display().to_string();
    polymapper(&["simulate", "--plan", "clutter", "--scans", "60", "-o", &name]);
    build(&log, &out);
    let table = read(&out, "trajectory.csv");
    let rows = table.lines().count() - 1;
    assert_eq!(column(&table, "won")[0], "first");
    for name in [
        "won",
        "fit",
        "known",
        "through",
        "matched",
        "rank",
        "var_x_m2",
        "cov_xy_m2",
        "var_t_rad2",
    ] {
        let known = column(&table, name)
            .iter()
            .skip(1)
            .filter(|field| !field.is_empty())
            .count();
        assert_eq!(known, rows - 1, "{name}");
    }
    let variances = column(&table, "var_x_m2")
        .into_iter()
        .chain(column(&table, "var_y_m2"));
    assert!(variances.into_iter().all(|v| v.parse::<f64>().unwrap() >= 0.0));
    let report = json(&out, "report.json");
    let won: u64 = report["quality"]["won"]
        .as_object()
        .unwrap()
        .values()
        .filter_map(Value::as_u64)
        .sum();
    assert_eq!(won, rows as u64);
}

#[test]
fn a_map_that_walls_did_not_tell_says_where_it_may_be_wrong() {
    let folder = tempfile::tempdir().unwrap();
    // Round walls, a scanner that sees 5.6 m, a metre from scan to scan; and an office seen by one that sees it all.
    for (plan, scanner, is_told) in [("oblique", "hokuyo240", false), ("office", "sick180", true)] {
        let log = folder.path().join(format!("{plan}.log"));
        let name = log.display().to_string();
        let simulate = ["simulate", "--plan", plan, "--scanner", scanner, "--seed", "3"];
        polymapper(&[&simulate[..], &["--keyframes", "--scans", "60", "-o", &name]].concat());
        let out = folder.path().join(plan);
        let talk = String::from_utf8(build(&log, &out).stderr).unwrap();
        let report = json(&out, "report.json");
        let loose = report["quality"]["loose"].as_array().unwrap();
        assert_eq!(loose.is_empty(), is_told, "{loose:?}");
        assert_eq!(talk.contains("the map may be wrong"), !is_told, "{talk}");
        for stretch in loose {
            let scan = |end: &str| stretch[end].as_u64().unwrap();
            assert!(scan("from_scan") < scan("to_scan") && scan("to_scan") < 60);
            let (sigma_m, sigma_rad) = (&stretch["sigma_m"], &stretch["sigma_rad"]);
            assert!(sigma_m.as_f64().unwrap() > 0.249 || sigma_rad.as_f64().unwrap() > 0.099);
        }
    }
}
