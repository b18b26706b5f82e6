//! Fig. 4: the vertex rule, found in the log (paper section 4).
//!
//! Rays of the scanner from the pose of a scan meet the scan's polyline L2 in simulated scan points. Where the points
//! of a map polyline L1 closest to two consecutive ones have a vertex v of the map between them, the rule makes
//! p_sv, the point of L2 closest to v between the two, and averages it with v by the number of observations. Of all such places in the
//! early maps of the log the one is drawn where most can be seen.
//!
//! The map is the finished one of the scans before, so that L1 has the vertices that a user sees; a merge works on the
//! growing map, which has more of them.

use polymapper_core::extract::{ExtractSettings, extract};
use polymapper_core::geometry::{Point, Polyline, Pose, Segment};
use polymapper_core::map::{Map, MapPolyline};
use polymapper_draw::Scene;
use polymapper_draw::figures::{VertexRule, vertex_rule};

use super::Undrawn;
use super::survey::{BeforeMerge, Survey, SurveyedScan};

/// Points of scan and map that are further apart do not belong together, metres.
const GATE_M: f64 = 0.15;

/// Draws the place where the rule is seen best.
pub fn draw(survey: &Survey) -> Result<Scene, Undrawn> {
    let best = survey
        .early
        .iter()
        .flat_map(|before| {
            let scan = &survey.scans[before.scan];
            uses(before, scan)
                .into_iter()
                .map(move |found| (found, scan.index))
        })
        .max_by(|(a, _), (b, _)| a.clearness.total_cmp(&b.clearness));
    let (found, index) = best.ok_or(Undrawn(
        "the vertex rule does not occur in the first scans of this log",
    ))?;
    let mut scene = vertex_rule(&found.rule);
    let seen = match found.observations {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        n => format!("{n} times"),
    };
    scene.caption = format!(
        "{}, scan\u{a0}{index}. {} v was seen {seen} before.",
        survey.name, scene.caption
    );
    Ok(scene)
}

struct Use {
    rule: VertexRule,
    observations: u32,
    /// How well it can be seen; larger is better.
    clearness: f64,
}

/// A simulated scan point, and its closest point on a polyline of the map.
#[derive(Clone, Copy)]
struct Link {
    at: Point,
    /// Side of the scan's polyline.
    scan_side: usize,
    map_polyline: usize,
    map_side: usize,
    closest: Point,
}

fn uses(before: &BeforeMerge, scan: &SurveyedScan) -> Vec<Use> {
    let polylines: Vec<Polyline> = extract(&scan.scan, &ExtractSettings::default())
        .polylines
        .iter()
        .map(|p| p.polyline.transformed(before.map_from_scan))
        .collect();
    let mut found = Vec::new();
    let mut last: Option<(usize, Link)> = None;
    for beam in 0..scan.scan.geometry().beams() {
        let bearing_rad = scan.scan.geometry().bearing_rad(beam);
        let hit = simulated(&polylines, before.map_from_scan, bearing_rad);
        let link = hit.and_then(|(polyline, side, at)| Some((polyline, link(&before.map, side, at)?)));
        if let (Some((p, a)), Some((q, b))) = (last, link)
            && p == q
            && let Some(rule) = rule(&before.map, &polylines[p], a, b)
        {
            found.push(rule);
        }
        last = link;
    }
    found
}

/// Polyline, side and point that the ray meets first.
fn simulated(polylines: &[Polyline], map_from_scan: Pose, bearing_rad: f64) -> Option<(usize, usize, Point)> {
    let origin = map_from_scan.translation();
    let direction = Point::from_polar(1.0, map_from_scan.theta_rad + bearing_rad);
    let hits = polylines.iter().enumerate().flat_map(|(p, polyline)| {
        polyline.sides().enumerate().filter_map(move |(s, side)| {
            let (range_m, _) = side.meet_ray(origin, direction)?;
            Some((range_m, p, s))
        })
    });
    let (range_m, polyline, side) = hits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((polyline, side, origin + direction * range_m))
}

