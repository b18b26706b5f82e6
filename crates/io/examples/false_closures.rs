//! Puts false closures into the maps of keyframe logs with published poses, and prints what they do.
//!
//! `false_closures LOG..`: one false closure for ten right ones, one by one, and in runs of five that agree with each other.

#[path = "../tests/closures/mod.rs"]
mod closures;

use std::path::Path;

use closures::{Start, built, inject};

fn main() -> Result<(), polymapper_io::log::LogError> {
    println!(
        "log                        run seed closures false revoked lost   error m: without   with  change  shift m"
    );
    for name in std::env::args().skip(1) {
        let path = Path::new(&name);
        let built = built(path)?;
        let name = path
            .file_name()
            .map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        for (start, run) in [
            (Start::Settled, 1),
            (Start::Settled, 5),
            (Start::Drifted, 1),
            (Start::Drifted, 5),
        ] {
            for seed in 1..=5 {
                let h = inject(&built, start, 0.1, run, seed);
                println!(
                    "{name:28} {start:?} {run:1} {seed:4} {:8} {:5} {:7} {:4} {:18.4} {:6.4} {:+6.1}% {:8.4}",
                    h.right,
                    h.injected,
                    h.revoked,
                    h.lost,
                    h.without_m,
                    h.with_m,
                    100.0 * h.change(),
                    h.shift_m
                );
            }
        }
    }
    Ok(())
}
