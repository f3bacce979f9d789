//! The proof that a test enforces the equality of the execution levels: if one rounding is changed in the image, and nowhere else, it
//! fails.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use pneudrive_build::cargo::image_folder;
use pneudrive_build::{firmware, sources};
use pneudrive_sim::Rig;

use crate::{QemuTarget, Target, body};

/// The file in which a rounding is changed, in a copy of the sources.
const FILE: &str = "shared/controller/src/law/feedback.rs";

/// The law's division toward zero, and what makes it one toward minus infinity: each negative demand that is
/// no whole number is a count less.
const TOWARD_ZERO: &str = "divide_toward_zero(saturate(sum), config.scale)";
const LESS: &str = " - i32::from(saturate(sum) < 0 && saturate(sum).unsigned_abs() % config.scale != 0)";

/// Builds the emulated board's image with the changed rounding, compares a run with the simulation, and tells how the
/// test failed.
///
/// # Errors
/// When the test passes, or fails for another reason.
pub fn prove() -> Result<String> {
    let rig = rig();
    failure(&QemuTarget::start_image(&rig, &changed(firmware::EMULATED)?)?, &rig)
}

/// An image of the inner workspace with the changed rounding.
///
/// # Errors
/// When it cannot be built, or the rounding is not found.
pub fn changed(image: &str) -> Result<PathBuf> {
    let copy = tempfile::tempdir().context("no folder for a copy of the sources")?;
    sources::copy(copy.path())?;
    change(&copy.path().join(FILE))?;
    firmware::build_in(&copy.path().join("firmware"), &image_folder()?.join("rounding"), image)
}

/// A run in which the rounding matters.
#[must_use]
pub fn rig() -> Rig {
    let moves = "test.moves=[[0.0, 8192], [0.3, 16384]]";
    body::rig("servo-b-tuned", &["test.duration_s=1", moves])
}

fn change(file: &Path) -> Result<()> {
    let text = fs::read_to_string(file)?;
    let places = text.matches(TOWARD_ZERO).count();
    ensure!(places == 1, "{FILE} has {TOWARD_ZERO:?} {places} times, not once: name the rounding anew");
    Ok(fs::write(file, text.replace(TOWARD_ZERO, &format!("{TOWARD_ZERO}{LESS}")))?)
}

/// How the equality test fails on an execution level with a changed image.
///
/// # Errors
/// When it passes, or fails for another reason.
pub fn failure(target: &dyn Target, rig: &Rig) -> Result<String> {
    let outcome = catch_unwind(AssertUnwindSafe(|| body::assert_equal_in_every_integer(target, rig)));
    let Err(panic) = outcome else {
        bail!("the records are equal: the test does not see the changed rounding")
    };
    let message = panic.downcast_ref::<String>().cloned().unwrap_or_default();
    ensure!(message.contains(": sample ") && message.contains("left: "), "it failed otherwise: {message}");
    Ok(message)
}
