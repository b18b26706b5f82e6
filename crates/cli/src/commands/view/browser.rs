//! Opens a page in the user's browser.

use std::process::{Command, Stdio};

use crate::talk::say;

/// What opens an address with the program that the user has chosen for it.
#[cfg(target_os = "macos")]
const OPENER: &[&str] = &["open"];
#[cfg(windows)]
const OPENER: &[&str] = &["rundll32", "url.dll,FileProtocolHandler"];
#[cfg(not(any(target_os = "macos", windows)))]
const OPENER: &[&str] = &["xdg-open"];

/// Opens `url`; where that fails, the user has the address on the screen.
pub fn open(url: &str) {
    let opened = Command::new(OPENER[0])
        .args(&OPENER[1..])
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    if opened.is_err() {
        say(format_args!(
            "no browser could be opened ({} is not there)",
            OPENER[0]
        ));
    }
}
