//! Similarity of polylines by their shape alone (paper section 3.2).
//!
//! In: two polylines. Out: how unlike they are, and which part of one lies on which part of the other.
//!
//! 1. A polyline is cut into maximal convex arcs, bent to the left or to the right ([`arcs`]).
//! 2. Two arcs are compared in tangent space, the step function of direction over arc length ([`tangent`]):
//!    `S_a(C, D) = (1 + (l_C − l_D)²) · min_Θ ∫₀¹ (T_C(s) − T_D(s) + Θ)² ds`.
//! 3. Dynamic programming finds the best correspondence of arcs, 1-1, 1-many and many-1 ([`mod@similarity`]).
//!
//! Neither place nor heading enters: those are for the matching of whole scans.
//!
//! We differ from the paper in three points, each for a reason:
//! - an arc counts by its length (as in Latecki and Lakaemper, PAMI 22:1185, 2000). Without it a 5 cm arc
//!   speaks as loudly as a 5 m wall;
//! - ends of polylines may stay unmatched at a price, because occlusion and the limits of the scanner cut
//!   them: the same corner with legs cut elsewhere is the normal case, not an exception;
//! - the sum is divided by the mean length of the two polylines, so that one penalty for unmatched polylines
//!   fits long and short ones. S is in rad², the mean square error of direction it stands for.

pub mod arcs;
mod fit;
pub mod similarity;
pub mod tangent;

use crate::geometry::{Point, Polyline, Segment};
pub use arcs::{Arc, Bend, convex_arcs};
pub use similarity::{PartPair, Similarity, similarity};
pub use tangent::{TangentFunction, arc_dissimilarity, turning_variance_rad2};

/// A stretch of a polyline, by arc length from its first vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Where it starts, metres.
    pub from_m: f64,
    /// Where it ends, metres; not before `from_m`.
    pub to_m: f64,
}

impl Part {
    /// The stretch between two arc lengths.
    #[must_use]
    pub const fn new(from_m: f64, to_m: f64) -> Self {
        Self { from_m, to_m }
    }

    /// Its length, metres.
    #[must_use]
    pub fn length_m(self) -> f64 {
        self.to_m - self.from_m
    }
}

/// A polyline made ready for comparison: repeated vertices dropped, directions unwrapped, arcs found.
#[derive(Clone, Debug)]
pub struct Shape {
    vertices: Vec<Point>,
    tangent: TangentFunction,
    arcs: Vec<Arc>,
}

impl Shape {
    /// The shape of a polyline; `None` if all its vertices coincide.
    #[must_use]
    pub fn new(polyline: &Polyline) -> Option<Self> {
        Self::from_vertices(polyline.vertices())
    }

    /// The shape of several polylines chained by straight bridges, as one object that was cut in pieces.
    #[must_use]
    pub fn joined<'a>(polylines: impl IntoIterator<Item = &'a Polyline>) -> Option<Self> {
        let vertices: Vec<Point> = polylines
            .into_iter()
            .flat_map(|p| p.vertices().iter().copied())
            .collect();
        Self::from_vertices(&vertices)
    }

    fn from_vertices(all: &[Point]) -> Option<Self> {
        let mut vertices: Vec<Point> = Vec::with_capacity(all.len());
        for &p in all {
            // A side shorter than a micrometre has no direction to speak of.
            if vertices.last().is_none_or(|q| q.distance(p) > 1e-6) {
                vertices.push(p);
            }
        }
        let tangent = TangentFunction::of_vertices(&vertices)?;
        let arcs = arcs::arcs_of(&tangent);
        Some(Self {
            vertices,
            tangent,
            arcs,
        })
    }

    /// Direction over arc length.
    #[must_use]
    pub fn tangent(&self) -> &TangentFunction {
        &self.tangent
    }

    /// The maximal convex arcs, in order; they cover the polyline without overlap.
    #[must_use]
    pub fn arcs(&self) -> &[Arc] {
        &self.arcs
    }

    /// Arc length, metres.
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.tangent.length_m()
    }

    /// The stretch of side `side` between two arc lengths, as a segment; clamped to the side.
    #[must_use]
    pub fn piece(&self, side: usize, part: Part) -> Option<Segment> {
        let whole = self.tangent.side(side)?;
        let (a, b) = (*self.vertices.get(side)?, *self.vertices.get(side + 1)?);
        let share = |s_m: f64| ((s_m - whole.from_m) / whole.length_m()).clamp(0.0, 1.0);
        let side = Segment::new(a, b);
        Some(Segment::new(
            side.at(share(part.from_m)),
            side.at(share(part.to_m)),
        ))
    }
}
