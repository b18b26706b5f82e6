#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::{read, with_small_blocks};

fuzz_target!(|data: &[u8]| read(with_small_blocks(data.to_vec())));
