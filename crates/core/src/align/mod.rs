//! Alignment of a scan to the map (paper section 2): repeated least squares, limited to matched polylines.
//!
//! In: returns of the scan with the direction of the side they belong to, a guess of the pose, and the sides of the
//! map that they may be matched to. Out: the pose with its information, what the walls cannot tell, and how good
//! the fit is.
//!
//! One round pairs every return p with the nearest allowed side that faces the same way and lies within the gate,
//! and minimises Σ w(eᵢ) (nᵢ·(R(δθ) R pᵢ + t + δt − aᵢ))² / σᵢ² by one Gauss–Newton step, where nᵢ is the normal of
//! the side and w the Cauchy weight 1/(1 + (e/cσ)²). The Jacobian of a residual with respect to (δt, δθ), the turn
//! taken about the scanner, is (nₓ, n_y, n·left(R p)). The gate shrinks from round to round. Distances are taken to
//! sides, not points (Chen and Medioni 1991), because a wall says nothing about a shift along itself.
//!
//! Where we differ from the paper: it gives neither weights nor a gate nor any account of what the walls cannot
//! tell. The errors of the returns on one wall go together, so a wall counts as no more than a few independent returns
//! however many hit it; otherwise two corridor walls parallel to 2° would seem to fix the place along them. What is
//! left open so is filled by the motion model, as a Gaussian prior in the same equations.
//!
//! Round walls are drawn with sides. The normal nᵢ is that of the curve they may stand for (`geometry::Bends`), and so are the
//! directions of the scan's sides: about the middle of a round room nᵢ·left(R p) vanishes, as it must. With the sides' own normals each
//! corner holds the scan fast where it was seen last; a scanner that turned on the spot in a simulated apse was believed to have
//! turned by a third to a half of that.
//!
//! A side that is out of line with its wall by a small angle ε tells a shift along the wall by sin ε of itself. This is not
//! information: what was seen last holds the scanner fast. So Ω is discounted by S = 3 Σ w ε² aᵢaᵢᵀ, aᵢ the derivatives along the
//! side, to Ω (Ω + S)⁻¹ Ω; ε² is how far the directions of the scan's side and the map's differ from the mean difference (which is
//! the heading), and what 2 cm at the ends make of a short side. Where walls tell much, S is nothing against Ω. (Simulated ring
//! corridors, a scanner that reaches 5.6 m, four seeds: 10 to 12 m off without it and what `place/motion/` does, with them 0.1 to 0.4 m
//! in three.)

mod covariance;
mod information;
mod least_squares;
mod side_points;

pub use covariance::Covariance;
pub use information::Information;
pub(crate) use least_squares::align_to_grid;
pub use least_squares::{AlignSettings, Alignment, Guess, Prior, SidePoint, align};
pub(crate) use side_points::{FULL_WORTH, side_points, worth};