/// The closest point on the map, if it is near.
fn link(map: &Map, scan_side: usize, at: Point) -> Option<Link> {
    let closest = map.polylines.iter().enumerate().flat_map(|(p, polyline)| {
        sides(polyline).enumerate().map(move |(s, side)| Link {
            at,
            scan_side,
            map_polyline: p,
            map_side: s,
            closest: side.at(side.closest_share(at)),
        })
    });
    closest
        .min_by(|a, b| a.closest.distance(at).total_cmp(&b.closest.distance(at)))
        .filter(|link| link.closest.distance(at) <= GATE_M)
}

fn sides(polyline: &MapPolyline) -> impl Iterator<Item = Segment> + '_ {
    polyline
        .vertices
        .windows(2)
        .map(|pair| Segment::new(pair[0].point, pair[1].point))
}

/// The rule for two consecutive simulated points, when one vertex of the map lies between their closest points.
fn rule(map: &Map, scan_polyline: &Polyline, a: Link, b: Link) -> Option<Use> {
    if a.map_polyline != b.map_polyline || a.map_side + 1 != b.map_side {
        return None;
    }
    let map_polyline = &map.polylines[a.map_polyline];
    let vertex = map_polyline.vertices[b.map_side];
    let nearest = nearest_between(scan_polyline, a, b, vertex.point)?;
    let share = 1.0 / f64::from(vertex.observations.max(1) + 1);
    let rule = VertexRule {
        map_polyline: map_polyline.polyline()?,
        scan_polyline: scan_polyline.clone(),
        vertex: vertex.point,
        simulated: [a.at, b.at],
        closest: [a.closest, b.closest],
        nearest_to_vertex: nearest,
        new_point: vertex.point.lerp(nearest, share),
    };
    let clearness = clearness(&rule)?;
    Some(Use {
        rule,
        observations: vertex.observations,
        clearness,
    })
}

/// The point of the scan's polyline between two points of it that is closest to `vertex`.
fn nearest_between(polyline: &Polyline, a: Link, b: Link, vertex: Point) -> Option<Point> {
    let inner = polyline.vertices().get(a.scan_side + 1..=b.scan_side)?;
    let way: Vec<Point> = std::iter::once(a.at)
        .chain(inner.iter().copied())
        .chain(std::iter::once(b.at))
        .collect();
    way.windows(2)
        .map(|pair| {
            let side = Segment::new(pair[0], pair[1]);
            side.at(side.closest_share(vertex))
        })
        .min_by(|p, q| p.distance(vertex).total_cmp(&q.distance(vertex)))
}

/// Seen best: all gaps between named points wide against the whole, and a scan that is not too far from the map, as it is the
/// rule in a merge. `None` where two points fall together.
fn clearness(rule: &VertexRule) -> Option<f64> {
    let size_m = [
        rule.simulated[0].distance(rule.simulated[1]),
        rule.closest[0].distance(rule.closest[1]),
        2.0 * rule.vertex.distance(rule.nearest_to_vertex),
    ]
    .into_iter()
    .fold(0.0, f64::max);
    let gaps = [
        rule.simulated[0].distance(rule.closest[0]),
        rule.simulated[1].distance(rule.closest[1]),
        0.6 * rule.vertex.distance(rule.nearest_to_vertex),
        rule.vertex.distance(rule.closest[0]),
        rule.vertex.distance(rule.closest[1]),
        1.2 * rule.vertex.distance(rule.new_point),
        1.2 * rule.nearest_to_vertex.distance(rule.new_point),
        rule.nearest_to_vertex.distance(rule.simulated[0]),
        rule.nearest_to_vertex.distance(rule.simulated[1]),
    ];
    let narrowest_m = gaps.into_iter().fold(f64::INFINITY, f64::min);
    (narrowest_m > 1e-3 && size_m > 0.0).then(|| narrowest_m / size_m)
}
