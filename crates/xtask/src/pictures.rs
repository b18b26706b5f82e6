//! `cargo xtask pictures`: the pictures in `docs/pictures`, made anew from the sample log.

use std::fs;
use std::path::Path;

use anyhow::Context;

use crate::{page, polymapper};

const FOLDER: &str = "docs/pictures";
const SAMPLE: &str = "samples/killian.log.gz";
/// Scan of figure 2: a recess, a long wall and a hall end, all within a few metres.
const SCAN: &str = "0";

/// Draws them.
pub fn draw() -> anyhow::Result<()> {
    let scratch = tempfile::tempdir().context("no folder for the results")?;
    let (demo, figures) = (scratch.path().join("demo"), scratch.path().join("figures"));
    polymapper(&["demo", "-o"], &demo)?;
    polymapper(&["figures", SAMPLE, "--scan", SCAN, "-o"], &figures)?;
    fs::create_dir_all(FOLDER).with_context(|| format!("cannot make {FOLDER}"))?;
    keep(&demo.join("map.png"), "killian.png")?;
    ["fig1.png", "fig2.png", "fig3.png", "fig4.png"]
        .into_iter()
        .try_for_each(|name| keep(&figures.join(name), name))?;
    page::draw(Path::new(FOLDER))
}

fn keep(drawn: &Path, name: &str) -> anyhow::Result<()> {
    let place = Path::new(FOLDER).join(name);
    let bytes = fs::copy(drawn, &place)
        .with_context(|| format!("cannot copy {} to {}", drawn.display(), place.display()))?;
    eprintln!("   {} ({} kB)", place.display(), bytes / 1000);
    Ok(())
}
