//! What a user meets when reading CARMEN logs: whole ones, odd ones, broken ones.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use polymapper_core::geometry::Pose;
use polymapper_io::log::{self, Entry, Log, LogError, LogScan, ReadOptions};

fn file(folder: &Path, name: &str, content: &[u8]) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, content).unwrap();
    path
}

fn gzip(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

/// `count` ranges of 2 m, beam k 1 mm longer than beam k−1.
fn ranges(count: usize) -> String {
    (0..count)
        .map(|k| format!(" {:.3}", 2.0 + k as f64 / 1e3))
        .collect()
}

fn flaser(header: usize, count: usize) -> String {
    format!(
        "FLASER {header}{} 1 2 0.3 4 5 0.6 1234.5 host 7.8\n",
        ranges(count)
    )
}

fn robotlaser(start: f64, step: f64, count: usize) -> String {
    format!(
        "ROBOTLASER1 0 {start} 3.14159 {step} 81.9 0.01 0 {count}{} 0 1 2 0.3 4 5 0.6 0 0 0 0 0 99.5 host 7.8\n",
        ranges(count)
    )
}

fn open_text(text: &str, options: ReadOptions) -> Log {
    let folder = tempfile::tempdir().unwrap();
    log::open(&file(folder.path(), "test.log", text.as_bytes()), options).unwrap()
}

fn entries(text: &str) -> Vec<Entry> {
    open_text(text, ReadOptions::default())
        .collect::<Result<_, _>>()
        .unwrap()
}

fn scans(text: &str) -> Vec<LogScan> {
    let scan = |entry| match entry {
        Entry::Scan(scan) => scan,
        Entry::Bad(bad) => panic!("line {}: {}", bad.line, bad.fault),
    };
    entries(text).into_iter().map(scan).collect()
}

/// The fault of the second line, which stands between two good ones.
fn fault_of(line: &str) -> String {
    let got = entries(&format!("{}{line}{}", flaser(181, 181), flaser(181, 181)));
    let [Entry::Scan(first), Entry::Bad(bad), Entry::Scan(last)] = &got[..] else {
        panic!("expected good, bad, good, got {got:?}");
    };
    assert_eq!((first.index, bad.index, last.index), (0, 1, 2));
    assert_eq!(bad.line, 2);
    bad.fault.to_string()
}

#[test]
fn a_byte_order_mark_costs_no_scan() {
    let folder = tempfile::tempdir().unwrap();
    let columns = "# layout: range_m*3 first_deg=-90 step_deg=90\n1,2,3\n";
    let json = "{\"ranges_m\": [1, 2, 3]}\n";
    for text in [flaser(5, 5).as_str(), columns, json] {
        let marked = format!("\u{feff}{text}");
        let path = file(folder.path(), "marked", marked.as_bytes());
        let scans = log::open(&path, ReadOptions::default()).unwrap().count();
        let stream = std::io::Cursor::new(marked);
        let live = log::open_live("stream", stream, ReadOptions::default()).unwrap();
        assert_eq!((scans, live.count()), (1, 1), "{text}");
    }
}

#[test]
fn the_beam_count_tells_the_bearings() {
    for (beams, first_deg, last_deg) in [
        (180, -90.0, 89.0),
        (181, -90.0, 90.0),
        (360, -90.0, 89.5),
        (361, -90.0, 90.0),
        (91, -90.0, 90.0),
    ] {
        let scans = scans(&flaser(beams, beams));
        let geometry = scans[0].scan.geometry();
        assert!(
            (geometry.bearing_rad(0).to_degrees() - first_deg).abs() < 1e-9,
            "{beams} beams"
        );
        assert!(
            (geometry.bearing_rad(beams - 1).to_degrees() - last_deg).abs() < 1e-9,
            "{beams} beams"
        );
    }
}

#[test]
fn a_guessed_geometry_is_said_once() {
    let mut log = open_text(&flaser(91, 91).repeat(3), ReadOptions::default());
    assert_eq!(log.by_ref().count(), 3);
    assert_eq!(
        log.tally().notes,
        ["91 beams a scan and no geometry in the log: taken as 180°, a beam every 2.0000°"]
    );
}

#[test]
fn the_geometry_of_a_line_may_differ_from_the_line_before() {
    let scans = scans(&(robotlaser(-1.5, 0.02, 5) + &robotlaser(-1.4, 0.01, 4)));
    let bearings: Vec<f64> = scans.iter().map(|s| s.scan.geometry().bearing_rad(1)).collect();
    assert!((bearings[0] + 1.48).abs() < 1e-9 && (bearings[1] + 1.39).abs() < 1e-9);
    assert_eq!(scans[1].stamp_s, Some(99.5));
}

#[test]
fn a_clockwise_scanner_is_turned_round() {
    let scans = scans(&robotlaser(1.0, -0.5, 5));
    let scan = &scans[0].scan;
    assert!((scan.geometry().bearing_rad(0) + 1.0).abs() < 1e-9);
    assert!(
        (scan.ranges_m()[4] - 2.0).abs() < 1e-9,
        "the beam at 1 rad was read first"
    );
}

#[test]
fn odometry_is_handed_out_only_when_asked_for() {
    let text = flaser(181, 181);
    assert_eq!(scans(&text)[0].odometry, None);
    let asked = ReadOptions {
        use_odometry: true,
        ..ReadOptions::default()
    };
    let entry = open_text(&text, asked).next().unwrap().unwrap();
    let Entry::Scan(scan) = entry else {
        panic!("{entry:?}")
    };
    assert_eq!(scan.odometry, Some(Pose::new(4.0, 5.0, 0.6)));
    assert_eq!(scan.stamp_s, Some(1234.5));
}

#[test]
fn a_line_may_end_with_the_poses_and_hold_non_numbers() {
    let scans = scans("FLASER 4 nan Inf 1.5 -nan(ind) 0 0 0 0 0 0\n");
    assert_eq!(scans[0].stamp_s, None);
    assert_eq!(
        scans[0].scan.points().map(|(beam, _)| beam).collect::<Vec<_>>(),
        [2]
    );
}

#[test]
fn the_front_laser_is_read_and_the_rest_counted() {
    let text = format!(
        "# head\nODOM 1 2 3\nR{}{}ODOM 1 2 3\n",
        flaser(5, 5),
        flaser(7, 7)
    );
    let text = text.replace("RFLASER", "RLASER");
    let mut log = open_text(&text, ReadOptions::default());
    assert_eq!(log.by_ref().count(), 1);
    let tally = log.tally();
    assert_eq!(tally.laser.as_deref(), Some("FLASER"));
    assert_eq!(
        (tally.other_messages["ODOM"], tally.other_messages["RLASER"]),
        (2, 1)
    );

    let rear = ReadOptions {
        laser: Some("RLASER".to_owned()),
        ..ReadOptions::default()
    };
    let entry = open_text(&text, rear).next().unwrap().unwrap();
    let Entry::Scan(scan) = entry else {
        panic!("{entry:?}")
    };
    assert_eq!((scan.scan.geometry().beams(), scan.line), (5, 3));
}

#[test]
fn a_header_that_does_not_fit_names_both_numbers() {
    for (header, count) in [
        (181, 180),
        (182, 180),
        (187, 180),
        (250, 180),
        (180, 181),
        (178, 181),
        (90, 181),
    ] {
        let expected = format!("{count} ranges, but the header says {header}");
        assert_eq!(fault_of(&flaser(header, count)), expected);
    }
    let text = robotlaser(-1.5, 0.01, 180).replacen(" 180 ", " 181 ", 1);
    assert_eq!(fault_in(&text), "180 ranges, but the header says 181");
}

/// The fault of a lone line.
fn fault_in(line: &str) -> String {
    match &entries(line)[..] {
        [Entry::Bad(bad)] => bad.fault.to_string(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_header_that_does_not_fit_is_seen_without_a_host_name_too() {
    let bare = |header: usize, count: usize| format!("FLASER {header}{} 1 2 0.3 4 5 0.6\n", ranges(count));
    let got = entries(&(bare(181, 181) + &bare(180, 181) + &bare(182, 181) + &bare(181, 181)));
    let bad: Vec<usize> = got
        .iter()
        .filter_map(|e| match e {
            Entry::Bad(bad) => Some(bad.index),
            Entry::Scan(_) => None,
        })
        .collect();
    assert_eq!(bad, [1, 2]);
}

#[test]
fn a_cut_line_costs_one_scan() {
    let whole = flaser(181, 181);
    for share in [0.3, 0.9, 0.97] {
        let cut = &whole[..(whole.len() as f64 * share) as usize];
        let fault = fault_of(&format!("{cut}\n"));
        assert!(
            fault.starts_with("the line is cut") && fault.contains("181 ranges"),
            "{fault}"
        );
    }
}

#[test]
fn a_field_that_is_no_number_is_quoted() {
    let fault = fault_of(&flaser(181, 181).replacen("2.004", "2.0.4", 1));
    assert_eq!(fault, "range 5 is `2.0.4`, a number is expected");
    assert_eq!(
        fault_of("FLASER many 1 2 3\n"),
        "the number of ranges is `many`, a number is expected"
    );
    assert_eq!(
        fault_of("FLASER 4294967296 1 2 3\n"),
        "the header says 4294967296 ranges, at least 1 and at most 65536 are expected"
    );
}

#[test]
fn a_gzip_stream_that_breaks_gives_all_before_it() {
    // Ranges from a generator of random numbers, so that every part of the log takes the same room in gzip.
    let mut state = 1_u32;
    let mut range = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        format!(" {:.3}", f64::from(state >> 16) / 1e4)
    };
    let line = |k: usize| {
        let ranges: String = (0..181).map(|_| range()).collect();
        format!("FLASER 181{ranges} 0 0 0 0 0 0 {k} host {k}\n")
    };
    let text: String = (0..2000).map(line).collect();
    let packed = gzip(&text);
    let folder = tempfile::tempdir().unwrap();
    for share in [0.1, 0.6] {
        let cut = &packed[..(packed.len() as f64 * share) as usize];
        let path = file(folder.path(), "cut.log", cut);
        let got: Vec<_> = log::open(&path, ReadOptions::default()).unwrap().collect();
        let (last, before) = got.split_last().unwrap();
        assert!(before.iter().all(|e| matches!(e, Ok(Entry::Scan(_)))));
        assert!(
            before.len() > (1900.0 * share) as usize,
            "{} scans of a share of {share}",
            before.len()
        );
        let Err(LogError::Broken { line, .. }) = last else {
            panic!("{last:?}")
        };
        assert_eq!(*line, before.len() as u64);
    }
}

#[test]
fn plain_and_gzip_give_the_same_and_the_name_does_not_matter() {
    let text = flaser(181, 181).repeat(4);
    let folder = tempfile::tempdir().unwrap();
    let packed = file(folder.path(), "packed.txt", &gzip(&text));
    let stamps = |log: Log| -> Vec<_> {
        log.map(|e| match e.unwrap() {
            Entry::Scan(s) => (s.index, s.stamp_s, s.scan.ranges_m().to_vec()),
            Entry::Bad(bad) => panic!("{bad:?}"),
        })
        .collect()
    };
    let plain = stamps(open_text(&text, ReadOptions::default()));
    assert_eq!(plain, stamps(log::open(&packed, ReadOptions::default()).unwrap()));
}

#[test]
fn what_is_no_log_is_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let error = |path: &Path| match log::open(path, ReadOptions::default()) {
        Ok(log) => log.last().unwrap().unwrap_err().to_string(),
        Err(error) => error.to_string(),
    };
    let ends = |name: &str, content: &[u8], expected: &str| {
        let path = file(folder.path(), name, content);
        let message = error(&path);
        assert!(message.contains(name) && message.contains(expected), "{message}");
    };
    ends("empty.log", b"", "is empty");
    ends("empty.log.gz", &gzip(""), "is empty");
    ends(
        "junk.log",
        b"\x7fELF\x02\x01\x00\x00\xff",
        "binary data, 7f 45 4c 46",
    );
    ends(
        "text.log",
        b"hello there\nFLASERS\n",
        "its first line is `hello there`",
    );
    ends(
        "odom.log",
        b"# c\nODOM 1 2 3\nODOM 1 2 3\n",
        "3 lines: no scan in it; it holds 2 ODOM",
    );
    assert!(error(&folder.path().join("none.log")).ends_with("none.log: no such file"));
    let inner = folder.path().join("inner");
    std::fs::create_dir(&inner).unwrap();
    assert!(error(&inner).contains("is a directory"));
}

#[test]
fn the_real_logs_are_read_to_their_end() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if !data.exists() {
        eprintln!("skipped: no recordings beside this repository");
        return;
    }
    let counts = [
        ("raw/intel.clf.gz", 13631, 180),
        ("raw/aces.clf.gz", 7374, 180),
        ("raw/mit-csail.clf.gz", 1988, 361),
        ("keyframes/aces.log.gz", 440, 180),
        ("keyframes/csail.log.gz", 406, 361),
        ("keyframes/edmonton.log.gz", 340, 180),
        ("keyframes/fhw.log.gz", 488, 180),
        ("keyframes/infinite-corridor.log.gz", 1941, 180),
        ("keyframes/intel.log.gz", 910, 180),
        ("keyframes/orebro.log.gz", 237, 181),
        ("small-scanners/wheelchair-sm3.log.gz", 778, 361),
        ("small-scanners/robotlaser1-sample.log.gz", 400, 181),
    ];
    for (name, expected, beams) in counts {
        let mut log = log::open(&data.join(name), ReadOptions::default()).unwrap();
        let first = log.next().unwrap().unwrap();
        assert!(
            matches!(first, Entry::Scan(s) if s.scan.geometry().beams() == beams),
            "{name}"
        );
        let rest = log.by_ref().map(Result::unwrap).count();
        assert_eq!((1 + rest, log.tally().bad_scans), (expected, 0), "{name}");
    }
}

#[test]
fn a_graph_with_lasers_in_it_is_read_past_its_vertices() {
    let vertices = "VERTEX_SE2 17 1.5 2.5 0.1\n".repeat(20_000);
    let mut log = open_text(&(vertices + &robotlaser(-1.5, 0.02, 5)), ReadOptions::default());
    assert_eq!(log.by_ref().count(), 1);
    assert_eq!(log.tally().other_messages["VERTEX_SE2"], 20_000);
}

#[test]
fn a_range_that_recurs_at_the_top_is_no_return_and_said_to_be_one() {
    // A room, and a glass door that gives no return, seen on other beams from scan to scan.
    let line = |scan: usize| {
        let ranges: String = (0..181)
            .map(|beam| {
                let is_door = (scan..scan + 5).contains(&beam);
                let range_m = if is_door { 29.99 } else { 2.0 + beam as f64 / 100.0 };
                format!(" {range_m:.2}")
            })
            .collect();
        format!("FLASER 181{ranges} 1 2 0.3 4 5 0.6 1234.5 host 7.8\n")
    };
    let text: String = (0..20).map(line).collect();
    let mut log = open_text(&text, ReadOptions::default());
    let scans: Vec<Entry> = log.by_ref().collect::<Result<_, _>>().unwrap();
    let Some(Entry::Scan(last)) = scans.last() else {
        panic!("no scan");
    };
    assert_eq!(last.scan.returns(), 181 - 5);
    let notes = log.tally().notes;
    assert!(notes.iter().any(|n| n.contains("29.985 m")), "{notes:?}");
}
