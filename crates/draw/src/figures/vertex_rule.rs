use polymapper_core::geometry::{Point, Polyline};

use crate::bounds::Bounds;
use crate::colour::{Colour, palette};
use crate::round::spoken;
use crate::scene::{Dash, Extent, Face, Grid, Label, Layer, Mark, Panel, Sample, Scene, Stroke};

/// One use of the vertex rule in a merge, map frame, metres; names as in the paper's Fig. 4.
#[derive(Clone, Debug)]
pub struct VertexRule {
    /// L₁, a polyline of the map before the merge.
    pub map_polyline: Polyline,
    /// L₂, a polyline of the aligned scan.
    pub scan_polyline: Polyline,
    /// v, a vertex of L₁.
    pub vertex: Point,
    /// p_s1 and p_s2, consecutive simulated scan points on L₂.
    pub simulated: [Point; 2],
    /// p_g1 and p_g2, the points of L₁ closest to them; v lies between.
    pub closest: [Point; 2],
    /// p_sv, the point of L₂ between p_s1 and p_s2 closest to v.
    pub nearest_to_vertex: Point,
    /// The weighted mean of v and p_sv, a vertex of the new map.
    pub new_point: Point,
}

/// Fig. 4: how a vertex of the map passes into the new map though no simulated ray hits it.
#[must_use]
pub fn vertex_rule(input: &VertexRule) -> Scene {
    let panel = Panel::new("")
        .with(lines(input))
        .with(joins(input))
        .with(points(input))
        .with_grid(Grid::Auto)
        .with_extent(extent(input))
        .with_legend(Sample::Line(MAP), "L1: map before the merge")
        .with_legend(Sample::Line(SCAN), "L2: aligned scan")
        .with_legend(Sample::Line(JOIN), "closest point")
        .with_legend(
            Sample::Circle(11.0, None, Some(Stroke::new(palette::VERMILION, 4.0))),
            "new vertex of the map",
        );
    Scene::of(panel).with_caption(caption(input))
}

const MAP: Stroke = Stroke::new(palette::INK, 4.5);
const SCAN: Stroke = Stroke::new(palette::BLUE, 3.2);
const JOIN: Stroke = Stroke::new(palette::GREY, 2.2).dash(Dash::Dashed);

fn lines(input: &VertexRule) -> Layer {
    let mut layer = Layer::new("polylines");
    layer.line(input.map_polyline.vertices().iter().copied(), MAP);
    layer.line(input.scan_polyline.vertices().iter().copied(), SCAN);
    layer
}

fn joins(input: &VertexRule) -> Layer {
    let mut layer = Layer::new("closest points");
    for (s, g) in input.simulated.into_iter().zip(input.closest) {
        layer.line([s, g], JOIN);
    }
    layer.line([input.vertex, input.nearest_to_vertex], JOIN);
    layer
}

/// The points and their names; each name stands on the far side of its partner.
fn points(input: &VertexRule) -> Layer {
    let mut layer = Layer::new("points");
    let [s1, s2] = input.simulated;
    let [g1, g2] = input.closest;
    let (v, sv) = (input.vertex, input.nearest_to_vertex);
    for (at, colour) in [
        (g1, palette::INK),
        (g2, palette::INK),
        (v, palette::INK),
        (s1, palette::BLUE),
        (s2, palette::BLUE),
        (sv, palette::BLUE),
    ] {
        layer.marker(at, 8.0, colour, Stroke::new(palette::WHITE, 1.5));
    }
    layer.marker(v, 8.0, palette::WHITE, Stroke::new(palette::INK, 3.0));
    layer.marks.push(Mark::Circle {
        centre: input.new_point,
        radius: crate::scene::Radius::Px(11.0),
        fill: None,
        stroke: Some(Stroke::new(palette::VERMILION, 4.0)),
    });
    let named = [
        (v, "v", "", palette::INK, v - sv),
        (sv, "p", "sv", palette::BLUE, sv - v),
        (s1, "p", "s1", palette::BLUE, s1 - g1),
        (g1, "p", "g1", palette::INK, g1 - s1),
        (s2, "p", "s2", palette::BLUE, s2 - g2),
        (g2, "p", "g2", palette::INK, g2 - s2),
    ];
    for (at, text, subscript, colour, side) in named {
        layer
            .marks
            .push(label(at, text, subscript, colour, Face::Italic, side));
    }
    let sideways = (v - sv).left();
    layer.marks.push(label(
        input.new_point,
        "new point",
        "",
        palette::VERMILION,
        Face::Regular,
        sideways,
    ));
    for (polyline, number, colour) in [
        (&input.map_polyline, "1", palette::INK),
        (&input.scan_polyline, "2", palette::BLUE),
    ] {
        if let Some(at) = end_in_sight(polyline, input) {
            layer
                .marks
                .push(label(at, "L", number, colour, Face::Italic, Point::new(0.0, 1.0)));
        }
    }
    layer
}

fn label(at: Point, text: &str, subscript: &str, colour: Colour, face: Face, side: Point) -> Mark {
    Mark::Label(Label {
        at,
        text: text.to_owned(),
        subscript: subscript.to_owned(),
        colour,
        face,
        side: Some(side),
    })
}

/// A place on the polyline for its own name: in sight and as far from all named points as can be.
fn end_in_sight(polyline: &Polyline, input: &VertexRule) -> Option<Point> {
    let view = window(input)?;
    let inner = view.grown(-0.06 * view.width_m().min(view.height_m()));
    let steps = 200;
    let places = polyline
        .sides()
        .flat_map(|side| (0..=steps).map(move |k| side.at(f64::from(k) / f64::from(steps))));
    let room_m = |p: Point| {
        named(input)
            .into_iter()
            .map(|q| q.distance(p))
            .fold(f64::INFINITY, f64::min)
    };
    places
        .filter(|p| inner.contains(*p))
        .max_by(|a, b| room_m(*a).total_cmp(&room_m(*b)))
}

fn named(input: &VertexRule) -> [Point; 7] {
    let [s1, s2] = input.simulated;
    let [g1, g2] = input.closest;
    [
        s1,
        s2,
        g1,
        g2,
        input.vertex,
        input.nearest_to_vertex,
        input.new_point,
    ]
}

/// The named points with air round them.
fn window(input: &VertexRule) -> Option<Bounds> {
    let bounds = Bounds::of(named(input))?;
    let size_m = bounds.width_m().max(bounds.height_m());
    Some(bounds.grown(if size_m > 0.0 { 0.3 * size_m } else { 0.1 }))
}

fn extent(input: &VertexRule) -> Extent {
    window(input).map_or(Extent::All, Extent::Fixed)
}

fn caption(input: &VertexRule) -> String {
    let apart = |a: Point, b: Point| {
        let mm = 1000.0 * a.distance(b);
        if mm < 100.0 {
            format!("{mm:.1}\u{a0}mm")
        } else {
            spoken((mm / 10.0).round() / 100.0)
        }
    };
    format!(
        "The vertex rule. v is a vertex of the map polyline L1, between the points pg1 and pg2 closest to the \
         consecutive simulated scan points ps1 and ps2, which are {} apart. psv is the point of the scan polyline L2 \
         closest to v, {} from it. Their weighted mean, {} from v, is a vertex of the new map.",
        apart(input.simulated[0], input.simulated[1]),
        apart(input.vertex, input.nearest_to_vertex),
        apart(input.vertex, input.new_point),
    )
}
