#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::read;

fuzz_target!(|data: &[u8]| read(data.to_vec()));
