//! Readers and writers of polymapper: laser logs in, maps and trajectories out.
//!
//! In goes a file name (or `-`, standard input); [`log::open`] recognises compression and format by
//! content and gives the scans one by one, with memory that does not depend on the length of the log.
//! Out come the files of a build. What is done with the scans is no matter of this crate.

mod compression;
pub mod convert;
mod input;
pub mod inspect;
mod lines;
pub mod log;
pub mod out;
