//! `export` and `import` as a user meets them: what comes back, what is missing, what is refused.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

const MAP: &str = r#"{"format": "polymapper-map", "version": 1, "polylines": [
    {"id": 7, "vertices": [[-0.25, 0.0], [12.3457, 0.0], [12.3457, -8.5]], "observations": [4, 9, 2], "sigma_m": [0.004, 0.001, null]},
    {"id": 3, "vertices": [[345.6789, -123.4567], [346.0, -120.0]]},
    {"id": 4000000000, "vertices": [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 1.0]]}],
    "eraser_boxes": [{"min": [3.0, 1.5], "max": [4.0, 2.25]}]}"#;
const HEAD: &str = "scan,stamp_s,x_m,y_m,theta_rad,outcome,reason\n";

/// A folder with the map drawn above.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        bench.write("map.json", MAP);
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    /// Runs `polymapper` in the folder; the exit code and what it said.
    fn run(&self, words: &str) -> (Option<i32>, String) {
        let run: Output = Command::new(env!("CARGO_BIN_EXE_polymapper"))
            .args(words.split_whitespace())
            .current_dir(self.0.path())
            .output()
            .unwrap();
        (run.status.code(), String::from_utf8(run.stderr).unwrap())
    }

    fn done(&self, words: &str) -> String {
        let (code, said) = self.run(words);
        assert_eq!(code, Some(0), "{words}: {said}");
        said
    }

    fn lines(&self, name: &str) -> BTreeMap<u64, Vec<[f64; 2]>> {
        let map: serde_json::Value = serde_json::from_str(&self.read(name)).unwrap();
        let line = |p: &serde_json::Value| {
            let vertices = serde_json::from_value(p["vertices"].clone()).unwrap();
            (p["id"].as_u64().unwrap(), vertices)
        };
        map["polylines"].as_array().unwrap().iter().map(line).collect()
    }
}

fn sample() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../samples/killian.log.gz")
}

fn assert_within_a_millimetre(a: &BTreeMap<u64, Vec<[f64; 2]>>, b: &BTreeMap<u64, Vec<[f64; 2]>>) {
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (id, points) in a {
        assert_eq!(points.len(), b[id].len(), "polyline {id}");
        for (p, q) in points.iter().zip(&b[id]) {
            assert!(
                (p[0] - q[0]).hypot(p[1] - q[1]) < 1e-3,
                "polyline {id}: {p:?} {q:?}"
            );
        }
    }
}

#[test]
fn a_map_comes_back_from_every_drawing_with_ids_and_boxes() {
    let georef = "--georef -33.86,151.21,-75";
    let ways = [
        ("svg", "map.layers.svg", ""),
        ("dxf", "map.dxf", ""),
        ("json-fg", "map.fg.json", ""),
        ("json-fg", "map.fg.json", georef),
        ("geojson", "map.geojson", georef),
    ];
    for (format, file, options) in ways {
        let bench = Bench::new();
        bench.done(&format!("export map.json --to {format} {options}"));
        bench.done(&format!("import {file} -o back.json --base map.json {options}"));
        assert_within_a_millimetre(&bench.lines("back.json"), &bench.lines("map.json"));
        let [before, after] = ["map.json", "back.json"]
            .map(|name| -> serde_json::Value { serde_json::from_str(&bench.read(name)).unwrap() });
        assert_eq!(
            after["polylines"][0]["observations"], before["polylines"][0]["observations"],
            "{format}"
        );
        let corner = |map: &serde_json::Value, k: usize| map["eraser_boxes"][0]["min"][k].as_f64().unwrap();
        // Turned on Earth, the box around a box may be the width of a rounding larger.
        let same = (0..2).all(|k| (corner(&after, k) - corner(&before, k)).abs() < 1e-3);
        assert!(same, "{format}: {after}");
    }
}

