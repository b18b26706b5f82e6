//! One module a command.

pub mod build;
pub mod convert;
pub mod demo;
pub mod export;
pub mod extract;
pub mod figures;
pub mod import;
pub mod inspect;
pub mod locate;
pub mod match_scans;
pub mod merge;
pub mod play;
pub mod simulate;
pub mod view;
