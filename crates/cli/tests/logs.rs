//! The logs that people have, through the program: inspect, convert, build.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use flate2::Compression;
use flate2::write::GzEncoder;

fn polymapper(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_polymapper"))
        .args(args)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn sample() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/killian.log.gz");
    path.display().to_string()
}

fn map_of(log: &str, folder: &Path) -> String {
    let output = polymapper(&["build", log, "-o", &folder.display().to_string()]);
    assert!(
        matches!(output.status.code(), Some(0 | 3)),
        "{}",
        text(&output.stderr)
    );
    fs::read_to_string(folder.join("map.json")).unwrap()
}

#[test]
fn a_converted_carmen_log_gives_the_same_map_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let name = |path: PathBuf| path.display().to_string();
    let converted = name(place("again.log.gz"));
    let output = polymapper(&["convert", &sample(), &converted]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(
        map_of(&sample(), &place("a")) == map_of(&converted, &place("b")),
        "the maps differ"
    );
}

#[test]
fn the_handheld_recording_gives_the_same_map_from_every_format() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/small-scanners");
    if !data.exists() {
        eprintln!("skipped: no recordings beside this repository");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let given = |name: &str| data.join(name).display().to_string();
    let bag = given("urg-handheld.bag");
    let mut logs = vec![bag.clone(), given("urg-handheld-mcap"), given("urg-handheld-db3")];
    for out in ["hand.log", "hand.mcap"] {
        polymapper(&["convert", &bag, &place(out)]);
        logs.push(place(out));
    }
    let maps: Vec<String> = logs
        .iter()
        .enumerate()
        .map(|(k, log)| map_of(log, &folder.path().join(k.to_string())))
        .collect();
    for (log, map) in logs.iter().zip(&maps) {
        assert!(*map == maps[0], "{log} gives another map than {bag}");
    }
}

#[test]
fn inspect_says_what_is_in_a_log_and_what_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("x.log");
    let line = |stamp: f64| format!("FLASER 5 1 2 81.9 nan 3 0 0 0 0 0 0 {stamp} host 1\n");
    let content = format!(
        "{}{}FLASER 5 1 2\n{}ODOM 1 2 3\n",
        line(1.0),
        line(2.0),
        line(1.5)
    );
    fs::write(&log, content).unwrap();
    let output = polymapper(&["inspect", &log.display().to_string()]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(3), "{said}");
    for expected in [
        "scans       3 of FLASER",
        "no return   81.9 (3), nan (3)",
        "1 run backwards, by 0.500 s at most",
        "left out    1 scans; the first:",
        "line 3: the line is cut",
        "not used    1 ODOM: no scans",
    ] {
        assert!(said.contains(expected), "no `{expected}` in:\n{said}");
    }
    let output = polymapper(&["inspect", "--json", &log.display().to_string()]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(
        (json["scans"].as_u64(), json["stamps"]["backwards"].as_u64()),
        (Some(3), Some(1))
    );
}

#[test]
fn scans_without_stamps_follow_each_other_in_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let rows = "# layout: range_m*3 first_deg=-90 step_deg=90\n".to_owned() + &"1,2,3\n".repeat(4);
    fs::write(place("x.csv"), rows).unwrap();
    let output = polymapper(&["convert", &place("x.csv"), &place("x.mcap")]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let said = text(&polymapper(&["inspect", &place("x.mcap")]).stdout);
    assert!(said.contains("stamps      0.000 to 0.300 s, 10.0 Hz"), "{said}");
}

#[test]
fn a_csv_file_needs_its_bearings_told() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("x.csv");
    let rows = format!("{}\n", ["2.5"; 20].join(",")).repeat(3);
    fs::write(&log, rows).unwrap();
    let log = log.display().to_string();
    let output = polymapper(&["inspect", &log]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        text(&output.stderr).contains("--layout"),
        "{}",
        text(&output.stderr)
    );
    let layout = "range_m* first_deg=-45 step_deg=4.5";
    let output = polymapper(&["inspect", &log, "--layout", layout]);
    assert!(
        text(&output.stdout).contains("20 beams from -45.00° to 40.50°"),
        "{}",
        text(&output.stdout)
    );
    let output = polymapper(&["inspect", &log, "--layout", "ranges"]);
    assert_eq!(
        output.status.code(),
        Some(2),
        "a layout that is none is wrong usage"
    );
}

#[test]
fn standard_input_is_unpacked_too() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_polymapper"))
        .args(["inspect", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(&fs::read(sample()).unwrap())
        .unwrap();
    let said = text(&child.wait_with_output().unwrap().stdout);
    assert!(said.starts_with("standard input: CARMEN, gzip"), "{said}");
}

#[test]
fn a_zip_bomb_costs_no_memory() {
    let folder = tempfile::tempdir().unwrap();
    let bomb = |name: &str, start: &[u8]| {
        let mut packed = GzEncoder::new(Vec::new(), Compression::best());
        packed.write_all(start).unwrap();
        let zeros = vec![b'0'; 1 << 20];
        for _ in 0..300 {
            packed.write_all(&zeros).unwrap();
        }
        let path = folder.path().join(name);
        fs::write(&path, packed.finish().unwrap()).unwrap();
        path.display().to_string()
    };
    let starts: [(&str, &[u8]); 4] = [
        ("text", b"FLASER 3 "),
        ("bag", b"#ROSBAG V2.0\n"),
        ("mcap", b"\x89MCAP0\r\n\x05\xff\xff\xff\xff\0\0\0\0"),
        ("rawlog", b"\x8dCSensoryFrame\x02"),
    ];
    for (name, start) in starts {
        let output = Command::new("sh")
            .args(["-c", "ulimit -v 400000; exec \"$0\" inspect \"$1\""])
            .args([env!("CARGO_BIN_EXE_polymapper"), &bomb(name, start)])
            .output()
            .unwrap();
        let said = text(&output.stderr);
        if name == "text" {
            // One line that is too long is one scan left out.
            assert_eq!(output.status.code(), Some(3), "{said}");
            assert!(text(&output.stdout).contains("the line is longer than 1048576 bytes"));
            continue;
        }
        assert_eq!(output.status.code(), Some(1), "{name}: {said}");
        assert!(
            said.starts_with("error: ") && said.contains(name),
            "{name}: {said}"
        );
    }
}
