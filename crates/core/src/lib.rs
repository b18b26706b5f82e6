//! Polygonal maps from 2D laser scans, without odometry, by recognising shapes.
//!
//! After Latecki, Lakaemper, Sun, Wolter, "Building Polygonal Maps from Laser Range Data" (2004).
//! Data flows one way: scan → polylines → shape match → alignment → merge → map. This library knows no
//! files, clock, printing or ROS.

#![warn(clippy::print_stdout, clippy::print_stderr, clippy::dbg_macro)]

// In the order in which data flows.
pub mod geometry;
pub mod scan;

pub mod extract;

pub mod shape;

pub mod matching;

pub mod align;

pub mod place;

mod keyframe;
pub mod merge;

mod sweep;

pub mod map;

pub mod loops;

pub mod adjust;

pub mod locate;

pub mod mapper;

pub mod join;
