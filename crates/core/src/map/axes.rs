//! A map turned so that its walls run along the axes.
//!
//! In: a map. Out: the direction of most of its walls, and the map in a frame that is turned. The directions of all sides, weighted
//! by length, are counted modulo 90° (a wall and the one across are one direction), in bins of a degree; the mean of
//! the sides around the fullest bins is the answer, so that a few slanted walls do not pull.

use std::f64::consts::FRAC_PI_2;

use super::{EraserBox, Map, MapVertex};
use crate::geometry::{Point, Pose};

const BINS: usize = 90;
const BIN_RAD: f64 = FRAC_PI_2 / BINS as f64;
/// Bins on either side of the fullest that are averaged.
const REACH: usize = 2;

/// The direction of most of the map's walls, radians in −π/4..π/4; `None` for a map without sides.
#[must_use]
pub fn dominant_direction_rad(map: &Map) -> Option<f64> {
    let sides: Vec<(f64, f64)> = map
        .polylines
        .iter()
        .flat_map(|p| p.vertices.windows(2))
        .map(|w| w[1].point - w[0].point)
        .filter(|d| d.norm() > 0.0)
        .map(|d| (d.bearing_rad().rem_euclid(FRAC_PI_2), d.norm()))
        .collect();
    let mut histogram = [0.0; BINS];
    for &(direction_rad, length_m) in &sides {
        histogram[(direction_rad / BIN_RAD) as usize % BINS] += length_m;
    }
    let around = |k: usize| -> f64 {
        (0..=2 * REACH)
            .map(|i| histogram[(k + BINS + i - REACH) % BINS])
            .sum()
    };
    let fullest = (0..BINS)
        .filter(|&k| around(k) > 0.0)
        .max_by(|&a, &b| around(a).total_cmp(&around(b)).then(b.cmp(&a)))?;
    let middle_rad = (fullest as f64 + 0.5) * BIN_RAD;
    let off = |direction_rad: f64| quarter_wrapped(direction_rad - middle_rad);
    let (mut sum, mut weight) = (0.0, 0.0);
    for (direction_rad, length_m) in sides {
        let off_rad = off(direction_rad);
        if off_rad.abs() <= (REACH as f64 + 0.5) * BIN_RAD {
            sum += length_m * off_rad;
            weight += length_m;
        }
    }
    Some(quarter_wrapped(middle_rad + sum / weight))
}

/// The angle modulo 90°, in −π/4..π/4.
fn quarter_wrapped(angle_rad: f64) -> f64 {
    angle_rad - (angle_rad / FRAC_PI_2).round() * FRAC_PI_2
}

impl Map {
    /// The same map in a frame that is turned: every point p becomes R(`by_rad`) p. A turned eraser box becomes the
    /// smallest one around it; those that then overlap become one.
    #[must_use]
    pub fn turned(&self, by_rad: f64) -> Self {
        let turn = Pose::new(0.0, 0.0, by_rad);
        let mut map = self.clone();
        for vertex in map.polylines.iter_mut().flat_map(|p| &mut p.vertices) {
            *vertex = MapVertex {
                point: turn * vertex.point,
                ..*vertex
            };
        }
        map.eraser_boxes = Vec::new();
        for b in &self.eraser_boxes {
            let mut next = turned_box(b, turn);
            // What it joins may reach others.
            while let Some(k) = map.eraser_boxes.iter().position(|other| other.overlaps(&next)) {
                next = next.joined(&map.eraser_boxes.swap_remove(k));
            }
            map.eraser_boxes.push(next);
        }
        map
    }
}

fn turned_box(b: &EraserBox, turn: Pose) -> EraserBox {
    let corners = [
        b.min,
        b.max,
        Point::new(b.min.x, b.max.y),
        Point::new(b.max.x, b.min.y),
    ]
    .map(|c| turn * c);
    corners.iter().fold(
        EraserBox {
            min: corners[0],
            max: corners[0],
        },
        |sum, &c| sum.joined(&EraserBox { min: c, max: c }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::MapPolyline;

    fn wall(from: (f64, f64), to: (f64, f64)) -> MapPolyline {
        let vertex = |(x, y)| MapVertex {
            point: Point::new(x, y),
            observations: 3,
            sigma_m: 0.01,
        };
        MapPolyline {
            id: 0,
            vertices: vec![vertex(from), vertex(to)],
        }
    }

    /// A room of 6 m × 4 m, and a slanted wall of 3 m.
    fn room() -> Map {
        Map {
            polylines: vec![
                wall((0.0, 0.0), (6.0, 0.0)),
                wall((6.0, 0.0), (6.0, 4.0)),
                wall((6.0, 4.0), (0.0, 4.0)),
                wall((0.0, 4.0), (0.0, 0.0)),
                wall((1.0, 1.0), (3.4, 2.8)),
            ],
            eraser_boxes: vec![EraserBox {
                min: Point::new(1.0, 1.0),
                max: Point::new(2.0, 2.0),
            }],
        }
    }

    #[test]
    fn a_turned_room_is_turned_back_by_less_than_half_a_quarter() {
        for turn_rad in [-0.7, -0.3, 0.0, 0.2, 0.75, 2.0, 3.0] {
            let turned = room().turned(turn_rad);
            let found_rad = dominant_direction_rad(&turned).unwrap();
            assert!(found_rad.abs() <= FRAC_PI_2 / 2.0 + 1e-9);
            assert!(
                quarter_wrapped(found_rad - turn_rad).abs() < 1e-6,
                "{turn_rad}: {found_rad}"
            );
            let back = dominant_direction_rad(&turned.turned(-found_rad)).unwrap();
            assert!(back.abs() < 1e-6, "{back}");
        }
    }

    #[test]
    fn a_turned_box_holds_the_old_one() {
        let turned = room().turned(0.5);
        let corner = Pose::new(0.0, 0.0, 0.5) * Point::new(2.0, 1.0);
        assert!(turned.eraser_boxes[0].contains(corner));
    }

    #[test]
    fn a_map_without_walls_has_no_direction() {
        assert_eq!(dominant_direction_rad(&Map::default()), None);
    }
}
