//! Closing loops (not in the paper: "when errors occur, they will not be corrected nor eliminated").
//!
//! Places seen before are recognised and verified (`recognise`), the poses of the keyframes made to agree with all that was
//! measured between them (`graph`), and keyframes between which little drift has gathered told from the others
//! (`ways`). Steps that were others are put right (`steps_again`), and in the end keyframes that lie wrong (`second_look`).

mod elsewhere;
pub(crate) mod graph;
mod oddity;
mod recognise;
mod second_look;
mod steps_again;
mod ties;
pub(crate) mod ways;

pub use recognise::RecogniseSettings;
pub(crate) use recognise::{Drift, Lookup, Recognised, find_in, recognise};
pub(crate) use second_look::place_again;
pub(crate) use steps_again::{is_to_judge, steps_again};
pub(crate) use ties::ties;
