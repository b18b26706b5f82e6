//! What `inspect` says of the real recordings beside the repository: a row a file.

use std::path::Path;

use polymapper_io::inspect::{Inspection, inspect};
use polymapper_io::log::{self, LogError, ReadOptions};

/// What must be found in a file.
struct Row {
    name: &'static str,
    format: &'static str,
    laser: &'static str,
    scans: usize,
    bad: usize,
    /// Beams and first bearing in degrees of the most frequent geometry.
    beams: (usize, f64),
    returns_percent: f64,
    /// What stands most often for no return.
    code: &'static str,
    backwards: usize,
    /// Rate of the stamps, Hz; 0 where they are none or useless.
    rate_hz: f64,
    odometry_poses: usize,
}

const fn row(name: &'static str, format: &'static str, laser: &'static str, scans: usize) -> Row {
    Row {
        name,
        format,
        laser,
        scans,
        bad: 0,
        beams: (180, -90.0),
        returns_percent: 0.0,
        code: "",
        backwards: 0,
        rate_hz: 0.0,
        odometry_poses: 0,
    }
}

const CARMEN: &str = "CARMEN";
const COLUMNS: &str = "text with a scan in a line";

#[rustfmt::skip]
const ROWS: &[Row] = &[
    Row { returns_percent: 97.2, code: "81.83", backwards: 631, rate_hz: 9.5, odometry_poses: 13631, ..row("raw/intel.clf.gz", CARMEN, "FLASER", 13631) },
    Row { returns_percent: 99.2, code: "50", rate_hz: 6.2, odometry_poses: 7374, ..row("raw/aces.clf.gz", CARMEN, "FLASER", 7374) },
    Row { beams: (361, -90.0), returns_percent: 96.7, code: "81.91", rate_hz: 4.8, odometry_poses: 1988, ..row("raw/mit-csail.clf.gz", CARMEN, "FLASER", 1988) },
    Row { returns_percent: 99.2, code: "50", rate_hz: 0.5, odometry_poses: 440, ..row("keyframes/aces.log.gz", CARMEN, "FLASER", 440) },
    Row { beams: (361, -90.0), returns_percent: 97.3, code: "81.91", odometry_poses: 406, ..row("keyframes/csail.log.gz", CARMEN, "FLASER", 406) },
    Row { returns_percent: 94.6, code: "51.15", rate_hz: 0.5, odometry_poses: 340, ..row("keyframes/edmonton.log.gz", CARMEN, "FLASER", 340) },
    Row { returns_percent: 99.3, code: "51.05", rate_hz: 0.6, odometry_poses: 488, ..row("keyframes/fhw.log.gz", CARMEN, "FLASER", 488) },
    Row { returns_percent: 98.7, code: "51.06", backwards: 3, odometry_poses: 1941, ..row("keyframes/infinite-corridor.log.gz", CARMEN, "FLASER", 1941) },
    Row { returns_percent: 97.4, code: "81.83", backwards: 4, rate_hz: 0.3, odometry_poses: 910, ..row("keyframes/intel.log.gz", CARMEN, "FLASER", 910) },
    Row { beams: (181, -90.0), returns_percent: 97.7, code: "32.763", odometry_poses: 237, ..row("keyframes/orebro.log.gz", CARMEN, "FLASER", 237) },
    Row { beams: (768, -135.0), returns_percent: 53.2, code: "0", rate_hz: 7.5, ..row("moving/people-walking.bag", "ROS 1 bag", "/rear_scan", 510) },
    Row { beams: (307, -179.4), bad: 1, returns_percent: 80.0, code: "0", rate_hz: 25.0, odometry_poses: 478, ..row("small-scanners/corridor-degenerate.lsc.gz", COLUMNS, "LASERSCAN", 478) },
    Row { beams: (420, 0.0), returns_percent: 83.5, code: "0", ..row("small-scanners/lowcost-360-a.csv.gz", COLUMNS, "", 522) },
    Row { beams: (181, -90.0), returns_percent: 90.7, code: "81.91", rate_hz: 1.6, odometry_poses: 400, ..row("small-scanners/robotlaser1-sample.log.gz", CARMEN, "ROBOTLASER1", 400) },
    Row { beams: (360, -359.0), returns_percent: 38.2, code: "0", rate_hz: 5.5, ..row("small-scanners/rplidar-a1-24jul.log.gz", COLUMNS, "", 237) },
    Row { beams: (181, -90.0), returns_percent: 93.3, code: "8.183", odometry_poses: 551, ..row("small-scanners/sick-loop5.log.gz", COLUMNS, "Laser", 551) },
    Row { beams: (682, -119.5), returns_percent: 44.7, code: "0", rate_hz: 10.2, ..row("small-scanners/urg-encoders-exp1.dat.gz", COLUMNS, "", 756) },
    Row { beams: (681, -119.5), returns_percent: 94.0, code: "0", rate_hz: 10.0, ..row("small-scanners/urg-handheld.bag", "ROS 1 bag", "/scan", 278) },
    Row { beams: (681, -119.5), returns_percent: 94.0, code: "0", rate_hz: 10.0, ..row("small-scanners/urg-handheld-mcap", "MCAP", "/scan", 278) },
    Row { beams: (681, -119.5), returns_percent: 94.0, code: "0", rate_hz: 10.0, ..row("small-scanners/urg-handheld-db3", "ROS 2 sqlite3", "/scan", 278) },
    Row { beams: (361, -90.0), returns_percent: 93.2, code: "nan", odometry_poses: 778, ..row("small-scanners/wheelchair-sm3.log.gz", CARMEN, "FLASER", 778) },
    Row { beams: (360, -180.0), returns_percent: 97.0, code: "81.91", ..row("extraction/ple-scans.jsonl.gz", "JSON lines", "", 260) },
];

