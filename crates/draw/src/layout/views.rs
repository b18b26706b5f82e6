//! What each panel shows: in goes a scene, out come rectangles of the world, in metres.

use polymapper_core::geometry::Point;

use crate::bounds::Bounds;
use crate::scene::{Extent, Panel, ScaleRule, Scene};

/// What each panel shows, and whether all have one scale.
pub(super) fn views(scene: &Scene) -> (Vec<Option<Bounds>>, bool) {
    let own: Vec<Option<Bounds>> = scene
        .panels
        .iter()
        .map(|p| p.bounds().and_then(|b| roomy(p, b)))
        .collect();
    let all = || own.iter().flatten().copied();
    match scene.scale {
        ScaleRule::SameView => {
            let union = all().reduce(Bounds::union);
            (own.iter().map(|view| view.and(union)).collect(), true)
        }
        ScaleRule::SameScaleIfAlike => {
            let sizes = || all().map(|b| b.width_m().max(b.height_m()));
            let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
            if most > 1.6 * least {
                return (own, false);
            }
            let half = Point::new(
                all().map(Bounds::width_m).fold(0.0, f64::max),
                all().map(Bounds::height_m).fold(0.0, f64::max),
            ) * 0.5;
            let same = |b: Bounds| Bounds {
                min: b.centre() - half,
                max: b.centre() + half,
            };
            (own.iter().map(|view| view.map(same)).collect(), true)
        }
        ScaleRule::Own => (own, false),
    }
}

/// Some air round the content, and a size where the content has none; `None` when it cannot be drawn at all.
fn roomy(panel: &Panel, content: Bounds) -> Option<Bounds> {
    let size_m = content.width_m().max(content.height_m());
    let air = match panel.extent {
        Extent::Fixed(_) => 0.0,
        _ => 0.035,
    };
    let reach_m = content.min.norm().max(content.max.norm());
    // Below a millionth of its distance from the origin a coordinate has no digits left to draw with.
    let least_m = (1e-9 * reach_m).max(1e-6);
    let by_m = if size_m > least_m {
        air * size_m
    } else {
        0.5_f64.max(1e-6 * reach_m)
    };
    (size_m.is_finite() && size_m < 1e100 && reach_m < 1e100).then(|| content.grown(by_m))
}

/// Height over width of all plots: that of the widest and highest view.
pub(super) fn aspect(views: &[Option<Bounds>]) -> f64 {
    let all = || views.iter().flatten();
    let width_m = all().map(|b| b.width_m()).fold(0.0, f64::max);
    let height_m = all().map(|b| b.height_m()).fold(0.0, f64::max);
    if width_m > 0.0 && height_m > 0.0 {
        (height_m / width_m).clamp(0.08, 4.0)
    } else {
        0.6
    }
}
