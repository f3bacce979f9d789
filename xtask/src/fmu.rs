//! FMUs in another program: written by the command, validated and simulated by FMPy.
//!
//! What FMPy needs is pinned in host/fmu/tests/importers/requirements.txt and installed by pip.

use std::path::PathBuf;
use std::process::Command;

use anyhow::Result;
use pneudrive_build::cargo::{self, in_root, root, run};

use crate::tools::VALGRIND;
use crate::venv::Environment;

/// Where FMPy is.
pub const ENVIRONMENT: Environment = Environment("fmu-venv");

fn importers() -> PathBuf {
    root().join("host/fmu/tests/importers")
}

/// Installs FMPy.
///
/// # Errors
/// Without Python, or when a package cannot be installed.
pub fn prepare() -> Result<()> {
    ENVIRONMENT.prepare(&importers().join("requirements.txt"))
}

/// Whether the tests of the C functions can be watched: the systems that valgrind supports.
#[must_use]
pub fn is_watched() -> bool {
    cfg!(all(target_os = "linux", target_arch = "x86_64"))
}

/// Runs the tests of the C functions under valgrind. An access outside their arguments fails them, and so does memory
/// that nobody can free any more.
///
/// # Errors
/// When there is such an access or leak, or a test fails.
pub fn watch() -> Result<()> {
    VALGRIND.ensure()?;
    let watched = "valgrind --quiet --error-exitcode=9 --leak-check=full --show-leak-kinds=definite --errors-for-leak-kinds=definite";
    let mut tests = in_root(&["test", "--workspace", "--test", "c_api", "--test", "fmi2"]);
    run(tests.env("CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER", watched))
}

/// Has FMPy validate and simulate the command's FMUs.
///
/// # Errors
/// When a test fails.
pub fn test() -> Result<()> {
    let mut tests = Command::new(ENVIRONMENT.interpreter()?);
    tests.args(["-m", "pytest", "-q", "-ra", "-p", "no:cacheprovider"]).current_dir(importers());
    run(tests.env("PNEUDRIVE", cargo::command()?).env("PYTHONDONTWRITEBYTECODE", "1"))
}