/// Files beside the logs that are none.
const NO_LOGS: &[&str] = &[
    "raw/aces.relations",
    "raw/intel.relations",
    "reference/aces.ple.csv",
    "reference/intel.flirtlib.csv",
    "reference/intel.ple.csv",
    "reference/mit-csail.flirtlib.csv",
    "reference/mit-csail.ple.csv",
];

fn data() -> Option<std::path::PathBuf> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if !data.exists() {
        eprintln!("skipped: no recordings beside this repository");
        return None;
    }
    Some(data)
}

fn look(path: &Path) -> Result<Inspection, LogError> {
    let options = ReadOptions {
        use_odometry: true,
        keep_raw: true,
        ..ReadOptions::default()
    };
    inspect(&mut log::open(path, options)?)
}

#[test]
fn inspect_is_right_about_every_recording() {
    let Some(data) = data() else { return };
    for row in ROWS {
        let found = look(&data.join(row.name)).unwrap();
        let name = row.name;
        assert_eq!(found.format, row.format, "{name}");
        assert_eq!(found.laser.as_deref().unwrap_or_default(), row.laser, "{name}");
        assert_eq!(found.scans, row.scans, "{name}");
        assert_eq!(
            found.bad_scans.iter().map(|b| b.scans).sum::<usize>(),
            row.bad,
            "{name}"
        );
        let geometry = &found.geometries[0];
        assert_eq!(geometry.beams, row.beams.0, "{name}");
        assert!(
            (geometry.first_deg - row.beams.1).abs() < 0.06,
            "{name}: {geometry:?}"
        );
        let percent = 100.0 * found.ranges.returns as f64 / found.ranges.beams as f64;
        assert!(
            (percent - row.returns_percent).abs() < 0.06,
            "{name}: {percent} %"
        );
        assert_eq!(found.ranges.codes[0].value, row.code, "{name}");
        assert_eq!(found.odometry_poses, row.odometry_poses, "{name}");
        let stamps = found.stamps.as_ref();
        assert_eq!(stamps.map_or(0, |s| s.backwards), row.backwards, "{name}");
        let rate_hz = stamps
            .filter(|s| !s.are_useless())
            .and_then(|s| s.median_step_s)
            .map_or(0.0, |s| 1.0 / s);
        assert!((rate_hz - row.rate_hz).abs() < 0.06, "{name}: {rate_hz} Hz");
    }
}

#[test]
fn what_is_no_log_is_refused() {
    let Some(data) = data() else { return };
    for name in NO_LOGS {
        let error = look(&data.join(name)).unwrap_err();
        assert!(matches!(error, LogError::Unrecognised { .. }), "{name}: {error}");
    }
}

#[test]
fn every_file_of_the_data_has_its_row() {
    let Some(data) = data() else { return };
    let mut names = Vec::new();
    for folder in std::fs::read_dir(&data).unwrap().map(|f| f.unwrap().path()) {
        if folder.is_dir() {
            let inside = std::fs::read_dir(&folder).unwrap().map(|f| f.unwrap().path());
            names.extend(inside.map(|f| f.strip_prefix(&data).unwrap().display().to_string()));
        }
    }
    assert!(!names.is_empty());
    for name in names {
        let known = ROWS.iter().any(|r| r.name == name) || NO_LOGS.contains(&name.as_str());
        assert!(known, "{name} has no row");
    }
}
