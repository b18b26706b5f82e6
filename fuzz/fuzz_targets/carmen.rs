#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::{joined, read};

fuzz_target!(|data: &[u8]| read(joined(b"PARAM x 1\n", data)));
