//! What a user of the pictures relies on: the same bytes every time, valid files, true places, and no panic.

mod worlds;

use polymapper_core::geometry::{Point, Pose};
use polymapper_core::map::Map;
use polymapper_draw::figures::{Apart, Overview, Stage, correspondence, levels, overview};
use polymapper_draw::{
    Bounds, Extent, Fill, Grid, Label, Layer, Mark, Panel, Radius, Scene, Stroke, TrajectoryPoint,
    map_picture, palette, to_png, to_svg,
};

use worlds::{closed_room, drawn, ink_at, pixel_of};

/// Set this variable to write the expected file anew; look at the difference before committing it.
const RENEW: &str = "POLYMAPPER_RENEW_GOLDEN";

#[test]
fn the_svg_of_a_small_map_is_the_expected_text() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/room.svg");
    let svg = to_svg(&worlds::small_map());
    if std::env::var_os(RENEW).is_some() {
        std::fs::write(file, &svg).unwrap();
    }
    let expected = std::fs::read_to_string(file).unwrap();
    for (k, (line, wanted)) in svg.lines().zip(expected.lines()).enumerate() {
        assert_eq!(line, wanted, "line {}", k + 1);
    }
    assert_eq!(svg.len(), expected.len());
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    let scene = worlds::small_map();
    assert_eq!(to_svg(&scene), to_svg(&scene));
    assert_eq!(to_png(&scene).unwrap(), to_png(&scene).unwrap());
}

#[test]
fn the_png_shows_walls_where_the_svg_says_they_are() {
    let scene = closed_room(4.0, 3.0);
    let image = drawn(&scene);
    assert_eq!(image.width.max(image.height), 2000);
    for at in [(0.0, 1.5), (4.0, 1.5), (2.0, 0.0), (2.0, 3.0), (1.0, 0.0)] {
        assert!(ink_at(&image, pixel_of(&scene, at)) < 80, "no wall at {at:?}");
    }
    for at in [(2.0, 1.5), (3.9, 1.5), (2.0, 2.9)] {
        assert_eq!(ink_at(&image, pixel_of(&scene, at)), 255, "ink at {at:?}");
    }
}

#[test]
fn dashes_have_gaps_and_the_y_axis_points_up() {
    let stroke = Stroke::new(palette::INK, 4.0).dash(polymapper_draw::Dash::Dashed);
    let mut layer = Layer::new("dashed");
    layer.line([Point::new(0.0, 3.0), Point::new(4.0, 3.0)], stroke);
    layer.line(
        [Point::new(0.0, 0.0), Point::new(4.0, 0.0)],
        Stroke::new(palette::INK, 4.0),
    );
    let scene = Scene::of(Panel::new("").with(layer));
    let image = drawn(&scene);
    let along = |y: f64| -> Vec<u8> {
        (100..300)
            .map(|k| ink_at(&image, pixel_of(&scene, (f64::from(k) / 100.0, y))))
            .collect()
    };
    let dashed = along(3.0);
    assert!(dashed.contains(&255), "no gaps");
    assert!(dashed.iter().any(|v| *v < 80), "no dashes");
    assert!(along(0.0).iter().all(|v| *v < 80), "the solid line has gaps");
    let (_, upper) = pixel_of(&scene, (2.0, 3.0));
    let (_, lower) = pixel_of(&scene, (2.0, 0.0));
    assert!(upper < lower);
}

#[test]
fn the_size_is_bounded_whatever_the_extent() {
    for (width_m, height_m) in [(1e-3, 1e-3), (0.5, 400.0), (400.0, 0.5), (1e7, 1e7), (3.0, 0.0)] {
        let scene = closed_room(width_m, height_m).with_caption("word ".repeat(3000));
        let image = drawn(&scene);
        let longest = image.width.max(image.height);
        assert!(
            (1600..=2400).contains(&longest),
            "{width_m} by {height_m}: {longest} px"
        );
    }
}

#[test]
fn text_from_outside_stays_text() {
    let mut scene = closed_room(2.0, 2.0)
        .with_title("<script>&\"\u{7}")
        .with_caption("a < b & c > \"d\"");
    scene.panels[0].title = "</g>".to_owned();
    scene.panels[0].layers[0].name = "\"><image href='x'/>".to_owned();
    let svg = to_svg(&scene);
    assert!(svg.contains("a &lt; b &amp; c &gt; &quot;d&quot;"));
    assert!(!svg.contains("<script>") && !svg.contains("<image") && !svg.contains('\u{7}'));
    assert_eq!(svg.matches("<g ").count(), svg.matches("</g>").count());
}

