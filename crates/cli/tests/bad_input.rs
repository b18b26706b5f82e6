//! What the program says and how it exits when the input is bad or the output cannot be written.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn polymapper(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_polymapper"));
    command.args(args);
    command
}

fn run(args: &[&str]) -> Output {
    polymapper(args).output().unwrap()
}

fn talk(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn room() -> String {
    let ranges: String = (0..181)
        .map(|deg| {
            let (sin, cos) = f64::from(deg - 90).to_radians().sin_cos();
            format!(
                " {:.3}",
                (3.0 / cos.abs().max(1e-9)).min(2.0 / sin.abs().max(1e-9))
            )
        })
        .collect();
    format!("FLASER 181{ranges} 0 0 0 0 0 0 5.5 host 1\n")
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.path(name);
        fs::write(&path, content).unwrap();
        path.display().to_string()
    }
}

/// The commands that read a log refuse the log with exit code 1 and words that hold `expected`.
fn assert_refused(log: &str, expected: &str) {
    let folder = Folder::new();
    for command in ["extract", "build", "figures"] {
        let place = folder.path(command);
        let output = run(&[command, log, "-o", &place.display().to_string()]);
        let talk = talk(&output);
        assert_eq!(output.status.code(), Some(1), "{command}: {talk}");
        assert!(
            talk.starts_with("error: ") && talk.contains(expected),
            "{command}: {talk}"
        );
        assert!(!place.is_file(), "{command} left a file");
    }
}

#[test]
fn what_is_no_log_is_refused_with_its_name_and_reason() {
    let folder = Folder::new();
    let missing = folder.path("none.log").display().to_string();
    assert_refused(&missing, "none.log: no such file");
    assert_refused(
        &folder.0.path().display().to_string(),
        "is a directory; a log file is expected",
    );
    assert_refused(&folder.file("empty.log", ""), "empty.log is empty");
    assert_refused(
        &folder.file("junk.log", [0x7f, b'E', b'L', b'F', 0, 255]),
        "junk.log is no laser log",
    );
    assert_refused(
        &folder.file("broken.log.gz", [0x1f, 0x8b, 8, 0, 1, 2]),
        "broken.log.gz cannot be read",
    );
}

#[test]
fn a_log_without_scans_is_refused() {
    let folder = Folder::new();
    let output = run(&[
        "extract",
        &folder.file("odom.log", "ODOM 1 2 3 0 0 0\n".repeat(4)),
    ]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        talk(&output).contains("4 lines: no scan in it; it holds 4 ODOM"),
        "{}",
        talk(&output)
    );
    let output = run(&[
        "extract",
        &folder.file("wrong.log", room().replace("FLASER 181", "FLASER 180")),
    ]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        talk(&output).contains("line 1: 181 ranges, but the header says 180"),
        "{}",
        talk(&output)
    );
}

#[test]
fn bad_lines_cost_one_scan_each_and_exit_code_3() {
    let folder = Folder::new();
    let room = room();
    let cut = format!("{}\n", &room[..400]);
    let count = room.replace("FLASER 181", "FLASER 182");
    let odd = room.replacen(" 2.000", " 2.0.0", 1);
    let text = format!("{room}{cut}{room}{count}{odd}{room}");
    let output = run(&["extract", &folder.file("odd.log", text)]);
    let talk = talk(&output);
    assert_eq!(output.status.code(), Some(3), "{talk}");
    assert!(talk.contains("odd.log, line 2: the line is cut"), "{talk}");
    assert!(
        talk.contains("line 4: 181 ranges, but the header says 182"),
        "{talk}"
    );
    assert!(
        talk.contains("line 5: range 1 is `2.0.0`, a number is expected"),
        "{talk}"
    );
    let scans: Vec<u64> = String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(|line| {
            serde_json::from_str::<serde_json::Value>(line).unwrap()["scan"]
                .as_u64()
                .unwrap()
        })
        .collect();
    assert_eq!(scans, [0, 2, 5]);
}

#[test]
fn numbers_that_are_none_are_no_returns_and_no_fault() {
    let folder = Folder::new();
    let text = room()
        .replacen(" 2.000", " nan", 1)
        .replacen(" 2.031", " -inf", 1);
    let output = run(&["extract", &folder.file("nan.log", text)]);
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
}

#[test]
fn a_gzip_stream_that_breaks_gives_a_partial_result() {
    let folder = Folder::new();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/killian.log.gz");
    let whole = fs::read(sample).unwrap();
    let log = folder.file("cut.log.gz", &whole[..whole.len() / 2]);
    let output = run(&["extract", &log]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        talk(&output).contains("cut.log.gz breaks off after line"),
        "{}",
        talk(&output)
    );
    assert!(talk(&output).contains("the result is partial"));
    assert!(output.stdout.iter().filter(|&&b| b == b'\n').count() > 100);
}

#[test]
fn an_output_that_cannot_be_written_is_told_before_the_work() {
    let folder = Folder::new();
    let log = folder.file("room.log", room());
    let below_a_file = format!("{log}/out");
    for command in ["extract", "build", "figures"] {
        let output = run(&[command, &log, "-o", &below_a_file]);
        assert_eq!(output.status.code(), Some(1));
        let talk = talk(&output);
        assert!(
            talk.contains("cannot write") && talk.contains("room.log/out"),
            "{talk}"
        );
    }
}

#[test]
fn wrong_usage_is_exit_code_2() {
    for args in [
        &["build", "x.log"][..],
        &["extract"],
        &["extract", "x", "--vertices", "1"],
        &["nonsense"],
    ] {
        assert_eq!(run(args).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn standard_input_and_output_are_files_too() {
    let mut child = polymapper(&["extract", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(room().as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
    let line = String::from_utf8(output.stdout).unwrap();
    let record: serde_json::Value = serde_json::from_str(&line).unwrap();
    assert!(!record["polylines"].as_array().unwrap().is_empty(), "{line}");
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/killian.log.gz");
    let mut child = polymapper(&["extract", &sample.display().to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), talk(&output).as_str()), (Some(0), ""));
}
