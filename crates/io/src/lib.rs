//! Readers and writers of polymapper: laser logs in, maps and trajectories out.
//!
//! In goes a file name (or `-`, standard input); [`log::open`] recognises compression and format by content and
//! gives the scans one by one, with memory that does not depend on the length of the log. Out come the files of a
//! build and the exports of a map; [`import`] reads an edited export back. What is done with the scans is no
//! matter of this crate.

mod compression;
mod georef;
pub mod import;
mod input;
pub mod inspect;
mod lines;
pub mod log;
pub mod log_out;
pub mod out;

pub use georef::{Geographic, Georef, GeorefError, UtmZone};
