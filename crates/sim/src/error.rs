//! What can go wrong when simulating.

/// Why nothing was simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimError {
    /// A name that stands for nothing.
    #[error("no {what} is called \"{name}\"; there are: {known}")]
    UnknownName {
        /// What sort of thing was asked for.
        what: &'static str,
        /// The name given.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A setting outside of what makes sense.
    #[error("{name} is {value}, but must be {range}")]
    Setting {
        /// Name of the field.
        name: &'static str,
        /// Value given.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// Not even the place where the tour starts is wide enough for the vehicle.
    #[error("plan {plan} of seed {seed} has no room for a tour")]
    NoRoom {
        /// Name of the plan.
        plan: &'static str,
        /// Its seed.
        seed: u64,
    },
    /// The geometry of the scanner is impossible.
    #[error(transparent)]
    Scan(#[from] polymapper_core::scan::ScanError),
}
