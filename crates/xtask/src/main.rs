//! Chores of the workspace: `cargo xtask ci` runs everything that CI runs, in the same order.

mod page;
mod pictures;

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

use anyhow::{Context, bail, ensure};

/// Exit code of `polymapper` when the work is done, but scans were not placed.
const DONE_WITH_LOSS: i32 = 3;
/// Files that a build must leave.
const RESULT: [&str; 9] = [
    "keyframes.jsonl.gz",
    "map.json",
    "map.png",
    "map.svg",
    "replay.jsonl.gz",
    "report.html",
    "report.json",
    "trajectory.csv",
    "trajectory.tum",
];

fn main() -> ExitCode {
    let chore = match env::args().nth(1).as_deref() {
        Some("ci") => ci,
        Some("smoke") => smoke,
        Some("page") => page::check,
        Some("pictures") => pictures::draw,
        _ => {
            eprintln!("usage: cargo xtask ci | smoke | page | pictures");
            return ExitCode::from(2);
        }
    };
    match chore() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

/// Format, lints, tests, documentation, a map of the sample, and the page in a browser.
fn ci() -> anyhow::Result<()> {
    cargo(&["fmt", "--all", "--check"])?;
    cargo(&[
        "clippy",
        "--workspace",
        "--all-targets",
        "--locked",
        "--",
        "-D",
        "warnings",
    ])?;
    cargo(&["test", "--workspace", "--locked"])?;
    cargo(&["doc", "--workspace", "--no-deps", "--locked"])?;
    smoke()?;
    page::check()
}

/// Builds the map of the sample log into a folder that is thrown away.
fn smoke() -> anyhow::Result<()> {
    let folder = tempfile::tempdir().context("no folder for the demo")?;
    let output = folder.path().join("demo");
    polymapper(&["demo", "-o"], &output)?;
    RESULT.iter().try_for_each(|name| not_empty(&output.join(name)))
}

/// Runs the program, `output` being its last argument; scans that were not placed are no failure.
fn polymapper(args: &[&str], output: &Path) -> anyhow::Result<()> {
    let program = program()?;
    let words = args.join(" ");
    say(&format!("polymapper {words}"));
    let status = Command::new(program)
        .args(args)
        .arg(output)
        .status()
        .context("cannot start the program")?;
    ensure!(
        matches!(status.code(), Some(0 | DONE_WITH_LOSS)),
        "`polymapper {words}` failed: {status}"
    );
    Ok(())
}

/// The program as people use it: the page is timed with it, and so it is built once for all that comes after the tests.
fn program() -> anyhow::Result<PathBuf> {
    cargo(&["build", "--release", "--locked", "--package", "polymapper"])?;
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    target
        .join("release/polymapper")
        .canonicalize()
        .context("the program is not where cargo puts it")
}

fn not_empty(path: &Path) -> anyhow::Result<()> {
    let metadata = path
        .metadata()
        .with_context(|| format!("{} is not there", path.display()))?;
    ensure!(metadata.len() > 0, "{} is empty", path.display());
    Ok(())
}

fn cargo(args: &[&str]) -> anyhow::Result<()> {
    let words = args.join(" ");
    say(&format!("cargo {words}"));
    let start = Instant::now();
    let status = cargo_command()
        .args(args)
        .status()
        .context("cannot start cargo")?;
    if !status.success() {
        bail!("`cargo {words}` failed: {status}");
    }
    eprintln!("   done in {:.0} s", start.elapsed().as_secs_f64());
    Ok(())
}

fn cargo_command() -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.env("RUSTDOCFLAGS", "-D warnings");
    command
}

fn say(step: &str) {
    eprintln!("== {step}");
}
