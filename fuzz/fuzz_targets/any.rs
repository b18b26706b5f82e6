#![no_main]

use libfuzzer_sys::{Corpus, fuzz_target};
use polymapper_fuzz::{PACKED, read};

// What is packed is the business of the target `packed`, which is slow.
fuzz_target!(|data: &[u8]| -> Corpus {
    if PACKED.iter().any(|magic| data.starts_with(magic)) {
        return Corpus::Reject;
    }
    read(data.to_vec());
    Corpus::Keep
});
