#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::{joined, read};

fuzz_target!(|data: &[u8]| read(joined(
    b"{\"ranges\": [1, null, 3], \"angle_min\": 0, \"angle_increment\": 0.1}\n",
    data
)));
