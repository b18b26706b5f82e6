//! What `polymapper view` shows of a log, a stream and a folder, and what `polymapper play` gives.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};
use std::time::{Duration, Instant};

fn sample() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../samples/killian.log.gz")
        .display()
        .to_string()
}

fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_polymapper"));
    command.args(args);
    command
}

/// A viewer at work; ended with the test.
struct Viewer {
    child: Child,
    talk: BufReader<ChildStderr>,
    address: String,
    /// Where scans are awaited, if they are.
    scans_at: String,
}

impl Viewer {
    fn start(source: &str) -> Self {
        Self::start_with(&[source])
    }

    /// `words`: options, and last the source.
    fn start_with(words: &[&str]) -> Self {
        let mut child = command(&[&["view", "--port", "0"], words].concat())
            .stdin(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let talk = BufReader::new(child.stderr.take().unwrap());
        let mut viewer = Self {
            child,
            talk,
            address: String::new(),
            scans_at: String::new(),
        };
        if words.iter().any(|word| word.starts_with("tcp:")) {
            let line = viewer.line_with("scans are awaited at tcp:");
            viewer.scans_at = line.trim().rsplit_once("tcp:").unwrap().1.to_owned();
        }
        let line = viewer.line_with("http://");
        viewer.address = line
            .split_once("http://")
            .and_then(|(_, rest)| rest.split_once('/'))
            .unwrap()
            .0
            .to_owned();
        viewer
    }

    /// Waits until it says something.
    fn line_with(&mut self, words: &str) -> String {
        loop {
            let mut line = String::new();
            assert!(
                self.talk.read_line(&mut line).unwrap() > 0,
                "it ended without saying {words}"
            );
            if line.contains(words) {
                return line;
            }
        }
    }

    /// Reads the record until it ends, or until it holds `wanted`.
    fn record_with(&self, wanted: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        write!(
            stream,
            "GET /record HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n",
            self.address
        )
        .unwrap();
        let (mut text, mut piece) = (String::new(), vec![0; 65536]);
        while !text.contains(wanted) {
            let n = stream.read(&mut piece).unwrap();
            assert!(n > 0, "no {wanted} in {text}");
            text += &String::from_utf8_lossy(&piece[..n]);
        }
        text
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn played(args: &[&str]) -> Vec<String> {
    let output = command(&[&["play", &sample()], args].concat()).output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout)
        .unwrap()
        .lines()
        .map(str::to_owned)
        .collect()
}

#[test]
fn a_log_is_mapped_and_shown_to_its_end() {
    let viewer = Viewer::start(&sample());
    let record = viewer.record_with("{\"end\":");
    assert_eq!(record.matches("{\"frame\":").count(), 300);
    assert!(record.contains("\"partial\":null"));
}

#[test]
fn scans_from_standard_input_are_shown_as_they_come() {
    let lines = played(&["--rate", "0"]);
    assert_eq!(lines.len(), 300);
    let mut viewer = Viewer::start("-");
    let mut input = viewer.child.stdin.take().unwrap();
    for (n, line) in lines.iter().take(3).enumerate() {
        writeln!(input, "{line}").unwrap();
        viewer.record_with(&format!("{{\"frame\":{{\"scan\":{n},"));
    }
    writeln!(input, "not a scan").unwrap();
    viewer.record_with("{\"skipped\":{\"scan\":3,\"line\":4,");
    drop(input);
    viewer.record_with("{\"end\":{\"partial\":null}}");
}

#[test]
fn scans_come_from_one_caller_after_the_other() {
    let lines = played(&["--rate", "0"]);
    let viewer = Viewer::start("tcp:0");
    let mut first = TcpStream::connect(&viewer.scans_at).unwrap();
    // The last line is cut off with the caller.
    write!(first, "{}\n{}\n{}", lines[0], lines[1], &lines[2][..40]).unwrap();
    viewer.record_with("{\"frame\":{\"scan\":1,");
    drop(first);
    let mut second = TcpStream::connect(&viewer.scans_at).unwrap();
    writeln!(second, "{}", lines[3]).unwrap();
    let record = viewer.record_with("{\"frame\":{\"scan\":3,");
    assert!(record.contains("{\"skipped\":{\"scan\":2,"), "{record}");
}

#[test]
fn a_log_is_played_at_its_pace() {
    let start = Instant::now();
    let mut child = command(&["play", &sample(), "--hz", "50"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert_eq!(lines.take(26).count(), 26);
    let took = start.elapsed();
    let _ = child.kill();
    let _ = child.wait();
    assert!(took >= Duration::from_millis(490), "{took:?}");
}

#[test]
fn what_cannot_be_shown_is_told_before_a_page_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("no.log").display().to_string();
    let empty = folder.path().display().to_string();
    std::fs::write(folder.path().join("other.txt"), "hello\n").unwrap();
    let other = folder.path().join("other.txt").display().to_string();
    for (source, words) in [
        (&missing, "no such file"),
        (&empty, "is a directory; a log file is expected"),
        (&other, "no laser log that is known here"),
    ] {
        let output = command(&["view", "--port", "0", source]).output().unwrap();
        let talk = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{talk}");
        assert!(talk.contains(words) && !talk.contains("http://"), "{talk}");
    }
}

#[test]
fn a_build_without_a_replay_shows_map_and_way_and_says_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    let built = command(&["build", "--no-replay", &sample(), "-o", &out])
        .output()
        .unwrap();
    assert!(built.status.success());
    let viewer = Viewer::start(&out);
    let record = viewer.record_with("{\"end\":");
    assert_eq!(record.matches("{\"frame\":").count(), 300);
    assert!(record.contains("\"put\":[{\"id\":"));
    assert!(record.contains("There is no replay.jsonl.gz here"), "{record}");
    std::fs::remove_file(folder.path().join("trajectory.csv")).unwrap();
    let viewer = Viewer::start(&out);
    let record = viewer.record_with("{\"end\":");
    assert!(
        record.contains("neither replay.jsonl.gz nor trajectory.csv"),
        "{record}"
    );
    assert!(record.contains("\"put\":[{\"id\":"));
}

#[test]
fn a_replay_that_breaks_off_is_shown_up_to_there() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().display().to_string();
    assert!(
        command(&["build", &sample(), "-o", &out])
            .status()
            .unwrap()
            .success()
    );
    let replay = folder.path().join("replay.jsonl.gz");
    let whole = std::fs::read(&replay).unwrap();
    std::fs::write(&replay, &whole[..whole.len() / 2]).unwrap();
    let viewer = Viewer::start(&out);
    let record = viewer.record_with("{\"end\":{\"partial\":\"the record breaks off after line");
    assert!(record.matches("{\"frame\":").count() > 50, "{record}");
}

#[test]
fn a_text_log_is_played_and_shown_by_its_layout() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("run.csv").display().to_string();
    std::fs::write(&log, "100,2000,1500,1000\n200,2000,1500,0\n").unwrap();
    let layout = "stamp_ms range_mm*3 first_deg=-90 step_deg=90";
    let output = command(&["play", &log, "--rate", "0", "--layout", layout])
        .output()
        .unwrap();
    let lines = String::from_utf8(output.stdout).unwrap();
    assert!(
        lines.starts_with("{\"ranges_m\":[2.0,1.5,1.0],\"first_bearing_rad\":-1.57"),
        "{lines}"
    );
    let viewer = Viewer::start_with(&["--layout", layout, &log]);
    viewer.record_with("{\"end\":{\"partial\":null}}");
}
