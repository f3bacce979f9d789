//! axe-core, which finds barriers in a page: from npm, into the target folder.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};
use pneudrive_build::cargo::{built, run};

use crate::tools::NPM;

/// The version that the pages are held against. A newer one has more rules.
const PACKAGE: &str = "axe-core@4.14.1";

/// The script that a page is given.
///
/// # Errors
/// When CARGO_TARGET_DIR is relative and the current folder is gone.
pub fn script() -> Result<PathBuf> {
    Ok(built("axe")?.join("node_modules/axe-core/axe.min.js"))
}

/// Whether it was fetched before.
#[must_use]
pub fn is_there() -> bool {
    script().is_ok_and(|script| script.exists())
}

/// Fetches it if it is not there.
///
/// # Errors
/// When there is no npm and none can be installed, or when its registry does not answer.
pub fn ensure() -> Result<()> {
    if is_there() {
        return Ok(());
    }
    NPM.ensure()?;
    let folder = built("axe")?;
    fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let quietly = ["--no-audit", "--no-fund", "--no-save", "--ignore-scripts"];
    run(Command::new("npm").arg("install").args(quietly).arg("--prefix").arg(&folder).arg(PACKAGE))
}
