//! Words for the user, on standard error.

use std::fmt::Arguments;
use std::io::{self, Write};

use polymapper_core::mapper::LooseStretch;

/// Says one line. Whether somebody listens does not matter.
pub fn say(words: Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{words}");
}

/// Says where a map may be wrong: the worst stretch, and of how many. Nothing where all is known well.
pub fn say_loose(loose: &[LooseStretch]) {
    let Some(worst) = loose.iter().max_by(|a, b| a.sigma_m.total_cmp(&b.sigma_m)) else {
        return;
    };
    let of_all = match loose.len() {
        1 => String::new(),
        count => format!(", the worst of {count} such stretches"),
    };
    say(format_args!(
        "the map may be wrong where walls do not tell the way: {worst}{of_all}"
    ));
}
