//! Finding oneself in a map, continuing it, joining two.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use flate2::read::GzDecoder;
use polymapper_core::geometry::{Pose, wrap_rad};
use polymapper_core::mapper::Quality;
use polymapper_io::out::{Outcome, read_map, read_trajectory_csv};

fn run(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_polymapper"))
        .args(args)
        .output()
        .unwrap()
}

fn done(args: &[&str]) -> String {
    let output = run(args);
    let words = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{args:?}: {words}");
    words
}

/// The laser lines of the sample.
fn sample() -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/killian.log.gz");
    let mut text = String::new();
    GzDecoder::new(fs::File::open(path).unwrap())
        .read_to_string(&mut text)
        .unwrap();
    text.lines()
        .filter(|l| l.starts_with("ROBOTLASER1"))
        .map(|l| format!("{l}\n"))
        .collect()
}

struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn name(&self, name: &str) -> String {
        self.path(name).display().to_string()
    }

    fn log<'a>(&self, name: &str, lines: impl IntoIterator<Item = &'a String>) -> String {
        let text: String = lines.into_iter().map(String::as_str).collect();
        fs::write(self.path(name), text).unwrap();
        self.name(name)
    }

    fn build(&self, log: &str, folder: &str) -> String {
        let out = self.name(folder);
        done(&["build", log, "-o", &out, "--no-replay"]);
        out
    }
}

fn poses(folder: &Path) -> Vec<Option<Pose>> {
    let rows = read_trajectory_csv(&folder.join("trajectory.csv")).unwrap();
    rows.iter()
        .map(|r| match r.outcome {
            Outcome::Placed { map_from_scan } => Some(map_from_scan),
            Outcome::NotPlaced { .. } => None,
        })
        .collect()
}

#[test]
fn scans_that_the_map_was_built_without_are_found_in_it() {
    let bench = Bench::new();
    let lines = &sample()[100..220];
    let held: Vec<usize> = (9..lines.len() - 1).step_by(10).collect();
    let rest = bench.log(
        "rest.log",
        (0..lines.len()).filter(|k| !held.contains(k)).map(|k| &lines[k]),
    );
    let alone = bench.log("held.log", held.iter().map(|&k| &lines[k]));
    let folder = bench.build(&rest, "map");
    let (map, out) = (format!("{folder}/map.json"), bench.name("found.csv"));
    let output = run(&["locate", "--map", &map, &alone, "--out", &out]);
    let table = String::from_utf8(output.stdout).unwrap();
    assert_eq!(table.lines().count(), 1 + held.len(), "{table}");
    let neighbours = poses(Path::new(&folder));
    let (mut right, mut wrong) = (0, 0);
    for row in fs::read_to_string(&out).unwrap().lines().skip(1) {
        let row: Vec<&str> = row.split(',').collect();
        let scan: usize = row[0].parse().unwrap();
        if row[2] != "located" {
            continue;
        }
        let found = Pose::new(
            row[3].parse().unwrap(),
            row[4].parse().unwrap(),
            row[5].parse().unwrap(),
        );
        // Nine of ten scans are in the map: the neighbours of the one held back.
        let (before, after) = (
            neighbours[9 * scan + 8].unwrap(),
            neighbours[9 * scan + 9].unwrap(),
        );
        let slack_m = 0.3 + before.distance(after);
        let slack_rad = 0.09 + wrap_rad(after.theta_rad - before.theta_rad).abs();
        let is_right = found.distance(before) < slack_m
            && wrap_rad(found.theta_rad - before.theta_rad).abs() < slack_rad;
        right += usize::from(is_right);
        wrong += usize::from(!is_right);
    }
    assert_eq!(wrong, 0, "{table}");
    assert!(2 * right >= held.len(), "{table}");
}

#[test]
fn two_parts_of_a_log_are_joined_where_they_overlap_and_other_places_are_refused() {
    let bench = Bench::new();
    let lines = sample();
    let first = bench.build(&bench.log("first.log", &lines[..140]), "first");
    let second_log = bench.log("second.log", &lines[60..200]);
    let second = bench.build(&second_log, "second");
    let joined = bench.name("joined");
    done(&["merge", &first, &second, "--out", &joined]);
    let both = poses(Path::new(&joined));
    assert_eq!(both.len(), 280);
    let off_m = (60..140).filter_map(|k| Some(both[k]?.distance(both[140 + k - 60]?)));
    let worst_m = off_m.fold(0.0, f64::max);
    assert!(worst_m < 0.1, "the same scan lies {worst_m} m apart");

    let quality = |folder: &str| -> Vec<Quality> {
        let rows = read_trajectory_csv(&Path::new(folder).join("trajectory.csv")).unwrap();
        rows.into_iter().map(|row| row.quality).collect()
    };
    for (after, before) in quality(&joined)
        .iter()
        .zip([quality(&first), quality(&second)].concat())
    {
        assert_eq!((after.won, after.fit), (before.won, before.fit));
        let sigma_m = |q: &Quality| q.covariance.map(|c| c.widest_m());
        let (after_m, before_m) = (sigma_m(after), sigma_m(&before));
        assert_eq!(after_m.is_some(), before_m.is_some(), "{after:?} was {before:?}");
        let off_m = after_m.zip(before_m).map_or(0.0, |(a, b)| (a - b).abs());
        assert!(off_m < 1e-3, "{after:?} was {before:?}");
    }

    let again = bench.name("again");
    done(&["merge", &first, &second, "--out", &again]);
    let read = |folder: &str, name: &str| fs::read(Path::new(folder).join(name)).unwrap();
    for name in ["map.json", "trajectory.csv", "keyframes.jsonl.gz"] {
        assert!(read(&joined, name) == read(&again, name), "{name} differs");
    }

    let words = done(&["build", "--into", &first, &second_log]);
    assert!(words.contains("joined"), "{words}");
    assert_eq!(poses(Path::new(&first)).len(), 280);

    let office = bench.name("office.log");
    done(&["simulate", "--plan", "office", "--scans", "150", "-o", &office]);
    let office_map = bench.name("office");
    run(&["build", &office, "-o", &office_map, "--no-replay"]);
    let refused = run(&["merge", &second, &office_map, "--out", &bench.name("no")]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("are not joined"));
    assert!(!bench.path("no").exists());
    let before = fs::read(Path::new(&second).join("map.json")).unwrap();
    assert_eq!(run(&["build", "--into", &second, &office]).status.code(), Some(3));
    assert!(Path::new(&second).join("apart/map.json").exists());
    assert!(before == fs::read(Path::new(&second).join("map.json")).unwrap());
}

#[test]
fn walls_and_way_are_turned_together_and_the_map_says_so() {
    let bench = Bench::new();
    let log = bench.log("part.log", &sample()[..60]);
    let plain = bench.build(&log, "plain");
    let turned = bench.name("turned");
    done(&["build", &log, "-o", &turned, "--no-replay", "--align-axes"]);
    let by_rad = read_map(&Path::new(&turned).join("map.json")).unwrap().turned_rad;
    assert!(by_rad != 0.0 && by_rad.abs() < 0.8, "{by_rad}");
    let turn = Pose::new(0.0, 0.0, by_rad);
    for (a, b) in poses(Path::new(&plain)).iter().zip(poses(Path::new(&turned))) {
        if let (Some(a), Some(b)) = (*a, b) {
            assert!((turn * a).distance(b) < 1e-3);
        }
    }
}
