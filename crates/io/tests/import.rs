//! Drawings that are cut, wrong or meant to do harm: a clear error, bounded time and memory, no panic.

#![expect(clippy::unwrap_used, reason = "a test may fail by panic")]

use polymapper_io::import::{ImportOptions, import_bytes};

fn fault(text: &str) -> String {
    fault_with(text, &ImportOptions::default())
}

fn fault_with(text: &str, options: &ImportOptions) -> String {
    import_bytes("drawing", text.as_bytes(), options)
        .unwrap_err()
        .to_string()
}

fn svg(inside: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" data-metres-per-unit=\"0.001\">{inside}</svg>")
}

#[test]
fn what_is_no_drawing_is_told_by_what_it_begins_with() {
    assert!(fault("").contains("it begins with nothing"));
    assert!(fault("FLASER 3 1 2 3").contains("it begins with \"FLASER 3 1 2 3\""));
    assert!(fault("AutoCAD Binary DXF\r\n").contains("no SVG, DXF (text)"));
    assert!(fault("<html/>").contains("the root is <html>, <svg> is expected"));
    assert!(fault("<svg").contains("no XML"));
    assert!(fault("{\"a\": 1").contains("no JSON"));
    assert!(fault("{\"a\": 1}").contains("`type` is missing"));
    assert!(fault("{\"format\": \"polymapper-map\", \"version\": 9}").contains("version 9"));
}

#[test]
fn faults_name_their_place() {
    assert!(fault("0\nSECTION\n2\nENTITIES\n0\nLINE\n10\nx\n0\nENDSEC\n0\nEOF\n").contains("line 8: \"x\""));
    assert!(fault("0\nSECTION\n2\nENTITIES\nLINE\n").contains("line 5: a code without a value"));
    assert!(fault("0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n1\n20\n1\n").contains("the file is cut"));
    assert!(fault("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n19\n0\nEOF\n").contains("$INSUNITS is 19"));
    assert!(fault(&svg("<path d=\"M0 0 L\"/>")).contains("line 1, <path>: path data"));
    assert!(fault(&svg("<g transform=\"spin(3)\"/>")).contains("transform \"spin(3)\" is not understood"));
    assert!(fault("<svg><path d=\"M0 0 1 1\"/></svg>").contains("give --metres-per-unit"));
    assert!(fault(&svg("<path d=\"M0 0 1e300 1\"/>")).contains("are the units right?"));
    let line = |members: &str| {
        format!("{{\"type\":\"FeatureCollection\",\"features\":[{{\"type\":\"Feature\",{members}}}]}}")
    };
    let geometry = "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[1,2],[3,\"x\"]]}";
    assert!(fault(&line(geometry)).contains("feature 0: a GeoJSON `geometry` is longitude and latitude"));
    let metres = ImportOptions {
        metres_per_unit: Some(1.0),
        ..ImportOptions::default()
    };
    assert!(fault_with(&line(geometry), &metres).contains("the position [3,\"x\"] is no pair of numbers"));
    let place =
        "\"place\":{\"type\":\"LineString\",\"coordinates\":[[1,2],[3,4]]},\"coordRefSys\":\"[EPSG:32632]\"";
    assert!(fault(&line(place)).contains("it lies in [EPSG:32632]: give --georef"));
    assert!(fault(&line(&place.replace("32632", "5800"))).contains("UTM or CRS84 are expected"));
}

#[test]
fn things_that_unfold_are_stopped() {
    // A billion laughs.
    let mut dtd = String::from("<!DOCTYPE svg [<!ENTITY a0 \"<path d='M0 0 1 1'/>\">");
    for k in 1..12 {
        dtd.push_str(&format!(
            "<!ENTITY a{k} \"{}\">",
            format!("&a{};", k - 1).repeat(10)
        ));
    }
    assert!(fault(&format!("{dtd}]>{}", svg("&a11;"))).contains("no XML"));
    // Groups without end.
    let deep = svg(&("<g>".repeat(100_000) + &"</g>".repeat(100_000)));
    assert!(fault(&deep).contains("groups nested more than 256 deep"));
    // Lists without end.
    assert!(fault(&format!("{{\"type\":{}", "[".repeat(1_000_000))).contains("no JSON"));
    // Curves of many sides, many times.
    let curves = "C9e6 9e6 -9e6 -9e6 1 1 ".repeat(40_000);
    let path = format!("<path d=\"M0 0 {curves}\"/>");
    assert!(fault(&svg(&path.repeat(20))).contains("20 × line 1, <path>: a path of too many points"));
    // Boxes that each would be compared with all others.
    let boxes: String = (0..20_000)
        .map(|k| format!("<rect x=\"{k}\" width=\"0.5\" height=\"1\"/>"))
        .collect();
    let boxes = svg(&format!("<g id=\"layer-eraser-boxes\">{boxes}</g>"));
    assert!(fault(&boxes).contains("more than 10000 eraser boxes"));
}

