//! The Python package for Linux: one wheel for every interpreter from 3.11 on, and for every system of the last ten years.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result};
use pneudrive_build::cargo::{in_folder, root, run};

use super::Source;
use crate::venv::Environment;

/// The programs that build it.
const TOOLS: Environment = Environment("dist-venv");
/// The C library that it needs at least is 2.17, of 2012 (PEP 599).
const TARGET: &str = "x86_64-unknown-linux-gnu";
const C_LIBRARY: &str = "2.17";
const PLATFORM: &str = "manylinux2014";
const LIBRARY: &str = "libpneudrive_fmu_library.so";

/// Builds the library of FMUs, which it carries, and the wheel.
///
/// # Errors
/// When a tool cannot be installed, or one of them does not build.
pub fn make(source: &Source, out: &Path) -> Result<()> {
    TOOLS.prepare(&root().join("xtask/dist/requirements.txt"))?;
    carry_library(source)?;
    let mut maturin = Command::new(TOOLS.program("maturin")?);
    maturin.args([
        "build",
        "--release",
        "--locked",
        "--zig",
        "--compatibility",
        PLATFORM,
        "--target",
        TARGET,
    ]);
    maturin.arg("--interpreter").arg(TOOLS.interpreter()?).arg("--out").arg(out);
    maturin.current_dir(source.folder().join("host/python")).env("PATH", path()?);
    run(source.without_folders(&mut maturin)?)
}

fn carry_library(source: &Source) -> Result<()> {
    let target = format!("{TARGET}.{C_LIBRARY}");
    let call = [
        "zigbuild",
        "--release",
        "--locked",
        "--quiet",
        "--package",
        "pneudrive-fmu-library",
        "--target",
        &target,
    ];
    let mut zigbuild = in_folder(source.folder(), &call);
    run(source.without_folders(zigbuild.env("PATH", path()?))?)?;
    let folder = source.folder().join("host/python/python/pneudrive/library");
    fs::create_dir_all(&folder)?;
    let library = source.target().join(TARGET).join("release").join(LIBRARY);
    fs::copy(&library, folder.join(LIBRARY)).with_context(|| library.display().to_string()).map(drop)
}

/// Where programs are looked for: those of the environment first.
fn path() -> Result<std::ffi::OsString> {
    let tools = TOOLS.program("")?;
    let others = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(tools).chain(std::env::split_paths(&others));
    Ok(std::env::join_paths(folders)?)
}
