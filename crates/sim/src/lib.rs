//! x
mod dice;
mod error;
mod floor;
pub mod plan;
mod sides;