#[test]
fn numbers_that_are_none_never_reach_the_map() {
    for number in ["NaN", "inf", "1e999", "-1e999"] {
        let dxf = format!(
            "0\nSECTION\n2\nENTITIES\n0\nLINE\n10\n{number}\n20\n0\n11\n1\n21\n1\n0\nENDSEC\n0\nEOF\n"
        );
        fault(&dxf);
        fault(&svg(&format!("<line x1=\"{number}\" x2=\"1\"/>")));
        fault(&svg(&format!(
            "<g transform=\"scale({number})\"><line x2=\"1\"/></g>"
        )));
        fault(&svg(&format!("<path d=\"M0 0 L{number} 1\"/>")));
    }
}

#[test]
fn ids_are_each_given_once() {
    let lines = [5, 5, u64::MAX].map(|id| format!("<path id=\"polyline-{id}\" d=\"M0 0 1000 0\"/>"));
    let drawing = svg(&(lines.concat() + "<path d=\"M0 0 0 1000\"/>"));
    let imported = import_bytes("d.svg", drawing.as_bytes(), &ImportOptions::default()).unwrap();
    let ids: Vec<u64> = imported.map.polylines.iter().map(|p| p.id).collect();
    assert_eq!(ids, [5, 0, u64::MAX, 1]);
    assert_eq!((imported.kept_ids, imported.new_ids), (2, 2));
}

/// Thousands of drawings with bytes changed, cut out and doubled at random (the same every time).
#[test]
fn broken_drawings_never_panic() {
    let dxf = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nPOLYLINE\n8\nWALLS\n66\n1\n70\n1\n\
               1001\nPOLYMAPPER\n1000\nid=4\n0\nVERTEX\n10\n1.5\n20\n-2\n42\n0.5\n0\nVERTEX\n10\n3\n20\n4\n0\nSEQEND\n\
               0\nLWPOLYLINE\n8\nERASER_BOXES\n90\n2\n10\n1\n20\n2\n10\n3\n20\n5\n0\nENDSEC\n0\nEOF\n";
    let drawing = svg(
        "<g id=\"layer-frame\"><path id=\"polymapper-frame\" d=\"M1000,0 L0,0 L0,-1000\"/></g>\
                       <g id=\"layer-eraser-boxes\" transform=\"rotate(3 1,2) skewX(4)\"><rect width=\"5\" height=\"6.5\"/></g>\
                       <path id=\"polyline-3\" d=\"m1 2 3 4H5v-6c1 2 3 4 5 6s1 2 3 4q1 2 3 4t-5-6z\"/><polygon points=\"1,2 3,4 5 6\"/>",
    );
    let json = "{\"type\":\"FeatureCollection\",\"coordRefSys\":\"http://www.opengis.net/def/crs/OGC/0/Engineering2D\",\"features\":[\
                {\"type\":\"Feature\",\"id\":4,\"featureType\":\"walls\",\"place\":{\"type\":\"MultiLineString\",\"coordinates\":\
                [[[1.5,2],[3,4e2]]]},\"properties\":{\"id\":4,\"observations\":[1,2],\"sigma_m\":\"[0.1,null]\"}}]}";
    let mut state = 1_u64;
    let mut dice = |sides: usize| {
        // Knuth's constants; the upper half of the bits is good enough here.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % sides.max(1)
    };
    let options = ImportOptions {
        georef: "48,7.8,90".parse().ok(),
        ..ImportOptions::default()
    };
    let mut read = 0;
    for round in 0..30_000 {
        let mut bytes = [dxf, &drawing, json][round % 3].as_bytes().to_vec();
        for _ in 0..1 + dice(4) {
            let (at, length) = (dice(bytes.len()), dice(12));
            let end = (at + length).min(bytes.len());
            match dice(4) {
                0 => bytes.truncate(at),
                1 => drop(bytes.drain(at..end)),
                2 => {
                    let again = bytes[at..end].to_vec();
                    bytes.splice(at..at, again);
                }
                _ => {
                    if let Some(b) = bytes.get_mut(at) {
                        *b = b"0123456789.eE-+\"<>[]{}(),:Zz \n\xff"[dice(30)];
                    }
                }
            }
        }
        if let Ok(imported) = import_bytes("broken", &bytes, &options) {
            read += 1;
            let all = imported.map.polylines.iter().flat_map(|p| &p.vertices);
            assert!(
                all.into_iter()
                    .all(|v| v.point.x.is_finite() && v.point.y.is_finite())
            );
        }
    }
    assert!(read > 1000, "{read} read: the test hardly gets into the readers");
}
