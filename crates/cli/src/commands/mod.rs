//! One module a command.

pub mod build;
pub mod demo;
pub mod extract;
pub mod simulate;
