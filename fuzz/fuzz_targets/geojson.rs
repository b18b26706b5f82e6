#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::{import, joined};

fuzz_target!(|data: &[u8]| import(&joined(b"{\"type\":", data)));
