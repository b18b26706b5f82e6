//! Polygonal maps from 2D laser scans, without odometry, by recognising shapes.
//!
//! After Latecki, Lakaemper, Sun, Wolter, "Building Polygonal Maps from Laser Range Data" (2004).
//! Data flows one way: scan → polylines → shape match → alignment → merge → map. This library knows no
//! files, clock, printing or ROS.

pub mod align;
mod atlas;
pub mod eraser;
pub mod extract;
mod finish;
pub mod geometry;
mod graph;
pub mod judge;
mod keyframe;
pub mod map;
pub mod mapper;
pub mod matching;
pub mod merge;
pub mod moving;
pub mod placement;
pub mod recognise;
pub mod scan;
mod search;
pub mod shape;
mod side_points;
mod virtual_scan;
