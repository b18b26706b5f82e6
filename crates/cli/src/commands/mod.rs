//! One module a command.

pub mod build;
pub mod demo;
pub mod extract;
pub mod figures;
pub mod match_scans;
pub mod play;
pub mod simulate;
pub mod view;
