//! What a user meets when reading recordings of robots: ROS 1 bags, MCAP, sqlite3, rawlogs.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

mod recording;

use std::io::{Cursor, Write};

use polymapper_io::log::{self, Entry, Log, LogError, LogScan, ReadOptions, Tally};
use recording::{
    AHEAD, Angles, Message, Pack, bag, db3, laser_scan, mcap, multi_echo, odometry, rawlog_scan, rawlog_step,
    transform,
};

const NONE: Pack = ("none", <[u8]>::to_vec);
const SCAN: &str = "sensor_msgs/msg/LaserScan";
const TF: &str = "tf2_msgs/msg/TFMessage";
const ODOMETRY: &str = "nav_msgs/msg/Odometry";
const RANGES: [f32; 5] = [1.0, 2.0, 3.0, 4.0, 5.0];
/// Half a turn about x.
const UPSIDE_DOWN: [f64; 4] = [1.0, 0.0, 0.0, 0.0];
const UPRIGHT: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

fn message(topic: &'static str, kind: &'static str, data: Vec<u8>) -> Message {
    Message { topic, kind, data }
}

fn scan_at(stamp_s: u32) -> Message {
    message("/scan", SCAN, laser_scan(true, stamp_s, AHEAD, &RANGES))
}

fn open(file: Vec<u8>, options: ReadOptions) -> Log {
    log::open_reader("test", Cursor::new(file), options).unwrap()
}

fn read_with(file: Vec<u8>, options: ReadOptions) -> (Vec<LogScan>, Tally) {
    let mut log = open(file, options);
    let scan = |entry| match entry {
        Ok(Entry::Scan(scan)) => scan,
        other => panic!("{other:?}"),
    };
    let scans = log.by_ref().map(scan).collect();
    (scans, log.tally())
}

fn read(file: Vec<u8>) -> (Vec<LogScan>, Tally) {
    read_with(file, ReadOptions::default())
}

fn with_odometry() -> ReadOptions {
    ReadOptions {
        use_odometry: true,
        ..ReadOptions::default()
    }
}

