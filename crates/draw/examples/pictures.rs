//! Draws an invented flat in all kinds of pictures: `cargo run --example pictures -- DIRECTORY`.
//!
//! The flat is scanned by casting rays, so that the pictures look like those of real logs; poses drift on purpose.

use std::path::Path;

use polymapper_core::geometry::{Point, Polyline, Pose, Segment};
use polymapper_core::map::{EraserBox, Map, MapPolyline, MapVertex};
use polymapper_draw::figures::{
    Apart, Overview, Stage, VertexRule, correspondence, levels, overview, vertex_rule,
};
use polymapper_draw::{Scene, TrajectoryPoint, map_picture, to_png, to_svg};

/// Walls, free space on the left.
const WALLS: &[&[(f64, f64)]] = &[
    // Outer wall seen from the hall and the two rooms below.
    &[
        (4.0, 3.2),
        (4.0, 4.0),
        (0.0, 4.0),
        (0.0, 0.0),
        (6.0, 0.0),
        (6.0, 3.2),
        (5.0, 3.2),
    ],
    &[
        (6.2, 3.2),
        (6.2, 0.0),
        (13.0, 0.0),
        (13.0, 1.2),
        (13.6, 1.2),
        (13.6, 3.2),
        (8.0, 3.2),
    ],
    &[(7.0, 3.2), (6.2, 3.2)],
    // Hall and the rooms above.
    &[(8.0, 3.4), (13.6, 3.4), (13.6, 5.2), (11.2, 5.2)],
    &[(10.2, 5.2), (4.2, 5.2), (4.2, 4.0)],
    &[
        (11.2, 5.4),
        (13.6, 5.4),
        (13.6, 8.2),
        (12.6, 9.2),
        (6.0, 9.2),
        (6.0, 5.4),
        (10.2, 5.4),
    ],
];

/// A round pillar and a cupboard, walked round clockwise so that free space is on the left.
fn furniture() -> Vec<Vec<(f64, f64)>> {
    let pillar = (0..=12).map(|k| {
        let p = Point::from_polar(0.3, -f64::from(k) * std::f64::consts::TAU / 12.0);
        (9.0 + p.x, 7.0 + p.y)
    });
    vec![
        pillar.collect(),
        vec![(1.0, 1.0), (1.0, 1.5), (2.2, 1.5), (2.2, 1.0), (1.0, 1.0)],
    ]
}

fn walls() -> Vec<Polyline> {
    let fixed = WALLS.iter().map(|w| w.to_vec());
    fixed
        .chain(furniture())
        .filter_map(|w| Polyline::new(w.into_iter().map(|(x, y)| Point::new(x, y)).collect()).ok())
        .collect()
}

fn map_of(polylines: &[Polyline], eraser_boxes: Vec<EraserBox>) -> Map {
    let vertex = |point: &Point| MapVertex {
        point: *point,
        observations: 9,
        sigma_m: 0.01,
    };
    let polyline = |(id, p): (usize, &Polyline)| MapPolyline {
        id: id as u64,
        vertices: p.vertices().iter().map(vertex).collect(),
    };
    Map {
        polylines: polylines.iter().enumerate().map(polyline).collect(),
        eraser_boxes,
    }
}

/// The way through the flat, a scan every `step_m`.
fn way(step_m: f64) -> Vec<Pose> {
    let corners = [
        (3.0, 2.0),
        (4.6, 2.4),
        (4.6, 4.6),
        (7.4, 4.4),
        (7.6, 2.0),
        (11.5, 1.6),
        (11.8, 2.4),
        (7.8, 2.4),
        (7.6, 4.3),
        (10.6, 4.4),
        (10.7, 6.2),
        (12.4, 7.6),
        (7.4, 8.2),
        (7.2, 6.2),
    ];
    let corners: Vec<Point> = corners.map(|(x, y)| Point::new(x, y)).into();
    let mut poses = Vec::new();
    for side in corners.windows(2) {
        let side = Segment::new(side[0], side[1]);
        let steps = (side.length_m() / step_m).ceil() as i32;
        let heading_rad = (side.b - side.a).bearing_rad();
        poses.extend((0..steps).map(|k| {
            let p = side.at(f64::from(k) / f64::from(steps));
            Pose::new(
                p.x + 0.05 * (3.0 * p.y).sin(),
                p.y + 0.05 * (2.0 * p.x).sin(),
                heading_rad,
            )
        }));
    }
    poses
}

