//! The map while it grows: polylines with closely spaced vertices that remember what they rest on.
//!
//! Each polyline is held twice: its vertices as merged (a few centimetres apart, where evidence is gathered) and
//! its skeleton (few sides, least-squares fitted), which alignment and visibility use, because the direction of a
//! 4 cm side is all noise. Polylines are shared between copies of the map, so that a copy of the whole map as it
//! was some scans ago costs a few hundred pointers.

use std::sync::Arc;

use crate::extract::simplify_chain;
use crate::geometry::{Point, SideGrid};

/// What another side of a skeleton must save in squared deviations, in units of σ²; the same as for scans.
pub(crate) const SIDE_PENALTY: f64 = 16.0;

/// What scans say of a side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence {
    /// Number of the earliest scan that saw it: what was not there yet is nothing to look through.
    pub since: u32,
    /// Scans that saw it.
    pub hits: u32,
    /// Scans that looked through it, and the last one that did.
    pub seen_through: u32,
    last_seen_through: u32,
    /// Scans with a beam that should have met it and gave no return, and the last one.
    pub missed: u32,
    last_missed: u32,
    /// Scans with a return on it, whether or not they made a polyline of it, and the last one. Counted in the end only, where
    /// it is asked for.
    pub met: u32,
    last_met: u32,
}

impl Evidence {
    /// Seen by `hits` scans, the earliest of them number `since`.
    pub fn of(hits: u32, since: u32) -> Self {
        Self {
            since,
            hits,
            seen_through: 0,
            last_seen_through: u32::MAX,
            missed: 0,
            last_missed: u32::MAX,
            met: 0,
            last_met: u32::MAX,
        }
    }
}

/// A vertex of the growing map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    pub point: Point,
    /// Scans merged into it.
    pub hits: u32,
    /// What speaks for and against the side that leads on to the next vertex. Both its ends may be well founded and
    /// the side between them false.
    pub onward: Evidence,
    /// Sum of squared deviations of the observations from the running mean, m².
    pub squares_m2: f64,
}

impl Vertex {
    /// Seen by scan number `scan`.
    pub fn new(point: Point, scan: u32) -> Self {
        Self {
            point,
            hits: 1,
            onward: Evidence::of(1, scan),
            squares_m2: 0.0,
        }
    }

    /// The weighted average of this vertex and a place seen by `seen_hits` scans (paper section 4: larger weight on
    /// the map). Each has the weight of its observations, which makes the vertex the mean of all; `most_hits` bounds
    /// the map's weight, so that it can follow slow change.
    pub fn averaged(mut self, seen: Point, seen_hits: u32, most_hits: u32) -> Self {
        let (n, m) = (
            f64::from(self.hits.min(most_hits)),
            f64::from(seen_hits.min(most_hits)),
        );
        let shift = seen - self.point;
        self.point += shift * (m / (n + m));
        self.squares_m2 += shift.dot(shift) * n * m / (n + m);
        self.hits += seen_hits;
        self
    }

    /// Standard deviation of the vertex's place, metres: spread of the observations over √n, `noise_m` for the first.
    pub fn sigma_m(&self, noise_m: f64) -> f64 {
        let n = f64::from(self.hits);
        ((self.squares_m2 + noise_m * noise_m) / (n * n)).sqrt()
    }
}

/// A polyline of the growing map.
#[derive(Clone, Debug)]
pub(crate) struct GrowingPolyline {
    pub id: u64,
    pub vertices: Vec<Vertex>,
}

impl GrowingPolyline {
    /// Distance between its ends, metres.
    pub fn span_m(&self) -> f64 {
        match (self.vertices.first(), self.vertices.last()) {
            (Some(a), Some(b)) => a.point.distance(b.point),
            _ => 0.0,
        }
    }
}

/// All polylines of the growing map, with their grids. A polyline is named by its slot, the `owner` in the grids.
#[derive(Clone, Default)]
pub(crate) struct GrowingMap {
    slots: Vec<Option<Arc<GrowingPolyline>>>,
    next_id: u64,
    /// Sides between neighbouring vertices.
    pub dense: SideGrid,
    /// Sides of the skeletons.
    pub skeleton: SideGrid,
    stale: Vec<u32>,
}

impl GrowingMap {
    pub fn polyline(&self, slot: u32) -> Option<&GrowingPolyline> {
        self.slots.get(slot as usize)?.as_deref()
    }

    /// The number of slots, with a polyline or without.
    pub fn slots(&self) -> u32 {
        self.slots.len() as u32
    }