/// What Inkscape leaves of an export: the page moved and scaled by the layers' transforms, a line moved, one
/// split in two pieces, one copied, one drawn anew, a text beside.
#[test]
fn an_svg_edited_by_hand_keeps_its_ids_and_finds_its_frame() {
    let bench = Bench::new();
    bench.done("export map.json --to svg");
    let moved = " transform=\"translate(20 -7) scale(0.5)\" id=\"layer-";
    let edited = bench
        .read("map.layers.svg")
        .replace(" id=\"layer-", moved)
        .replace(
            "M345678.9,123456.7 L346000,120000",
            "m 345678.9,123456.7 h 100 m 0 10 v 50",
        )
        .replace(
            "</svg>",
            "<g id=\"g12\" transform=\"translate(20 -7) scale(0.5)\">\
             <path id=\"path99\" d=\"M0,0 H3000\"/><path id=\"path100\" d=\"M1000,-1000 2000,-1000\"/>\
             <text>here</text></g></svg>",
        );
    bench.write("edited.svg", &edited);
    let (code, said) = bench.run("import edited.svg -o back.json");
    assert_eq!(code, Some(3), "{said}");
    assert!(said.contains("left out: 1 × <text>"), "{said}");
    assert!(said.contains("3 with their id, 3 new"), "{said}");
    let mut expected = bench.lines("map.json");
    expected.insert(3, vec![[345.6789, -123.4567], [345.7789, -123.4567]]);
    expected.insert(4_000_000_001, vec![[345.7789, -123.4667], [345.7789, -123.5167]]);
    expected.insert(4_000_000_002, vec![[0.0, 0.0], [3.0, 0.0]]);
    expected.insert(4_000_000_003, vec![[1.0, 1.0], [2.0, 1.0]]);
    assert_within_a_millimetre(&bench.lines("back.json"), &expected);
}

#[test]
fn vertices_that_were_moved_lose_their_evidence_and_others_keep_it() {
    let bench = Bench::new();
    bench.done("export map.json --to dxf");
    let edited = bench
        .read("map.dxf")
        .replacen("12.3457\r\n 20\r\n0.0", "12.5\r\n 20\r\n0.0", 1);
    bench.write("edited.dxf", &edited);
    bench.done("import edited.dxf -o back.json --base map.json");
    let map: serde_json::Value = serde_json::from_str(&bench.read("back.json")).unwrap();
    let line = &map["polylines"][0];
    assert_eq!(line["vertices"][1], serde_json::json!([12.5, 0.0]));
    assert_eq!(line["observations"], serde_json::json!([4, 0, 2]));
    assert_eq!(line["sigma_m"], serde_json::json!([0.004, null, null]));
}

#[test]
fn a_dxf_in_millimetres_is_taken_as_such() {
    let bench = Bench::new();
    let dxf = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n\
               10\n1000\n20\n0\n11\n1000\n21\n2500\n0\nCIRCLE\n8\n0\n10\n0\n20\n0\n40\n5\n0\nENDSEC\n0\nEOF\n";
    bench.write("plan.dxf", dxf);
    let (code, said) = bench.run("import plan.dxf -o back.json");
    assert!(code == Some(3) && said.contains("left out: 1 × CIRCLE"), "{said}");
    assert_eq!(bench.lines("back.json")[&0], [[1.0, 0.0], [1.0, 2.5]]);
}

#[test]
fn without_scans_the_grid_has_walls_and_nothing_is_called_free() {
    let bench = Bench::new();
    let said = bench.done("export map.json --to nav2");
    assert!(said.contains("note: nav2: no scans, so no free space"), "{said}");
    let pgm = fs::read(bench.path("map.pgm")).unwrap();
    let cells = &pgm[pgm.len() - 1000 * 1000..];
    assert!(cells.contains(&205) && !cells.contains(&254));
    assert!(pgm.contains(&0));
}

#[test]
fn what_a_format_cannot_do_without_is_named() {
    let bench = Bench::new();
    let fault = |words: &str| {
        let (code, said) = bench.run(words);
        assert_eq!(code, Some(1), "{words}: {said}");
        said
    };
    assert!(fault("export map.json --to geojson").contains("give --georef lat,lon,bearing, or take json-fg"));
    assert!(fault("export map.json --to tum").contains("tum needs the trajectory: give --trajectory"));
    assert!(fault("export map.json --to carmen").contains("give --log LOG --trajectory"));
    assert!(fault("export map.json --to nav2 --resolution 0.001").contains("choose a coarser --resolution"));
    assert!(fault("export map.json --to dxf --name a/b").contains("folders go to --output"));
    let log = sample().display().to_string();
    assert!(fault(&format!("export map.json --to nav2 --log {log}")).contains("give --trajectory"));
    bench.write("other.csv", &format!("{HEAD}0,12.5,0,0,0,placed,\n"));
    let other = fault(&format!(
        "export map.json --to nav2 --log {log} --trajectory other.csv"
    ));
    assert!(
        other.contains("the trajectory is not of this log: scan 0 has the stamp"),
        "{other}"
    );
    assert_eq!(bench.run("export map.json --to dwg").0, Some(2));
    assert_eq!(bench.run("export map.json --to gpkg --georef 95,0,0").0, Some(2));
    assert!(!bench.path("map.pgm").exists() && !bench.path("map.tum").exists());
}