/// Noise that is the same every time.
struct Noise(u64);

impl Noise {
    /// Roughly normal, standard deviation 1.
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (uniform() + uniform() + uniform() - 1.5) * 2.0
    }
}

fn scan(pose: Pose, walls: &[Polyline], beams: u32, noise: &mut Noise) -> Vec<Point> {
    let range = |bearing_rad: f64| {
        let towards = pose.rotate(Point::from_polar(1.0, bearing_rad));
        let hits = walls.iter().flat_map(Polyline::sides);
        hits.filter_map(|side| side.meet_ray(pose.translation(), towards))
            .map(|(t, _)| t)
            .min_by(f64::total_cmp)
    };
    (0..beams)
        .map(|k| std::f64::consts::TAU * f64::from(k) / f64::from(beams))
        .filter_map(|bearing| Some(Point::from_polar(range(bearing)? + 0.01 * noise.next(), bearing)))
        .collect()
}

/// Groups at a gap of 0.2 m, and keeps every vertex whose removal would cost more than `level_mm`.
fn simplified(points: &[Point], level_mm: f64) -> Vec<Polyline> {
    let mut groups: Vec<Vec<Point>> = Vec::new();
    for p in points {
        match groups.last_mut() {
            Some(group) if group.last().is_some_and(|q| q.distance(*p) < 0.2) => group.push(*p),
            _ => groups.push(vec![*p]),
        }
    }
    groups
        .into_iter()
        .filter_map(|group| Polyline::new(evolved(group, level_mm / 1000.0)).ok())
        .collect()
}

fn evolved(mut group: Vec<Point>, level_m: f64) -> Vec<Point> {
    loop {
        let cost = |w: &[Point]| w[0].distance(w[1]) + w[1].distance(w[2]) - w[0].distance(w[2]);
        let least = group
            .windows(3)
            .map(cost)
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match least {
            Some((k, cost)) if cost < level_m => drop(group.remove(k + 1)),
            _ => return group,
        }
    }
}

fn drifted(poses: &[Pose], by: f64) -> Vec<Pose> {
    let mut at = poses[0];
    let mut drifted = vec![at];
    for step in poses.windows(2) {
        let motion = step[0].inverse() * step[1];
        at = at * Pose::new(1.03 * motion.x, motion.y, motion.theta_rad + by * motion.x.abs());
        drifted.push(at);
    }
    drifted
}

fn map_scene(walls: &[Polyline]) -> Scene {
    let plants = vec![
        EraserBox {
            min: Point::new(12.2, 0.2),
            max: Point::new(12.9, 1.0),
        },
        EraserBox {
            min: Point::new(6.2, 8.2),
            max: Point::new(6.9, 9.1),
        },
    ];
    let placed = |(k, pose): (usize, Pose)| TrajectoryPoint {
        map_from_scan: pose,
        placed: !(60..66).contains(&k),
        is_uncertain: false,
    };
    let trajectory: Vec<TrajectoryPoint> = way(0.2).into_iter().enumerate().map(placed).collect();
    map_picture(&map_of(walls, plants), &trajectory, "An invented flat")
}

fn overview_scene(walls: &[Polyline], with_odometry: bool) -> Scene {
    let poses = way(0.1);
    let mut noise = Noise(7);
    let scans: Vec<Vec<Point>> = poses
        .iter()
        .map(|pose| scan(*pose, walls, 720, &mut noise))
        .collect();
    let laid = |poses: &[Pose]| {
        poses
            .iter()
            .copied()
            .zip(scans.iter().cloned())
            .collect::<Vec<_>>()
    };
    let (raw, corrected, aligned) = (
        laid(&drifted(&poses, 0.05)),
        laid(&drifted(&poses, 0.0)),
        laid(&poses),
    );
    overview(&Overview {
        odometry: with_odometry.then_some(&raw),
        rotation_corrected: with_odometry.then_some(&corrected),
        aligned: Some(&aligned),
        map: &map_of(walls, Vec::new()),
    })
}

