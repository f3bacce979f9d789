//! Copies of the sources, in which something is changed and tried.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::cargo::root;

/// Copies what is in the repository, as it is now, into a folder.
///
/// # Errors
/// When git does not list it, or a file cannot be copied.
pub fn copy(to: &Path) -> Result<()> {
    let listed = Command::new("git").current_dir(root()).args(["ls-files", "-z"]).output();
    let listed = listed.context("git can't be started: the sources are copied by its list")?;
    ensure!(listed.status.success(), "git ls-files: {}", String::from_utf8_lossy(&listed.stderr));
    for name in String::from_utf8(listed.stdout)?.split_terminator('\0') {
        let target = to.join(name);
        fs::create_dir_all(target.parent().unwrap_or(to))?;
        fs::copy(root().join(name), &target).with_context(|| name.to_owned())?;
    }
    Ok(())
}
