//! What a user finds after `polymapper figures`.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/killian.log.gz")
}

fn figures(log: &Path, folder: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_polymapper"))
        .arg("figures")
        .arg(log)
        .arg("-o")
        .arg(folder)
        .args(more)
        .output()
        .unwrap()
}

fn talk(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// A figure as it reads: the words of the SVG, without its marks.
fn words(folder: &Path, name: &str) -> String {
    let svg = fs::read_to_string(folder.join(name)).unwrap();
    let texts = svg.split('>').filter_map(|piece| piece.split('<').next());
    let joined: Vec<&str> = texts.map(str::trim).filter(|text| !text.is_empty()).collect();
    joined.join(" ").replace(['\u{a0}', '\u{202f}', '\u{2009}'], " ")
}

#[test]
fn the_sample_gives_the_four_figures_of_the_paper() {
    let folder = tempfile::tempdir().unwrap();
    let output = figures(&sample(), folder.path(), &["--scan", "45", "--pair", "270,272"]);
    assert_eq!(output.status.code(), Some(0), "{}", talk(&output));
    assert!(output.stdout.is_empty(), "standard output is for data");
    for name in ["fig1", "fig2", "fig3", "fig4"] {
        let png = fs::read(folder.path().join(name).with_extension("png")).unwrap();
        assert!(png.starts_with(b"\x89PNG"), "{name}");
    }
    assert!(words(folder.path(), "fig1.svg").contains("300 scans with 53 912 points"));
    let fig2 = words(folder.path(), "fig2.svg");
    assert!(fig2.contains("scan 45") && fig2.contains("DCE 15 mm"), "{fig2}");
    let fig3 = words(folder.path(), "fig3.svg");
    assert!(fig3.contains("scans 270 (green) and 272 (blue)"), "{fig3}");
    assert!(fig3.contains("(sure)"), "{fig3}");
    assert!(words(folder.path(), "fig4.svg").contains("The vertex rule"));
}

/// A closed room seen from its middle, twice over, and no odometry.
#[test]
fn what_a_log_cannot_show_is_said_and_the_rest_is_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let ranges: String = (-90..=90)
        .map(|deg| {
            let (sin, cos) = f64::from(deg).to_radians().sin_cos();
            format!(
                " {:.3}",
                (3.0 / cos.abs().max(1e-9)).min(2.0 / sin.abs().max(1e-9))
            )
        })
        .collect();
    let log = folder.path().join("still.log");
    let line = format!("FLASER 181{ranges} 0 0 0 0 0 0 5.5 host 1\n");
    fs::write(&log, line.repeat(2)).unwrap();
    let output = figures(&log, folder.path(), &[]);
    let talk = talk(&output);
    assert_eq!(output.status.code(), Some(3), "{talk}");
    assert!(talk.contains("fig3 left out: no two scans"), "{talk}");
    assert!(!folder.path().join("fig3.svg").exists());
    let fig1 = words(folder.path(), "fig1.svg");
    assert_eq!(fig1.matches("no odometry in this log").count(), 2, "{fig1}");
    assert!(folder.path().join("fig2.png").exists());
}

#[test]
fn scans_that_are_not_there_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let output = figures(&sample(), &out, &["--scan", "300"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        talk(&output).contains("has no usable scan 300: its 300 usable scans are numbered up to 299"),
        "{}",
        talk(&output)
    );
    assert!(!out.join("fig1.svg").exists());
    for wrong in ["3", "3,3", "3,x"] {
        let output = figures(&sample(), &out, &["--pair", wrong]);
        assert_eq!(output.status.code(), Some(2), "{wrong}");
    }
}
