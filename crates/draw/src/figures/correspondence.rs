use polymapper_core::geometry::{Point, Polyline, Pose};

use super::polylines;
use crate::bounds::Bounds;
use crate::colour::palette;
use crate::round::counted;
use crate::scene::{Dash, Grid, Layer, Panel, Sample, Scene, Stroke};

/// How the two scans of Fig. 3 lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Apart {
    /// As given.
    AsGiven,
    /// The second moved to the right of the first, so that the dashed lines are seen one by one.
    SideBySide,
}

/// Fig. 3: the polylines of two scans, green and blue, matched ones joined by dashed lines between their
/// midpoints; the grid is 1 m.
///
/// `pairs` holds indices into `first` and `second`; a polyline may occur in several pairs, and a pair that names
/// a polyline that is not there is left out.
#[must_use]
pub fn correspondence(
    first: &[Polyline],
    second: &[Polyline],
    pairs: &[(usize, usize)],
    apart: Apart,
) -> Scene {
    let shift = match apart {
        Apart::AsGiven => Pose::IDENTITY,
        Apart::SideBySide => beside(first, second),
    };
    let second: Vec<Polyline> = second.iter().map(|p| p.transformed(shift)).collect();
    let green = Stroke::new(palette::GREEN, 4.6);
    let blue = Stroke::new(palette::BLUE, 3.2);
    let link = Stroke::new(palette::GREY, 2.0).dash(Dash::Dashed);
    let mut links = Layer::new("correspondences");
    let ends: Vec<(Point, Point)> = pairs
        .iter()
        .filter_map(|(a, b)| Some((midpoint(first.get(*a)?), midpoint(second.get(*b)?))))
        .collect();
    for (a, b) in &ends {
        links.line([*a, *b], link);
    }
    for (a, b) in &ends {
        links.marker(*a, 5.0, palette::WHITE, Stroke::new(palette::GREEN, 2.4));
        links.marker(*b, 5.0, palette::WHITE, Stroke::new(palette::BLUE, 2.4));
    }
    let panel = Panel::new("")
        .with(polylines("first scan", first, green, palette::GREEN))
        .with(polylines("second scan", &second, blue, palette::BLUE))
        .with(links)
        .with_grid(Grid::Every(1.0))
        .with_legend(Sample::Line(green), "first scan")
        .with_legend(Sample::Line(blue), "second scan")
        .with_legend(Sample::Line(link), "matched");
    Scene::of(panel).with_caption(caption(first, &second, &ends, apart))
}

/// The motion that puts the second right of the first, half a metre or more between them.
fn beside(first: &[Polyline], second: &[Polyline]) -> Pose {
    let bounds = |all: &[Polyline]| Bounds::of(all.iter().flat_map(|p| p.vertices()).copied());
    let (Some(a), Some(b)) = (bounds(first), bounds(second)) else {
        return Pose::IDENTITY;
    };
    let gap_m = (0.06 * (a.width_m() + b.width_m())).max(0.5);
    Pose::new(a.max.x + gap_m - b.min.x, a.centre().y - b.centre().y, 0.0)
}

/// The point at half the arc length.
fn midpoint(polyline: &Polyline) -> Point {
    let mut left_m = 0.5 * polyline.length_m();
    for side in polyline.sides() {
        let length_m = side.length_m();
        if left_m <= length_m && length_m > 0.0 {
            return side.at(left_m / length_m);
        }
        left_m -= length_m;
    }
    polyline.last()
}

fn caption(first: &[Polyline], second: &[Polyline], ends: &[(Point, Point)], apart: Apart) -> String {
    let vertices = |all: &[Polyline]| counted(all.iter().map(|p| p.vertices().len()).sum(), "vertex");
    let moved = match apart {
        Apart::AsGiven => "",
        Apart::SideBySide => " The second scan is drawn to the right of the first.",
    };
    format!(
        "Shape matching of two scans: {} with {} (green) and {} with {} (blue), {} (dashed).{moved}",
        counted(first.len(), "polyline"),
        vertices(first),
        counted(second.len(), "polyline"),
        vertices(second),
        counted(ends.len(), "correspondence"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_midpoint_is_at_half_the_way_not_at_the_middle_vertex() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0)].map(|(x, y)| Point::new(x, y));
        let corner = Polyline::new(corners.into()).unwrap();
        assert!(midpoint(&corner).distance(Point::new(1.0, 1.0)) < 1e-12);
    }

    #[test]
    fn pairs_out_of_range_are_left_out() {
        let wall = Polyline::new(vec![Point::default(), Point::new(1.0, 0.0)]).unwrap();
        let scene = correspondence(
            std::slice::from_ref(&wall),
            std::slice::from_ref(&wall),
            &[(0, 0), (0, 7)],
            Apart::SideBySide,
        );
        assert!(scene.caption.contains("1 correspondence ("), "{}", scene.caption);
    }
}