#[test]
fn a_build_with_exports_and_an_export_later_give_the_same_bytes() {
    let bench = Bench::new();
    let log = sample().display().to_string();
    let formats = "nav2,nav2-vector,rmf,dxf,svg,json-fg,gpkg,mcap,tum,kitti,g2o,carmen";
    bench.done(&format!("build {log} -o out --export {formats}"));
    bench.done(&format!(
        "export out/map.json --to {formats} --log {log} -o again"
    ));
    let mut files = 0;
    for entry in fs::read_dir(bench.path("again")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap();
        let same = fs::read(&path).unwrap() == fs::read(bench.path("out").join(name)).unwrap();
        assert!(same, "{}", path.display());
        files += 1;
    }
    assert_eq!(files, 13);
}

#[test]
fn the_log_of_an_export_is_read_as_it_was_for_the_map() {
    let bench = Bench::new();
    let rows = format!("2.5 {}\n", ["1.5"; 60].join(" ")).repeat(3);
    bench.write("x.txt", &rows);
    let rows: String = (0..3).map(|k| format!("{k},,0,0,0,placed,\n")).collect();
    bench.write("trajectory.csv", &format!("{HEAD}{rows}"));
    let (code, said) = bench.run("export map.json --to carmen --log x.txt");
    assert_eq!(code, Some(1), "{said}");
    let words = ["export", "map.json", "--to", "carmen", "--layout"];
    let layout = "skip range_m*60 first_deg=-90 step_deg=3";
    let run = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_polymapper"));
        command.args(words).arg(layout).args(more);
        command
            .current_dir(bench.0.path())
            .output()
            .unwrap()
            .status
            .code()
    };
    assert_eq!(run(&[]), Some(2), "a layout without a log is wrong usage");
    assert_eq!(run(&["--log", "x.txt", "--salvage"]), Some(0));
    let line = "ROBOTLASER1 0 -1.5707963267948966 ";
    assert_eq!(bench.read("map.corrected.log").matches(line).count(), 3);
}

#[test]
fn a_corrected_log_and_a_graph_hold_the_poses_of_the_trajectory() {
    let bench = Bench::new();
    let log = sample().display().to_string();
    bench.done(&format!("build {log} -o out --export carmen,g2o"));
    let numbers =
        |text: &str| -> Vec<f64> { text.split_whitespace().filter_map(|n| n.parse().ok()).collect() };
    let trajectory = bench.read("out/trajectory.csv");
    let way: Vec<Vec<f64>> = trajectory
        .lines()
        .skip(1)
        .map(|row| numbers(&row.replace(',', " "))[2..5].to_vec())
        .collect();
    let corrected = bench.read("out/map.corrected.log");
    let lines: Vec<&str> = corrected.lines().filter(|l| l.starts_with("FLASER")).collect();
    assert_eq!(lines.len(), way.len());
    for (line, pose) in lines.iter().zip(&way) {
        let all = numbers(line);
        let beams = all[0] as usize;
        assert_eq!(&all[1 + beams..4 + beams], pose.as_slice());
    }
    // Edges lead from vertex to vertex: to the next, and to a place that was known.
    let graph = bench.read("out/map.g2o");
    let mut edges = 0;
    for edge in graph.lines().filter(|l| l.starts_with("EDGE_SE2")).map(numbers) {
        let [a, b] = [&way[edge[0] as usize], &way[edge[1] as usize]];
        let (sin, cos) = a[2].sin_cos();
        let (x, y) = (
            a[0] + cos * edge[2] - sin * edge[3],
            a[1] + sin * edge[2] + cos * edge[3],
        );
        assert!((x - b[0]).hypot(y - b[1]) < 1e-4);
        edges += 1;
    }
    let recognised = trajectory
        .lines()
        .skip(1)
        .filter(|row| row.split(',').nth(7).is_some_and(|scan| !scan.is_empty()))
        .count();
    assert!(recognised > 0, "the loop in the sample is closed");
    assert_eq!(edges, way.len() - 1 + recognised);
    // The log is one again.
    bench.done("extract out/map.corrected.log -o lines.jsonl");
}
