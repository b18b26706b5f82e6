#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::{joined, read};

fuzz_target!(|data: &[u8]| read(joined(b"\x89MCAP0\r\n", data)));
