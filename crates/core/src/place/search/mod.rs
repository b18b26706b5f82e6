//! Exhaustive search for the poses from which a scan agrees with a map, without a guess.
//!
//! In: points of the scan with the direction of their sides, the sides of the map, a window of poses. Out: distinct
//! poses, best first. Used where shapes alone leave doubt: after a jump of the scanner, and to recognise a place
//! after a loop.
//!
//! The score of a pose is the mean over the scan's points of a field f(x, facing) that is 1 on a side of the map that
//! faces as the point's side does and falls to 0 within a few cells ([`field`]). The best poses are found by branch
//! and bound over a pyramid of maxima ([`branch`]; Olson 2009; Hess et al. 2016): the maximum of the field over a
//! block of cells bounds the score of all shifts within the block, so whole blocks are dismissed at once and nothing is missed.

mod branch;
mod field;

pub(crate) use branch::{Window, search};
pub(crate) use field::Field;
