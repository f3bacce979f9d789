//! The image that is flashed on the Nucleo board, executed with models of its peripherals: a workspace of its own, since
//! the emulator of its processor (Unicorn) is under GPL-2.

use std::path::PathBuf;
use std::process::Command;

use anyhow::Result;
use pneudrive_build::cargo::{built, in_inner, root};

use crate::tools::{CLANG, CMAKE, Tool};

/// The tools that build the emulator, and that describe it to Rust.
pub const TOOLS: [&Tool; 2] = [&CMAKE, &CLANG];

/// The short body, which CI runs.
const SHORT: [&str; 6] =
    ["test", "--test", "levels", "--", "a_short_run_of_the_flashed_image_is_the_simulation", "--nocapture"];

/// One rounding changed in the image.
const CHANGED_ROUNDING: [&str; 6] =
    ["test", "--test", "levels", "--", "a_changed_rounding_in_the_flashed_image_is_seen", "--nocapture"];

/// Every body, at one thread: a body's board and its plant take two.
const ALL: [&str; 5] = ["test", "--no-fail-fast", "--", "--nocapture", "--test-threads=1"];

/// The workspace.
#[must_use]
pub fn workspace() -> PathBuf {
    root().join("hil-tests/flashed-image")
}

/// A cargo call there. Crates shared with the outer workspace are built once.
///
/// # Errors
/// When CARGO_TARGET_DIR is relative and the current folder is gone.
pub fn cargo(arguments: &[&str]) -> Result<Command> {
    Ok(in_inner(&workspace(), arguments, &built("")?))
}

/// One short run, at one cycle an instruction and at six.
///
/// # Errors
/// As [`cargo`].
pub fn short() -> Result<Command> {
    cargo(&SHORT)
}

/// A run whose comparison fails, as one rounding is changed in the image.
///
/// # Errors
/// As [`cargo`].
pub fn changed_rounding() -> Result<Command> {
    cargo(&CHANGED_ROUNDING)
}

/// Every body, deadlines and hazards; `write` rewrites the table of docs/explanation/hazards.md.
///
/// # Errors
/// As [`cargo`].
pub fn all(write: bool) -> Result<Command> {
    let mut command = cargo(&ALL)?;
    if write {
        command.env("PNEUDRIVE_WRITE_HAZARDS", "1");
    }
    Ok(command)
}
