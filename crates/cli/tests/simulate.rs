//! A simulated log goes in where a real one does.

use std::fs;
use std::process::Command;

#[test]
fn every_scanner_writes_a_log_that_is_read_whole() {
    let folder = tempfile::tempdir().unwrap();
    for scanner in ["sick180", "hokuyo240", "lowcost360"] {
        let place = |name: &str| {
            folder
                .path()
                .join(format!("{scanner}{name}"))
                .display()
                .to_string()
        };
        let polymapper = |args: &[&str]| {
            let output = Command::new(env!("CARGO_BIN_EXE_polymapper"))
                .args(args)
                .output()
                .unwrap();
            assert_eq!(
                output.status.code(),
                Some(0),
                "{}",
                String::from_utf8_lossy(&output.stderr)
            );
        };
        let log = place(".log.gz");
        polymapper(&[
            "simulate",
            "--plan",
            "clutter",
            "--scanner",
            scanner,
            "--scans",
            "20",
            "-o",
            &log,
        ]);
        polymapper(&["extract", &log, "-o", &place(".jsonl")]);
        assert_eq!(
            fs::read_to_string(place(".jsonl")).unwrap().lines().count(),
            20,
            "{scanner}"
        );
        let truth = fs::read_to_string(place(".truth.json")).unwrap();
        let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
        assert_eq!(truth["poses"].as_array().unwrap().len(), 20, "{scanner}");
    }
}
