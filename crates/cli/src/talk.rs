//! Words for the user, on standard error.

use std::fmt::Arguments;
use std::io::{self, Write};

/// Says one line. Whether somebody listens does not matter.
pub fn say(words: Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{words}");
}
