#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::{joined, read, with_small_blocks};

fuzz_target!(|data: &[u8]| read(with_small_blocks(joined(b"#ROSBAG V2.0\n", data))));
