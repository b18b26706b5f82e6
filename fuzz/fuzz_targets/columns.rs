#![no_main]

use libfuzzer_sys::fuzz_target;
use polymapper_fuzz::read_with;
use polymapper_io::log::ReadOptions;

// The first line is the layout, the rest the file.
fuzz_target!(|data: &[u8]| {
    let end = data.iter().position(|&b| b == b'\n').unwrap_or(data.len());
    let (layout, text) = data.split_at(end);
    let layout = std::str::from_utf8(layout).ok().and_then(|l| l.parse().ok());
    let options = ReadOptions {
        layout,
        ..ReadOptions::default()
    };
    read_with(text.to_vec(), options);
});
