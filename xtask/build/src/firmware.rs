//! Images of the inner workspace.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::cargo::{self, THUMB, THUMB_V8};

/// The image for the emulated board.
pub const EMULATED: &str = "qemu-mps2";

/// The image for the Pico 2, whose processor is another one: a workspace of its own.
pub const PICO2: &str = "pico2";

/// Builds an image, with its release profile, and returns its path. Its package is `pneudrive-IMAGE`.
///
/// # Errors
/// When the target of the board is missing, or the build fails.
pub fn build(target_folder: &Path, image: &str, features: &[&str]) -> Result<PathBuf> {
    let (workspace, target) = home(image);
    build_from(&workspace, target, target_folder, image, features)
}

/// The workspace of an image and its target.
fn home(image: &str) -> (PathBuf, &'static str) {
    match image {
        PICO2 => (cargo::firmware().join(PICO2), THUMB_V8),
        _ => (cargo::firmware(), THUMB),
    }
}

/// Whether an image with this feature does not compile with the release profile, for a reason in these words.
///
/// # Errors
/// When the target of the board is missing, or cargo can't be started.
pub fn is_refused(image: &str, feature: &str, reason: &str) -> Result<bool> {
    let (workspace, target) = home(image);
    cargo::ensure_target(target)?;
    let package = format!("pneudrive-{image}");
    let arguments = ["check", "--package", &package, "--release", "--target", target, "--features", feature];
    let mut check = cargo::in_inner(&workspace, &arguments, &cargo::image_folder()?);
    let output = check.output().context("cargo can't be started")?;
    Ok(!output.status.success() && String::from_utf8_lossy(&output.stderr).contains(reason))
}

/// The same from another copy of the inner workspace.
///
/// # Errors
/// As [`build`].
pub fn build_in(workspace: &Path, target_folder: &Path, image: &str) -> Result<PathBuf> {
    build_from(workspace, THUMB, target_folder, image, &[])
}

fn build_from(
    workspace: &Path,
    target: &str,
    target_folder: &Path,
    image: &str,
    features: &[&str],
) -> Result<PathBuf> {
    cargo::ensure_target(target)?;
    let package = format!("pneudrive-{image}");
    let mut arguments = vec!["build", "--package", &package, "--release", "--target", target];
    features.iter().for_each(|feature| arguments.extend(["--features", *feature]));
    cargo::run(&mut cargo::in_inner(workspace, &arguments, target_folder))
        .with_context(|| format!("building the image {image}"))?;
    Ok(target_folder.join(target).join("release").join(image))
}

/// Builds the image for the emulated board where it belongs.
///
/// # Errors
/// As [`build`].
pub fn build_emulated() -> Result<PathBuf> {
    build(&cargo::image_folder()?, EMULATED, &[])
}
