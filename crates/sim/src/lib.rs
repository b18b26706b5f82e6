//! Simulated floor plans, scanners and people for polymapper, with exact truth.
//!
//! In: a [`PlanKind`] and a seed, a [`Scanner`], a [`Motion`], a number of people. Out: a [`SimLog`]: scans, stamps,
//! drifting odometry, and the truth: poses, walls, which beam hit what, where people were, which wall was seen. It
//! writes itself as a CARMEN log and as a truth file; [`score_map`] and [`trajectory_error`] measure what a mapper
//! made of it.
//!
//! ```
//! use polymapper_sim::{Motion, PlanKind, Scanner, ScannerKind, SimSettings, score_map, simulate};
//!
//! let settings = SimSettings {
//!     scanner: Scanner { noise_m: 0.02, ..Scanner::new(ScannerKind::Sick180) },
//!     motion: Motion::keyframes(),
//!     people: 2,
//!     ..SimSettings::new(PlanKind::Office, 1)
//! };
//! let log = simulate(&settings)?;
//! let (mut carmen, mut truth) = (Vec::new(), Vec::new());
//! log.write_carmen(&mut carmen)?;
//! log.write_truth(&mut truth)?;
//!
//! // A map in the frame of the first scan; here the true walls themselves.
//! let map_from_world = log.truth_poses[0].inverse();
//! let map: Vec<_> = log.walls().iter().map(|wall| wall.transformed(map_from_world)).collect();
//! let score = score_map(&map, log.truth_poses[0], &log.map_truth());
//! assert!(score.within_5cm.f_score() > 0.999);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Same settings, same bytes
//! All random numbers come from one seeded generator per purpose (plan, people, scanner, odometry), and every sine,
//! cosine and logarithm that shapes the log from `libm` instead of the platform. Scores are not covered by this.
//!
//! # What is not simulated
//! The world is flat, and seen in one moment: a scan has no duration. Glass, mirrors, and walls too dark to return
//! are missing; dropouts are independent of each other. The scanner sits in the vehicle's origin.

mod dice;
mod error;
mod floor;
mod motion;
mod odometry;
mod people;
mod plan;
mod scanner;
mod score;
mod seen;
mod sides;
mod simulate;
mod terrain;
mod trajectory;
mod write;

pub use error::SimError;
pub use motion::Motion;
pub use odometry::OdometryNoise;
pub use plan::{Plan, PlanKind, Plant};
pub use scanner::{Scanner, ScannerKind};
pub use score::{Agreement, MapScore, MapTruth, score_map};
pub use seen::{SeenWalls, WallPiece};
pub use simulate::{Hit, SimLog, SimSettings, simulate};
pub use terrain::CLEARANCE_M;
pub use trajectory::{TrajectoryError, fit_trajectory, trajectory_error};
