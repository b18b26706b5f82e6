//! `cargo xtask page`: types, lints and browser tests of the page in `crates/view/page`.
//!
//! They need node, npm and Chromium. Where one is missing, that is said and the tests are skipped: the program is built
//! and tested without them.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, ensure};

use crate::{program, say};

const FOLDER: &str = "crates/view/page";
/// Names under which systems have the browser.
const CHROMIUM: [&str; 4] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
];

/// Checks the page.
pub fn check() -> anyhow::Result<()> {
    let Some(chromium) = tools()? else {
        return Ok(());
    };
    let program = program()?;
    npm(&["ci", "--no-fund", "--no-audit"], &[])?;
    npm(&["run", "--silent", "check"], &[])?;
    let env = [("CHROMIUM", chromium.as_path()), ("POLYMAPPER", &program)];
    npm(&["test", "--silent"], &env)
}

/// Draws the pictures of the page and of the report for the documents.
pub fn draw(pictures: &Path) -> anyhow::Result<()> {
    let Some(chromium) = tools()? else {
        return Ok(());
    };
    let program = program()?;
    npm(&["ci", "--no-fund", "--no-audit"], &[])?;
    let folder = pictures
        .canonicalize()
        .with_context(|| format!("no folder {}", pictures.display()))?;
    let env = [
        ("CHROMIUM", chromium.as_path()),
        ("POLYMAPPER", &program),
        ("PICTURES", &folder),
    ];
    npm(&["run", "--silent", "pictures"], &env)
}

/// The browser, if all tools are there.
fn tools() -> anyhow::Result<Option<PathBuf>> {
    let chromium = CHROMIUM.into_iter().find_map(on_path);
    let missing: Vec<&str> = [
        ("node", on_path("node")),
        ("npm", on_path("npm")),
        ("chromium", chromium.clone()),
    ]
    .into_iter()
    .filter_map(|(name, place)| place.is_none().then_some(name))
    .collect();
    if !missing.is_empty() {
        eprintln!("SKIPPED: the tests of the page; {} not found", missing.join(", "));
        return Ok(None);
    }
    Ok(chromium)
}

fn on_path(name: &str) -> Option<PathBuf> {
    let path = env::var_os("PATH")?;
    env::split_paths(&path)
        .map(|folder| folder.join(name))
        .find(|place| place.is_file())
}

fn npm(args: &[&str], env: &[(&str, &Path)]) -> anyhow::Result<()> {
    let words = args.join(" ");
    say(&format!("npm {words}, in {FOLDER}"));
    let status = Command::new("npm")
        .args(args)
        .current_dir(FOLDER)
        .env("PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD", "1")
        .envs(env.iter().copied())
        .stdin(Stdio::null())
        .status()
        .context("cannot start npm")?;
    ensure!(status.success(), "`npm {words}` failed: {status}");
    Ok(())
}