fn bzip2(bytes: &[u8]) -> Vec<u8> {
    let mut packed = bzip2::write::BzEncoder::new(Vec::new(), bzip2::Compression::best());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

fn lz4(bytes: &[u8]) -> Vec<u8> {
    let mut packed = lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
    packed.write_all(bytes).unwrap();
    packed.finish().0
}

fn ros1_scans(stamps_s: std::ops::Range<u32>) -> Vec<Message> {
    stamps_s
        .map(|s| {
            message(
                "/scan",
                "sensor_msgs/LaserScan",
                laser_scan(false, s, AHEAD, &RANGES),
            )
        })
        .collect()
}

#[test]
fn bags_are_read_however_they_are_packed_and_without_an_index() {
    for pack in [NONE, ("bz2", bzip2), ("lz4", lz4)] {
        let file = bag(&[ros1_scans(1..4), ros1_scans(4..6)], pack, 12);
        let (scans, tally) = read(file);
        let stamps: Vec<_> = scans.iter().map(|s| s.stamp_s).collect();
        assert_eq!(stamps, [1.5, 2.5, 3.5, 4.5, 5.5].map(Some), "{}", pack.0);
        assert_eq!(
            (tally.laser.as_deref(), tally.lost),
            (Some("/scan"), None),
            "{}",
            pack.0
        );
        assert_eq!(scans[0].scan.ranges_m(), RANGES.map(f64::from));
    }
}

#[test]
fn an_index_whose_length_lies_ends_the_bag_and_is_said_unless_it_is_salvaged() {
    let file = bag(&[ros1_scans(1..4), ros1_scans(4..6)], NONE, 20);
    let (scans, tally) = read(file.clone());
    assert_eq!(scans.len(), 3);
    assert!(
        tally
            .lost
            .unwrap()
            .contains("says 60 bytes and has entries of 36")
    );
    let salvage = ReadOptions {
        salvage: true,
        ..ReadOptions::default()
    };
    assert_eq!(read_with(file, salvage).0.len(), 5);
}

#[test]
fn a_recording_that_is_cut_gives_all_before_the_cut() {
    let mcap = mcap(&(1..9).map(scan_at).collect::<Vec<_>>());
    let bag = bag(&[ros1_scans(1..9)], NONE, 12);
    for (file, least) in [(mcap, 3), (bag, 3)] {
        let cut = file[..file.len() * 6 / 10].to_vec();
        let got: Vec<_> = open(cut, ReadOptions::default()).collect();
        let (last, before) = got.split_last().unwrap();
        assert!(before.len() >= least && before.iter().all(|e| matches!(e, Ok(Entry::Scan(_)))));
        let Err(LogError::Broken { source, .. }) = last else {
            panic!("{last:?}")
        };
        assert!(source.to_string().contains("the file is cut within"), "{source}");
    }
}

#[test]
fn the_same_messages_are_the_same_scans_in_mcap_and_sqlite() {
    let messages = || {
        vec![
            message("/tf_static", TF, transform(true, [0.2, 0.0, 0.0], UPRIGHT)),
            scan_at(1),
            message("/odom", ODOMETRY, odometry(true, 1, 7.0)),
            scan_at(2),
        ]
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.db3");
    db3(&path, &messages()).unwrap();
    let from_db = read(std::fs::read(&path).unwrap());
    let (scans, tally) = read(mcap(&messages()));
    assert_eq!(scans.len(), 2);
    for (a, b) in scans.iter().zip(&from_db.0) {
        assert_eq!(
            (a.stamp_s, a.scan.ranges_m(), a.odometry),
            (b.stamp_s, b.scan.ranges_m(), None)
        );
        assert_eq!(a.scan.geometry(), b.scan.geometry());
    }
    assert_eq!(tally.other_messages, from_db.1.other_messages);
    assert!(tally.reasons["/odom (nav_msgs/Odometry)"].contains("--use-odometry"));
    let plain = log::open(&path, ReadOptions::default()).unwrap();
    assert_eq!(plain.count(), 2);
}

#[test]
fn a_recording_with_a_log_of_writes_ahead_comes_in_by_any_way() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.db3");
    db3(&path, &[scan_at(1), scan_at(2)]).unwrap();
    // As rosbag2 writes it.
    let database = rusqlite::Connection::open(&path).unwrap();
    let mode = database.query_row("PRAGMA journal_mode = WAL", [], |row| row.get::<_, String>(0));
    assert_eq!(mode.unwrap(), "wal");
    drop(database);
    let stream = || std::fs::read(&path).unwrap();
    assert_eq!(stream()[18..20], [2, 2]);
    let by_name = || log::open(&path, ReadOptions::default()).unwrap().count();
    assert_eq!((read(stream()).0.len(), by_name()), (2, 2));
    // Too long for memory.
    let database = rusqlite::Connection::open(&path).unwrap();
    let more = "CREATE TABLE more(data BLOB); INSERT INTO more VALUES(zeroblob(3000000));";
    database.execute_batch(more).unwrap();
    drop(database);
    assert!(stream().len() > 3_000_000);
    assert_eq!((read(stream()).0.len(), by_name()), (2, 2));
}

#[test]
fn a_scanner_that_hangs_upside_down_is_turned_round_even_if_that_is_said_late() {
    let file = mcap(&[
        scan_at(1),
        message("/tf_static", TF, transform(true, [0.2, 0.0, 0.0], UPSIDE_DOWN)),
        scan_at(2),
    ]);
    let (scans, tally) = read(file);
    for scan in scans {
        // Its first beam, 1 m at −0.5 rad, looks to +0.5 rad seen from above.
        assert_eq!(scan.scan.ranges_m(), [5.0, 4.0, 3.0, 2.0, 1.0]);
        assert!((scan.scan.geometry().bearing_rad(4) - 0.5).abs() < 1e-6);
    }
    assert!(
        tally.notes.iter().any(|n| n.contains("upside down")),
        "{:?}",
        tally.notes
    );
}

#[test]
fn a_clockwise_scanner_and_one_that_hangs_upside_down_too() {
    let clockwise = Angles {
        min_rad: 0.5,
        step_rad: -0.25,
    };
    let scan = message("/scan", SCAN, laser_scan(true, 1, clockwise, &RANGES));
    let (scans, _) = read(mcap(&[scan]));
    assert_eq!(scans[0].scan.ranges_m(), [5.0, 4.0, 3.0, 2.0, 1.0]);
    assert!((scans[0].scan.geometry().bearing_rad(0) + 0.5).abs() < 1e-6);

    let scan = message("/scan", SCAN, laser_scan(true, 1, clockwise, &RANGES));
    let tf = message("/tf_static", TF, transform(true, [0.0; 3], UPSIDE_DOWN));
    let (scans, _) = read(mcap(&[tf, scan]));
    assert_eq!(
        scans[0].scan.ranges_m(),
        RANGES.map(f64::from),
        "both turn it back"
    );
}

#[test]
fn odometry_comes_between_its_samples_and_from_where_the_scanner_is() {
    let file = mcap(&[
        message("/tf_static", TF, transform(true, [0.5, 0.0, 0.0], UPRIGHT)),
        message("/odom", ODOMETRY, odometry(true, 10, 1.0)),
        scan_at(10),
        message("/odom", ODOMETRY, odometry(true, 11, 3.0)),
    ]);
    let (scans, _) = read_with(file.clone(), with_odometry());
    let pose = scans[0].odometry.unwrap();
    assert!((pose.x - 1.5).abs() < 1e-9 && pose.y.abs() < 1e-9, "{pose:?}");
    assert_eq!(read(file).0[0].odometry, None);
}

#[test]
fn the_wider_of_two_lasers_is_read_unless_another_is_asked_for() {
    let narrow = || message("/depth", SCAN, laser_scan(true, 1, AHEAD, &RANGES[..3]));
    let file = mcap(&[narrow(), scan_at(1), narrow(), scan_at(2)]);
    let (scans, tally) = read(file.clone());
    assert_eq!((scans.len(), tally.laser.as_deref()), (2, Some("/scan")));
    assert_eq!(tally.other_messages["/depth (sensor_msgs/LaserScan)"], 2);
    assert!(tally.reasons["/depth (sensor_msgs/LaserScan)"].contains("--topic /depth"));
    let asked = ReadOptions {
        laser: Some("depth".to_owned()),
        ..ReadOptions::default()
    };
    let (scans, tally) = read_with(file.clone(), asked);
    assert_eq!(
        (scans[1].scan.geometry().beams(), tally.laser.as_deref()),
        (3, Some("/depth"))
    );
    let absent = ReadOptions {
        laser: Some("/front".to_owned()),
        ..ReadOptions::default()
    };
    let error = open(file, absent).next().unwrap().unwrap_err().to_string();
    assert!(
        error.contains("2 /scan (sensor_msgs/LaserScan) (another laser; --topic /scan reads it)"),
        "{error}"
    );
}

#[test]
fn rep_117_and_beam_counts_that_vary() {
    let odd = [1.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 0.05, 31.0];
    let file = mcap(&[
        message("/scan", SCAN, laser_scan(true, 1, AHEAD, &odd)),
        scan_at(2),
    ]);
    let (scans, _) = read(file);
    assert_eq!(scans[0].scan.returns(), 1);
    assert_eq!(
        (scans[0].scan.geometry().beams(), scans[1].scan.geometry().beams()),
        (6, 5)
    );
}

#[test]
fn the_first_of_several_echoes_counts() {
    let data = multi_echo(&[&[2.0, 3.0], &[], &[4.0]]);
    let (scans, tally) = read(mcap(&[message(
        "/echoes",
        "sensor_msgs/msg/MultiEchoLaserScan",
        data,
    )]));
    assert_eq!(scans[0].scan.returns(), 2);
    assert!((scans[0].scan.ranges_m()[0] - 2.0).abs() < 1e-9);
    assert!(tally.notes[0].contains("first echo"));
}

#[test]
fn a_message_with_lengths_that_lie_costs_one_scan() {
    let mut lies = laser_scan(true, 1, AHEAD, &RANGES);
    let place = lies.len() - 4 * 7;
    lies[place..place + 4].copy_from_slice(&u32::MAX.to_le_bytes());
    let file = mcap(&[scan_at(1), message("/scan", SCAN, lies), scan_at(3)]);
    let entries: Vec<Entry> = open(file, ReadOptions::default()).map(Result::unwrap).collect();
    let [Entry::Scan(_), Entry::Bad(bad), Entry::Scan(_)] = &entries[..] else {
        panic!("{entries:?}")
    };
    assert_eq!(
        format!("{} {}: {}", bad.unit, bad.line, bad.fault),
        "message 2: the message says 4294967295 ranges of 4 bytes, 24 bytes are left"
    );
}

#[test]
fn a_recording_without_a_laser_says_what_it_holds() {
    let file = mcap(&[message("/imu", "sensor_msgs/msg/Imu", vec![0; 20])]);
    let error = open(file, ReadOptions::default()).next().unwrap().unwrap_err();
    assert_eq!(
        error.to_string(),
        "test, 1 messages: no scan in it; it holds 1 /imu (sensor_msgs/Imu)"
    );
}

#[test]
fn rawlogs_are_read_past_what_is_not_known() {
    let upright = [1.0, 0.0, 0.0, 0.0];
    let mut file = b"\x8dCSensoryFrame\x02\x01\0\0\0".to_vec();
    file.extend(rawlog_scan(true, upright, &[1.0, 2.0, 3.0], &[1, 0, 1]));
    file.extend(b"\x8fCUnknownThing88\x01whatever stands here");
    file.extend(rawlog_step(1.0));
    file.extend(rawlog_scan(false, upright, &[1.0, 2.0, 3.0], &[1, 1, 1]));
    let (scans, tally) = read_with(file, with_odometry());
    assert!(
        scans[0].scan.ranges_m()[1].is_nan(),
        "the log says that it is not valid"
    );
    assert_eq!(
        scans[1].scan.ranges_m(),
        [3.0, 2.0, 1.0],
        "left to right is clockwise"
    );
    assert!((scans[0].scan.geometry().bearing_rad(0) + 0.5).abs() < 1e-6);
    assert_eq!(scans[0].stamp_s, Some(1234.5));
    let x = |k: usize| scans[k].odometry.unwrap().x;
    assert!(
        (x(0) - 0.5).abs() < 1e-9 && (x(1) - 1.5).abs() < 1e-9,
        "{} {}",
        x(0),
        x(1)
    );
    assert_eq!(tally.laser.as_deref(), Some("SICK"));
}

#[test]
fn the_parts_of_a_folder_are_one_log() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &[u8]| std::fs::write(folder.path().join(name), content).unwrap();
    write("run_10.mcap", &mcap(&[scan_at(3)]));
    write("run_2.mcap", &mcap(&[scan_at(2)]));
    let tf = message("/tf_static", TF, transform(true, [0.0; 3], UPSIDE_DOWN));
    write("run_0.mcap", &mcap(&[tf, scan_at(1)]));
    write("metadata.yaml", b"rosbag2_bagfile_information:\n");
    write("notes.txt", b"walked twice round the hall\n");
    let mut log = log::open(folder.path(), ReadOptions::default()).unwrap();
    let scans: Vec<LogScan> = log
        .by_ref()
        .map(|e| match e.unwrap() {
            Entry::Scan(scan) => scan,
            Entry::Bad(bad) => panic!("{bad:?}"),
        })
        .collect();
    let seen: Vec<_> = scans.iter().map(|s| (s.index, s.stamp_s)).collect();
    assert_eq!(seen, [(0, Some(1.5)), (1, Some(2.5)), (2, Some(3.5))]);
    assert!(
        (scans[2].scan.ranges_m()[0] - 5.0).abs() < 1e-9,
        "the mounting holds for all parts"
    );
    let notes = log.tally().notes;
    assert!(notes.iter().any(|n| n.contains("notes.txt")), "{notes:?}");
}

#[test]
fn a_record_longer_than_its_chunk_is_a_cut_and_no_overflow() {
    // Found by fuzzing in the reader that was used before.
    let inner = [&[5_u8][..], &999_u64.to_le_bytes(), &[0; 30]].concat();
    let mut chunk = vec![0; 28];
    chunk.extend(0_u32.to_le_bytes());
    chunk.extend((inner.len() as u64).to_le_bytes());
    chunk.extend(inner);
    let mut file = b"\x89MCAP0\r\n\x06".to_vec();
    file.extend((chunk.len() as u64).to_le_bytes());
    file.extend(chunk);
    file.extend([0; 2000]);
    let error = open(file, ReadOptions::default()).next().unwrap().unwrap_err();
    let LogError::Broken { source, .. } = error else {
        panic!("{error:?}")
    };
    assert_eq!(source.to_string(), "the file is cut within a record");
}
