#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::{joined, read};

fuzz_target!(|data: &[u8]| read(joined(b"#ROSBAG V2.0\n", data)));
