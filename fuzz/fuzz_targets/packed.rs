#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::{PACKED, joined, read, with_small_blocks};

// The first byte chooses what the rest is packed with.
fuzz_target!(|data: &[u8]| {
    if let [kind, packed @ ..] = data {
        let magic = PACKED[usize::from(*kind) % PACKED.len()];
        read(with_small_blocks(joined(magic, packed)));
    }
});
