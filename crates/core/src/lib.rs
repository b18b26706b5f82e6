//! Polygonal maps from 2D laser scans, without odometry, by recognising shapes.
//!
//! After Latecki, Lakaemper, Sun, Wolter, "Building Polygonal Maps from Laser Range Data" (2004).
//! Data flows one way: scan → polylines → shape match → alignment → merge → map. This library knows no
//! files, clock, printing or ROS.

pub mod align;
pub mod extract;
pub mod geometry;
pub mod map;
pub mod scan;
