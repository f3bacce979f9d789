//! The Python package: built as a wheel, installed into an empty environment, and tested there.
//!
//! It is a workspace of its own, because an extension module needs Python and cannot be linked into a test program.
//! The packages for the tests are pinned in host/python/tests/requirements.txt and installed by pip.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};
use pneudrive_build::cargo::{self, built, in_inner, root, run};

use crate::venv::Environment;

/// Where it is built and tested.
pub const ENVIRONMENT: Environment = Environment("python-venv");

/// The workspace.
#[must_use]
pub fn workspace() -> PathBuf {
    root().join("host/python")
}

/// A cargo call there, with the environment's Python.
///
/// # Errors
/// When CARGO_TARGET_DIR is relative and the current folder is gone.
pub fn cargo(arguments: &[&str]) -> Result<Command> {
    let mut command = in_inner(&workspace(), arguments, &built("")?);
    command.env("PYO3_PYTHON", ENVIRONMENT.interpreter()?);
    Ok(command)
}

/// Makes the environment, and installs the packages that build and test the package.
///
/// # Errors
/// Without Python, or when a package cannot be installed.
pub fn prepare() -> Result<()> {
    ENVIRONMENT.prepare(&workspace().join("tests/requirements.txt"))
}

/// Builds the wheel and installs it, without the optimisation of a release: the tests outside have already built much
/// of it in this way.
///
/// # Errors
/// When it cannot be built, or there is not one wheel.
pub fn install() -> Result<()> {
    let wheels = built("python-wheel")?;
    if wheels.exists() {
        fs::remove_dir_all(&wheels).with_context(|| wheels.display().to_string())?;
    }
    carry_library()?;
    let mut maturin = Command::new(ENVIRONMENT.program("maturin")?);
    maturin.args(["build", "--locked", "--interpreter"]).arg(ENVIRONMENT.interpreter()?);
    maturin.arg("--out").arg(&wheels).current_dir(workspace()).env("CARGO_TARGET_DIR", built("")?);
    run(&mut maturin)?;
    ENVIRONMENT.pip(&["--force-reinstall", "--no-deps", &the_wheel(&wheels)?.to_string_lossy()])
}

/// Puts the library of FMUs into the package: `Rig.export_fmu` needs it.
fn carry_library() -> Result<()> {
    // Cargo builds the library with the command, which depends on it.
    cargo::command()?;
    let name =
        format!("{}pneudrive_fmu_library{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let (from, folder) = (built("debug/deps")?.join(&name), workspace().join("python/pneudrive/library"));
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let to = folder.join(&name);
    fs::copy(&from, &to).with_context(|| format!("{} to {}", from.display(), to.display())).map(drop)
}

fn the_wheel(folder: &Path) -> Result<PathBuf> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    match paths.as_slice() {
        [wheel] => Ok(wheel.clone()),
        _ => bail!("{} holds {} files, not one wheel", folder.display(), paths.len()),
    }
}

/// Runs the tests on the installed wheel, the notebooks among them. Some compare it with the command.
///
/// # Errors
/// When one fails.
pub fn test() -> Result<()> {
    let command = cargo::command()?;
    // Away from the sources, which would stand in for the wheel.
    let tests = workspace().join("tests");
    let mut pytest = Command::new(ENVIRONMENT.interpreter()?);
    run(pytest.args(["-m", "pytest", "-q", "-ra"]).current_dir(tests).env("PNEUDRIVE_COMMAND", command))
}

/// Checks the annotations, and compares the stubs with the compiled part.
///
/// # Errors
/// When they do not.
pub fn check_types() -> Result<()> {
    let python = || Ok::<_, anyhow::Error>(Command::new(ENVIRONMENT.interpreter()?));
    let configuration = workspace().join("pyproject.toml");
    let mut mypy = python()?;
    mypy.args(["-m", "mypy", "--config-file"]).arg(&configuration).args(["python/pneudrive", "tests"]);
    run(mypy.current_dir(workspace()))?;
    let mut stubs = python()?;
    stubs.args([
        "-m",
        "mypy.stubtest",
        "pneudrive",
        "--allowlist",
        "stubtest-allowlist.txt",
        "--mypy-config-file",
    ]);
    run(stubs.arg(&configuration).current_dir(workspace().join("tests")))
}
