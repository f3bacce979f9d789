//! Which files this program may replace: its own, by a mark that each of them holds.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::whole_file::is_device;

/// Marks a page as ours, so that writing it again replaces nothing else.
pub const GENERATOR: &str = "<meta name=\"generator\" content=\"pneudrive\">";

/// Makes a folder if it is not there, and makes sure that it can be written to, before long work.
///
/// # Errors
/// When it cannot.
pub fn make_writable(folder: &Path) -> Result<()> {
    // A file without a name, or one that goes with the program: a kill leaves none.
    fs::create_dir_all(folder)
        .and_then(|()| tempfile::tempfile_in(folder))
        .map(drop)
        .with_context(|| format!("cannot write into the folder {}; choose another", folder.display()))
}

/// Refuses to replace a file that does not hold `mark`: it is somebody's own. A pipe or a device is written to, and
/// not replaced.
///
/// # Errors
/// When there is such a file.
pub fn refuse_to_replace(path: &Path, mark: &str) -> Result<()> {
    // To read a pipe would be to wait for somebody who writes.
    if is_device(path) {
        return Ok(());
    }
    match beginning(path) {
        Ok(text) if text.contains(mark) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        _ => bail!("{} is not of this program; choose another place", path.display()),
    }
}

/// Bytes at the beginning of a file that hold its mark, if it has one.
const BEGINNING: u64 = 1 << 16;

fn beginning(path: &Path) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(BEGINNING).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