#[test]
fn points_that_are_no_numbers_are_left_out() {
    let wild = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e308,
        -1e308,
        1e300,
        0.0,
        1.0,
        2.0,
    ];
    let points: Vec<Point> = wild
        .iter()
        .flat_map(|x| wild.iter().map(|y| Point::new(*x, *y)))
        .collect();
    let stroke = Stroke {
        arrow: true,
        width_px: f64::NAN,
        ..Stroke::new(palette::INK, 1.0)
    };
    for extent in [
        Extent::All,
        Extent::Robust,
        Extent::Fixed(Bounds {
            min: points[0],
            max: points[1],
        }),
    ] {
        let mut layer = Layer::new("wild");
        layer.line(points.clone(), stroke);
        layer.dots(points.clone(), f64::INFINITY, palette::BLUE);
        layer.marks.push(Mark::Polygon {
            corners: points.clone(),
            colour: palette::SHADE,
        });
        for p in &points {
            layer.marks.push(Mark::Circle {
                centre: *p,
                radius: Radius::Metres(p.x),
                fill: Some(Fill::Hatched(palette::ORANGE)),
                stroke: Some(stroke),
            });
            layer.marks.push(Mark::Rectangle {
                bounds: Bounds {
                    min: *p,
                    max: points[40],
                },
                fill: Some(Fill::Hatched(palette::ORANGE)),
                stroke: Some(stroke),
            });
            layer.marks.push(Mark::Label(Label {
                at: *p,
                text: "wild".to_owned(),
                subscript: "1".to_owned(),
                colour: palette::INK,
                face: polymapper_draw::Face::Italic,
                side: Some(*p),
            }));
        }
        let panel = Panel::new("wild")
            .with(layer)
            .with_extent(extent)
            .with_grid(Grid::Every(f64::MIN_POSITIVE));
        let scene = Scene::of(panel);
        let svg = to_svg(&scene);
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{extent:?}");
        drawn(&scene);
    }
}

#[test]
fn stray_polylines_are_counted_instead_of_shrinking_the_map() {
    let mut map = worlds::room_map();
    for k in 0_u32..300 {
        let x = f64::from(k % 20) * 0.2;
        map.polylines
            .push(worlds::map_polyline(&[(x, 1.0), (x + 0.1, 1.0)]));
    }
    map.polylines
        .push(worlds::map_polyline(&[(1e6, 0.0), (1e6, 1.0)]));
    let scene = map_picture(&map, &[], "");
    assert!(
        scene.caption.contains("1 polyline beyond the edge"),
        "{}",
        scene.caption
    );
    let shown = scene.panels[0].bounds().unwrap();
    assert!(shown.width_m() < 20.0, "{shown:?}");
}

#[test]
fn nothing_at_all_is_drawn_as_such() {
    let lost = [TrajectoryPoint {
        map_from_scan: Pose::new(f64::NAN, 0.0, 0.0),
        placed: false,
        is_uncertain: false,
    }];
    let empty = Map::default();
    let scenes = [
        Scene::of_panels(Vec::new()),
        map_picture(&empty, &[], ""),
        map_picture(&empty, &lost, "t"),
        overview(&Overview {
            odometry: None,
            rotation_corrected: None,
            aligned: None,
            map: &empty,
        }),
        levels(
            &[],
            &[Stage {
                title: "grouped".to_owned(),
                polylines: Vec::new(),
            }],
        ),
        correspondence(&[], &[], &[(0, 0)], Apart::SideBySide),
    ];
    for scene in &scenes {
        drawn(scene);
    }
    assert!(to_svg(&scenes[1]).contains("the map is empty"));
    assert_eq!(to_svg(&scenes[3]).matches("no odometry in this log").count(), 2);
}

#[test]
fn a_way_over_scans_without_a_place_is_dotted() {
    let at = |k: u32, placed| TrajectoryPoint {
        map_from_scan: Pose::new(f64::from(k) * 0.2, 1.0, 0.0),
        placed,
        is_uncertain: false,
    };
    let trajectory: Vec<TrajectoryPoint> = (0..10).map(|k| at(k, k != 5)).collect();
    let scene = map_picture(&worlds::room_map(), &trajectory, "");
    assert!(to_svg(&scene).contains("stroke-dasharray"));
    assert!(
        scene.caption.contains("9 of 10 scans placed"),
        "{}",
        scene.caption
    );
}

#[test]
fn the_way_stands_out_where_the_place_is_uncertain_and_the_legend_says_so() {
    let picture = |uncertain: &[u32]| {
        let at = |k: u32| TrajectoryPoint {
            map_from_scan: Pose::new(0.5 + f64::from(k) * 0.3, 2.0, 0.0),
            placed: true,
            is_uncertain: uncertain.contains(&k),
        };
        let trajectory: Vec<TrajectoryPoint> = (0..10).map(at).collect();
        map_picture(&worlds::room_map(), &trajectory, "")
    };
    let legend = "way where the place is uncertain";
    let (certain, doubtful) = (picture(&[]), picture(&[1, 4, 5, 6]));
    assert!(!to_svg(&certain).contains(legend));
    assert!(to_svg(&doubtful).contains(legend));
    let orange = |at: (f64, f64)| {
        let (before, after) = (drawn(&certain), drawn(&doubtful));
        let pixel = |scene, image| ink_at(image, pixel_of(scene, at));
        pixel(&certain, &before) != pixel(&doubtful, &after)
    };
    assert!(orange((2.0, 2.0)), "between scans 4 and 6");
    assert!(orange((0.8, 2.0)), "scan 1 alone");
    assert!(!orange((1.4, 2.0)) && !orange((2.6, 2.0)), "elsewhere");
}

#[test]
fn millions_of_points_become_a_small_drawing() {
    let circle = |k: u32| Point::from_polar(3.0 + f64::from(k % 7) * 0.002, f64::from(k) * 0.001);
    let scan: Vec<Point> = (0..200_000).map(circle).collect();
    let scans = vec![(Pose::IDENTITY, scan); 10];
    let input = Overview {
        odometry: None,
        rotation_corrected: None,
        aligned: Some(&scans),
        map: &Map::default(),
    };
    let svg = to_svg(&overview(&input));
    assert!(svg.len() < 300_000, "{} bytes", svg.len());
}