    /// Every polyline with its slot, slots ascending.
    pub fn polylines(&self) -> impl Iterator<Item = (u32, &GrowingPolyline)> {
        (0_u32..)
            .zip(&self.slots)
            .filter_map(|(slot, p)| Some((slot, p.as_deref()?)))
    }

    /// Adds a polyline with a new id; one of fewer than two vertices is not added.
    pub fn add(&mut self, vertices: Vec<Vertex>) -> Option<u32> {
        if vertices.len() < 2 {
            return None;
        }
        let slot = self.slots.len() as u32;
        self.slots.push(None);
        let id = self.next_id;
        self.next_id += 1;
        self.put(slot, GrowingPolyline { id, vertices });
        Some(slot)
    }

    /// Puts pieces in the place of a polyline: the first keeps its slot and id.
    pub fn replace_by(&mut self, slot: u32, mut pieces: impl Iterator<Item = Vec<Vertex>>) {
        match pieces.next() {
            Some(first) => self.replace(slot, first),
            None => self.remove(slot),
        }
        for piece in pieces {
            self.add(piece);
        }
    }

    /// Gives the polyline of a slot new vertices; fewer than two take it out.
    pub fn replace(&mut self, slot: u32, vertices: Vec<Vertex>) {
        let Some(id) = self.polyline(slot).map(|p| p.id) else {
            return;
        };
        if vertices.len() < 2 {
            self.remove(slot);
        } else {
            self.put(slot, GrowingPolyline { id, vertices });
        }
    }

    /// Takes a polyline out.
    pub fn remove(&mut self, slot: u32) {
        self.slots[slot as usize] = None;
        self.dense.remove(slot);
        self.skeleton.remove(slot);
    }

    fn put(&mut self, slot: u32, polyline: GrowingPolyline) {
        let points = polyline.vertices.iter().map(|v| v.point);
        self.dense.insert_dense(slot, points);
        self.slots[slot as usize] = Some(Arc::new(polyline));
        self.stale.push(slot);
    }

    /// Counts a look through side `side` of a polyline, once a scan.
    pub fn look_through(&mut self, slot: u32, side: u32, scan: u32) {
        self.count(slot, side, scan, |e| {
            (&mut e.last_seen_through, &mut e.seen_through)
        });
    }

    /// Counts a scan that should have seen side `side` of a polyline and had no return, once a scan.
    pub fn miss(&mut self, slot: u32, side: u32, scan: u32) {
        self.count(slot, side, scan, |e| (&mut e.last_missed, &mut e.missed));
    }

    /// Counts a scan with a return on side `side` of a polyline, once a scan.
    pub fn meet(&mut self, slot: u32, side: u32, scan: u32) {
        self.count(slot, side, scan, |e| (&mut e.last_met, &mut e.met));
    }

    fn count(
        &mut self,
        slot: u32,
        side: u32,
        scan: u32,
        which: impl Fn(&mut Evidence) -> (&mut u32, &mut u32),
    ) {
        let Some(polyline) = self.slots.get_mut(slot as usize).and_then(Option::as_mut) else {
            return;
        };
        let Some(vertex) = Arc::make_mut(polyline).vertices.get_mut(side as usize) else {
            return;
        };
        if scan < vertex.onward.since {
            return;
        }
        let (last, count) = which(&mut vertex.onward);
        if *last != scan {
            *last = scan;
            *count += 1;
        }
    }

    /// Sets the counts of looks through all sides to zero; from now on all scans count.
    pub fn forget_looks(&mut self) {
        for polyline in self.slots.iter_mut().flatten() {
            for vertex in &mut Arc::make_mut(polyline).vertices {
                vertex.onward = Evidence::of(vertex.onward.hits, 0);
            }
        }
    }

    /// Brings the skeletons up to date; returns the slots that changed.
    pub fn refresh_skeletons(&mut self, sigma_m: f64) -> Vec<u32> {
        let mut stale = std::mem::take(&mut self.stale);
        stale.sort_unstable();
        stale.dedup();
        stale.retain(|&slot| self.polyline(slot).is_some());
        for &slot in &stale {
            let Some(polyline) = self.slots[slot as usize].as_deref() else {
                continue;
            };
            let points: Vec<Point> = polyline.vertices.iter().map(|v| v.point).collect();
            let weights = vec![1.0 / (sigma_m * sigma_m); points.len()];
            self.skeleton
                .insert(slot, simplify_chain(&points, &weights, SIDE_PENALTY));
        }
        stale
    }
}
