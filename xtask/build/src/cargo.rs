//! How cargo and rustup are called, and where they build.

use std::env;
use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

/// The target of the boards.
pub const THUMB: &str = "thumbv7em-none-eabihf";

/// The target of the Pico 2, a Cortex-M33.
pub const THUMB_V8: &str = "thumbv8m.main-none-eabihf";

/// Variables that `cargo xtask`, itself run by cargo and rustup, must not hand down: rust-toolchain.toml and the
/// workspaces' own configurations say which toolchain builds for which target.
const LEAKS: [&str; 2] = ["RUSTUP_TOOLCHAIN", "CARGO_BUILD_TARGET"];

/// The root of the repository.
#[must_use]
pub fn root() -> &'static Path {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.ancestors().nth(2).unwrap_or(manifest)
}

/// Where images are built: apart from the target folder of the root workspace, but inside it.
///
/// # Errors
/// When CARGO_TARGET_DIR is relative and the current folder is gone.
pub fn image_folder() -> Result<PathBuf> {
    built("firmware")
}

/// Where something that was built in the root workspace is.
///
/// # Errors
/// When CARGO_TARGET_DIR is relative and the current folder is gone.
pub fn built(path: &str) -> Result<PathBuf> {
    let target = env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let target = std::path::absolute(&target).with_context(|| format!("CARGO_TARGET_DIR {target:?}"))?;
    Ok(target.join(path))
}

/// Builds the command, and the library of FMUs with it, and returns its path. It uses the features that the tests of
/// the whole workspace give it, so that it is there already once they are built.
///
/// # Errors
/// When it does not build.
pub fn command() -> Result<PathBuf> {
    run(&mut in_root(&["test", "--no-run", "--quiet", "--workspace", "--test", "pages"]))?;
    Ok(built("debug")?.join(format!("pneudrive{}", env::consts::EXE_SUFFIX)))
}

/// A cargo call in the root workspace.
#[must_use]
pub fn in_root(arguments: &[&str]) -> Command {
    cargo(root(), arguments)
}

/// A cargo call in another folder of the project.
#[must_use]
pub fn in_folder(folder: &Path, arguments: &[&str]) -> Command {
    cargo(folder, arguments)
}

/// A cargo call in the inner workspace, with the target of its `.cargo/config.toml`. Flags meant for
/// the PC don't reach it.
#[must_use]
pub fn in_firmware(arguments: &[&str], target_folder: &Path) -> Command {
    in_inner(&firmware(), arguments, target_folder)
}

/// The inner workspace.
#[must_use]
pub fn firmware() -> PathBuf {
    root().join("firmware")
}

/// As [`in_firmware`], in another copy of the inner workspace.
#[must_use]
pub fn in_inner(workspace: &Path, arguments: &[&str], target_folder: &Path) -> Command {
    let mut command = cargo(workspace, arguments);
    command.env("CARGO_TARGET_DIR", target_folder);
    command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
    command
}

/// By its name: rustup's cargo then takes the toolchain of `folder` for all that it builds. The one that CARGO names would
/// leave the choice to each compiler that it starts in the folder of a dependency, which may pin one of its own.
fn cargo(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new("cargo");
    command.current_dir(folder).args(arguments);
    LEAKS.iter().for_each(|name| {
        command.env_remove(name);
    });
    command
}

/// Runs a command to its end; its output goes where ours goes.
///
/// # Errors
/// When it can't be started or ends with anything but success.
pub fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("{} can't be started", typed(command)))?;
    ensure!(status.success(), "{} ended with {status}", typed(command));
    Ok(())
}

/// The command as one would type it.
fn typed(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_stem().unwrap_or_default();
    let words = std::iter::once(program).chain(command.get_args());
    words.map(OsStr::to_string_lossy).collect::<Vec<_>>().join(" ")
}

/// Makes sure that the pinned toolchain can build for the boards; installs the target if it's missing.
///
/// # Errors
/// As [`ensure_target`].
pub fn ensure_thumb_target() -> Result<()> {
    ensure_target(THUMB)
}

/// Makes sure that the pinned toolchain can build for a target; installs it if it's missing.
///
/// # Errors
/// Without rustup, or when the target can't be installed.
pub fn ensure_target(target: &str) -> Result<()> {
    if has_target(target)? {
        return Ok(());
    }
    println!("installing the target {target} for the pinned toolchain: rustup target add {target}");
    run(&mut rustup(&["target", "add", target]))
        .with_context(|| format!("the target {target} is missing and can't be installed"))
}

/// Whether the pinned toolchain can build for a target.
///
/// # Errors
/// Without rustup.
pub fn has_target(target: &str) -> Result<bool> {
    let output = match rustup(&["target", "list", "--installed"]).output() {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            bail!("rustup is not found: install it, it brings the target {target}")
        }
        output => output.context("rustup can't be started")?,
    };
    ensure!(
        output.status.success(),
        "rustup target list: {}",
        String::from_utf8_lossy(&output.stderr).trim()
    );
    Ok(String::from_utf8_lossy(&output.stdout).lines().any(|line| line.trim() == target))
}

fn rustup(arguments: &[&str]) -> Command {
    let mut command = Command::new("rustup");
    command.current_dir(root()).args(arguments).env_remove("RUSTUP_TOOLCHAIN");
    command
}
