//! Shows how a map came to be: live in the browser, replayed from a file, or in a report of one file.
//!
//! In goes every [`Step`](polymapper_core::mapper::Step) of a mapper. [`Recorder`] turns it into lines of a *record*
//! ([`record`]): what the page draws, small enough to be sent, kept and scrubbed. A record goes into a [`Store`] that the
//! [`server`] gives to pages, into a file ([`replay`]), into `report.html` ([`report_page`]), or into several of them. [`Finished`] is a result of which no
//! record was kept.
//! The page is the same in all cases: assets in `page/`, held by the program ([`page`]).

mod background;
mod compare;
mod finished;
pub mod page;
pub mod record;
mod recorder;
pub mod replay;
pub mod report_page;
pub mod server;
mod store;

pub use background::Background;
pub use finished::{Finished, FinishedScan};
pub use recorder::{Recorder, Scanned, Sink, Snapshots};
pub use store::Store;
