//! The Python package: built as a wheel, installed into an empty environment, and tested there.
//!
//! It is a workspace of its own, as an extension module needs Python and cannot be linked into a test program. What the
//! tests need is pinned in host/python/tests/requirements.txt and installed by pip.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail};

use crate::cargo::{built, in_inner, root, run};
use crate::tools::PYTHON;

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
    command.env("PYO3_PYTHON", interpreter()?);
    Ok(command)
}

/// Where the environment is.
fn environment() -> Result<PathBuf> {
    built("python-venv")
}

/// A program of the environment.
fn program(name: &str) -> Result<PathBuf> {
    let folder = if cfg!(windows) { "Scripts" } else { "bin" };
    Ok(environment()?.join(folder).join(name))
}

fn interpreter() -> Result<PathBuf> {
    program(if cfg!(windows) { "python.exe" } else { "python" })
}

/// Whether the environment was made before.
#[must_use]
pub fn is_prepared() -> bool {
    interpreter().is_ok_and(|python| python.exists())
}

/// Makes the environment, and installs what builds and tests the package.
///
/// # Errors
/// Without Python, or when a package cannot be installed.
pub fn prepare() -> Result<()> {
    if !is_prepared() {
        PYTHON.ensure()?;
        run(Command::new(PYTHON.program).args(["-m", "venv"]).arg(environment()?))?;
    }
    let requirements = workspace().join("tests/requirements.txt");
    pip(&["--requirement", &requirements.to_string_lossy()])
}

fn pip(arguments: &[&str]) -> Result<()> {
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    run(Command::new(interpreter()?).args(install).args(arguments))
}

/// Builds the wheel, and installs it.
///
/// # Errors
/// When it cannot be built, or there is not one wheel.
pub fn install() -> Result<()> {
    let wheels = built("python-wheel")?;
    if wheels.exists() {
        fs::remove_dir_all(&wheels).with_context(|| wheels.display().to_string())?;
    }
    let mut maturin = Command::new(program("maturin")?);
    maturin.args(["build", "--release", "--locked", "--interpreter"]).arg(interpreter()?);
    maturin.arg("--out").arg(&wheels).current_dir(workspace()).env("CARGO_TARGET_DIR", built("")?);
    run(&mut maturin)?;
    pip(&["--force-reinstall", "--no-deps", &the_wheel(&wheels)?.to_string_lossy()])
}

fn the_wheel(folder: &Path) -> Result<PathBuf> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
    match paths.as_slice() {
        [wheel] => Ok(wheel.clone()),
        _ => bail!("{} holds {} files, not one wheel", folder.display(), paths.len()),
    }
}

/// Runs the tests on the installed wheel, the notebooks among them.
///
/// # Errors
/// When one fails.
pub fn test() -> Result<()> {
    // Away from the sources, which would stand in for the wheel.
    let tests = workspace().join("tests");
    run(Command::new(interpreter()?).args(["-m", "pytest", "-q", "-ra"]).current_dir(tests))
}

/// Checks the annotations, and that the stubs tell what the compiled part has.
///
/// # Errors
/// When they do not.
pub fn check_types() -> Result<()> {
    let python = || Ok::<_, anyhow::Error>(Command::new(interpreter()?));
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
