//! Exports read by other people's programs: ezdxf, GDAL, mcap, rosbags, evo, Open-RMF. `tests/outside/install.sh`
//! installs them; where they are not installed these tests say that they were skipped.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

use tempfile::TempDir;

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// What `install.sh` put under `target/outside`; `None`, said plainly, where it did not.
fn installed(what: &str) -> Option<PathBuf> {
    let program = workspace().join("target/outside").join(what);
    if program.is_file() {
        return Some(program);
    }
    // Not `eprintln`, which is silenced where a test passes.
    let place = "crates/cli/tests/outside/install.sh";
    let _ = writeln!(io::stderr(), "SKIPPED: {what} is not there; {place} installs it");
    None
}

fn polymapper(words: &[&str]) {
    let run = Command::new(env!("CARGO_BIN_EXE_polymapper"))
        .args(words)
        .output()
        .unwrap();
    assert!(
        run.status.success(),
        "{words:?}: {}",
        String::from_utf8_lossy(&run.stderr)
    );
}

/// A folder with the map of the sample in every format; made once.
fn exports() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("exports");
        let log = workspace().join("samples/killian.log.gz");
        let formats = "nav2,nav2-vector,rmf,dxf,svg,png,json-fg,gpkg,mcap,tum,kitti,g2o,carmen";
        let output = folder.to_str().unwrap();
        polymapper(&["build", log.to_str().unwrap(), "-o", output, "--export", formats]);
        folder
    })
}

/// A folder with a small map drawn by hand, with an eraser box, a closed line and a large id; exported without
/// scans.
fn small() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let map = r#"{"format": "polymapper-map", "version": 1, "polylines": [
        {"id": 3, "vertices": [[-1234.5678, 0.0], [5.0, 0.0]]},
        {"id": 2147483647, "vertices": [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [1.0, 1.0]]}],
        "eraser_boxes": [{"min": [3.0, 1.5], "max": [4.0, 2.25]}]}"#;
    let way = "scan,stamp_s,x_m,y_m,theta_rad,outcome,reason\n0,5.0,0.0,0.5,0.0,placed,\n\
               1,6.0,0.5,0.5,0.1,placed,\n2,7.0,,,,not_placed,lost\n3,8.0,1.5,0.5,0.2,placed,\n";
    fs::write(folder.path().join("map.json"), map).unwrap();
    fs::write(folder.path().join("trajectory.csv"), way).unwrap();
    let map = folder.path().join("map.json");
    polymapper(&[
        "export",
        map.to_str().unwrap(),
        "--to",
        "dxf,gpkg,json-fg,nav2-vector",
    ]);
    folder
}

/// Has `check.py` read the export `what` in `folder`; whether it could.
fn check(what: &str, folder: &Path) -> bool {
    let Some(python) = installed("venv/bin/python") else {
        return false;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/outside/check.py");
    let run = Command::new(python)
        .arg(script)
        .arg(what)
        .arg(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&run.stdout).into_owned() + &String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success() && said.contains("sound"), "{what}: {said}");
    true
}

#[test]
fn a_small_map_with_all_there_is_passes_them_all() {
    let folder = small();
    for what in ["dxf", "gpkg", "json-fg", "nav2-vector"] {
        check(what, folder.path());
    }
}

#[test]
fn the_rules_of_the_vector_object_server_are_kept() {
    check("nav2-vector", exports());
}

#[test]
fn ezdxf_audits_the_dxf_without_a_fault() {
    check("dxf", exports());
}

#[test]
fn gdal_reads_the_geopackage_in_metres() {
    check("gpkg", exports());
}

#[test]
fn gdal_reads_json_fg_in_metres_not_degrees() {
    check("json-fg", exports());
}

#[test]
fn gdal_finds_a_map_with_a_place_on_earth_where_it_is() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["map.json", "trajectory.csv"] {
        fs::copy(exports().join(name), folder.path().join(name)).unwrap();
    }
    let map = folder.path().join("map.json");
    let words = [
        "export",
        map.to_str().unwrap(),
        "--to",
        "geojson,gpkg,json-fg",
        "--georef",
        "48.0,7.8,90",
    ];
    polymapper(&words);
    check("georef", folder.path());
}

#[test]
fn mcap_and_rosbags_read_every_message() {
    check("mcap", exports());
}

#[test]
fn evo_reads_tum_and_kitti_and_finds_the_length_of_the_way() {
    check("evo", exports());
}

#[test]
fn a_reader_of_nav2s_rules_finds_walls_free_space_and_the_unknown() {
    check("nav2", exports());
}

#[test]
fn open_rmf_reads_every_side_as_a_wall_and_makes_a_site() {
    let Some(program) = installed("rmf/debug/rmf-check") else {
        return;
    };
    let run = Command::new(program)
        .arg(exports().join("map.building.yaml"))
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let map: serde_json::Value =
        serde_json::from_slice(&fs::read(exports().join("map.json")).unwrap()).unwrap();
    let mut expected = String::new();
    for polyline in map["polylines"].as_array().unwrap() {
        let number = |v: &serde_json::Value, k: usize| v[k].as_f64().unwrap();
        for side in polyline["vertices"].as_array().unwrap().windows(2) {
            let (a, b) = (&side[0], &side[1]);
            let (x1, y1, x2, y2) = (number(a, 0), number(a, 1), number(b, 0), number(b, 1));
            expected.push_str(&format!("{x1:.4} {y1:.4} {x2:.4} {y2:.4}\n"));
        }
    }
    assert_eq!(String::from_utf8(run.stdout).unwrap(), expected);
}

/// The lines of a map: id and vertices.
fn lines(map: &Path) -> Vec<(u64, Vec<[f64; 2]>)> {
    let map: serde_json::Value = serde_json::from_slice(&fs::read(map).unwrap()).unwrap();
    let line = |p: &serde_json::Value| {
        let vertices = serde_json::from_value(p["vertices"].clone()).unwrap();
        (p["id"].as_u64().unwrap(), vertices)
    };
    map["polylines"].as_array().unwrap().iter().map(line).collect()
}

#[test]
fn drawings_that_other_programs_saved_anew_come_back_with_their_ids() {
    let folder = exports();
    if !check("saved-anew", folder) {
        return;
    }
    for (drawing, options) in [("anew.dxf", ""), ("anew.geojson", "--metres-per-unit=1")] {
        let (drawing, back) = (folder.join(drawing), folder.join("back.json"));
        let mut words = vec!["import", drawing.to_str().unwrap(), "-o", back.to_str().unwrap()];
        words.extend(Some(options).filter(|o| !o.is_empty()));
        polymapper(&words);
        assert_eq!(
            lines(&back),
            lines(&folder.join("map.json")),
            "{}",
            drawing.display()
        );
    }
}