fn levels_scene(walls: &[Polyline]) -> Scene {
    let points = scan(Pose::new(9.8, 6.0, 0.3), walls, 361, &mut Noise(3));
    let stage = |title: &str, level_mm| Stage {
        title: title.to_owned(),
        polylines: simplified(&points, level_mm),
    };
    let stages = [
        stage("grouped", 0.0),
        stage("DCE level 1", 1.0),
        stage("DCE level 5", 5.0),
        stage("DCE level 10", 10.0),
        stage("DCE level 15", 15.0),
    ];
    levels(&points, &stages)
}

fn correspondence_scene(walls: &[Polyline], apart: Apart) -> Scene {
    let long = |p: &Polyline| p.length_m() > 0.8;
    let seen = |pose, seed| -> Vec<Polyline> {
        simplified(&scan(pose, walls, 361, &mut Noise(seed)), 20.0)
            .into_iter()
            .filter(long)
            .collect()
    };
    let (at_first, at_second) = (Pose::new(8.0, 8.0, 0.2), Pose::new(10.6, 6.0, 0.9));
    let (first, second) = (seen(at_first, 1), seen(at_second, 2));
    // The flat is known here, so what lies on the same wall is matched.
    let near = |a: &Polyline, b: &Polyline| {
        let (a, b) = (a.transformed(at_first), b.transformed(at_second));
        let middles = b.sides().map(|side| side.at(0.5));
        middles
            .filter(|p| a.sides().any(|side| side.distance(*p) < 0.1))
            .count()
            > 0
    };
    let all = (0..first.len()).flat_map(|a| (0..second.len()).map(move |b| (a, b)));
    let pairs: Vec<(usize, usize)> = all.filter(|(a, b)| near(&first[*a], &second[*b])).collect();
    correspondence(&first, &second, &pairs, apart)
}

fn vertex_rule_scene() -> Option<Scene> {
    let p = Point::new;
    Some(vertex_rule(&VertexRule {
        map_polyline: Polyline::new(vec![p(2.0, 1.02), p(2.52, 1.0), p(2.56, 1.6)]).ok()?,
        scan_polyline: Polyline::new(vec![p(1.9, 0.97), p(2.49, 0.965), p(2.585, 1.03), p(2.60, 1.7)])
            .ok()?,
        vertex: p(2.52, 1.0),
        simulated: [p(2.44, 0.9654), p(2.5872, 1.1)],
        closest: [p(2.4414, 1.003), p(2.5267, 1.1038)],
        nearest_to_vertex: p(2.5342, 0.9952),
        new_point: p(2.5226, 0.9992),
    }))
}

fn write(directory: &Path, name: &str, scene: &Scene) -> Result<(), Box<dyn std::error::Error>> {
    let start = std::time::Instant::now();
    let svg = to_svg(scene);
    let svg_ms = start.elapsed().as_millis();
    let png = to_png(scene)?;
    let png_ms = start.elapsed().as_millis() - svg_ms;
    println!(
        "{name}: svg {} kB in {svg_ms} ms, png {} kB in {png_ms} ms",
        svg.len() / 1000,
        png.len() / 1000
    );
    std::fs::write(directory.join(format!("{name}.svg")), svg)?;
    std::fs::write(directory.join(format!("{name}.png")), png)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let directory = std::env::args().nth(1).ok_or("usage: pictures DIRECTORY")?;
    let directory = Path::new(&directory);
    std::fs::create_dir_all(directory)?;
    let walls = walls();
    write(directory, "map", &map_scene(&walls))?;
    write(directory, "fig1", &overview_scene(&walls, true))?;
    write(directory, "fig1-without-odometry", &overview_scene(&walls, false))?;
    write(directory, "fig2", &levels_scene(&walls))?;
    write(directory, "fig3", &correspondence_scene(&walls, Apart::AsGiven))?;
    write(
        directory,
        "fig3-side-by-side",
        &correspondence_scene(&walls, Apart::SideBySide),
    )?;
    if let Some(scene) = vertex_rule_scene() {
        write(directory, "fig4", &scene)?;
    }
    Ok(())
}
