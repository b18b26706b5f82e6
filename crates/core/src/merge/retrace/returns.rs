//! The returns of all scans around the gaps.

use std::collections::BTreeMap;

use crate::geometry::Point;
use crate::keyframe::Keyframe;
use crate::merge::on_sides::{MIN_COS, spread_m};

/// Edge of a cell, metres.
const CELL_M: f64 = 0.25;
/// Cells on every side of a gap: as far as walls are drawn on.
const CELLS_AROUND: i64 = 2;
/// Distance within which a return lies on a straight, metres.
const GATE_M: f64 = 0.04;
/// Length of the bins in which a face must have returns, metres, and how much of one a return fills at the most.
const BIN_M: f64 = 0.05;
const WIDEST_M: f64 = 0.15;
/// Returns on a face, between its ends, at the least.
const LEAST_RETURNS: usize = 2;

type Cell = (i64, i64);

fn cell_of(p: Point) -> Cell {
    ((p.x / CELL_M).floor() as i64, (p.y / CELL_M).floor() as i64)
}

/// A return, map frame.
struct Return {
    place: Point,
    /// Unit vector along the side of the scan that it lies on.
    direction: Point,
    spread_m: f64,
}

/// A return on a straight.
pub(super) struct Along {
    /// Distance from the start of the straight, metres.
    pub along_m: f64,
    /// How much of a wall it stands for, metres.
    pub spread_m: f64,
    /// Whether its scan has a side there that runs as the straight does.
    pub runs_along: bool,
}

/// Returns by place.
#[derive(Default)]
pub(super) struct Returns(BTreeMap<Cell, Vec<Return>>);

impl Returns {
    /// Those around some places.
    pub fn near(places: impl Iterator<Item = Point>, keyframes: &[Keyframe]) -> Self {
        let mut cells: BTreeMap<Cell, Vec<Return>> = BTreeMap::new();
        for place in places {
            let (x, y) = cell_of(place);
            for cx in x - CELLS_AROUND..=x + CELLS_AROUND {
                for cy in y - CELLS_AROUND..=y + CELLS_AROUND {
                    cells.entry((cx, cy)).or_default();
                }
            }
        }
        if cells.is_empty() {
            return Self::default();
        }
        for keyframe in keyframes {
            let map_from_scan = keyframe.map_from_scan.isometry();
            for p in keyframe.standing_points() {
                let place = map_from_scan * p.point;
                if let Some(returns) = cells.get_mut(&cell_of(place)) {
                    returns.push(Return {
                        place,
                        direction: map_from_scan.rotate(p.direction),
                        spread_m: spread_m(keyframe, p.point, p.direction),
                    });
                }
            }
        }
        Self(cells)
    }

    /// Those on a straight of `length_m`, in order; `direction` has length 1.
    pub fn along(&self, from: Point, direction: Point, length_m: f64) -> Vec<Along> {
        let to = from + direction * length_m;
        let least = cell_of(Point::new(from.x.min(to.x) - GATE_M, from.y.min(to.y) - GATE_M));
        let most = cell_of(Point::new(from.x.max(to.x) + GATE_M, from.y.max(to.y) + GATE_M));
        let cells = (least.0..=most.0).flat_map(|x| (least.1..=most.1).map(move |y| (x, y)));
        let mut found: Vec<Along> = cells
            .filter_map(|cell| self.0.get(&cell))
            .flatten()
            .filter(|on| direction.cross(on.place - from).abs() <= GATE_M)
            .map(|on| Along {
                along_m: direction.dot(on.place - from),
                spread_m: on.spread_m,
                runs_along: on.direction.dot(direction).abs() >= MIN_COS,
            })
            .filter(|a| a.along_m > 0.0 && a.along_m < length_m)
            .collect();
        found.sort_by(|a, b| a.along_m.total_cmp(&b.along_m));
        found
    }

    /// Whether returns lie on at least half of the straight between two points. A straight of no length needs none.
    pub fn cover(&self, a: Point, b: Point) -> bool {
        let length_m = a.distance(b);
        let Some(direction) = (b - a).unit().filter(|_| length_m >= BIN_M) else {
            return true;
        };
        let mut bins = vec![false; (length_m / BIN_M).ceil() as usize];
        let last = bins.len() - 1;
        let bin_at = |along_m: f64| ((along_m / BIN_M) as usize).min(last);
        let mut between = 0;
        for on in self.along(a, direction, length_m) {
            let half_m = 0.5 * on.spread_m.min(WIDEST_M);
            bins[bin_at(on.along_m - half_m)..=bin_at(on.along_m + half_m)].fill(true);
            between += usize::from(on.along_m > GATE_M && on.along_m < length_m - GATE_M);
        }
        between >= LEAST_RETURNS && 2 * bins.iter().filter(|b| **b).count() >= bins.len()
    }
}
