//! Which files this program may replace: only its own, recognised by a mark in each of them.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};

use crate::whole_file::is_device;

/// The mark of our HTML pages: only a file with it is replaced.
pub const GENERATOR: &str = "<meta name=\"generator\" content=\"pneudrive\">";

/// Files that stand at the top of a folder of sources.
const OF_SOURCES: [&str; 7] =
    ["Cargo.toml", "package.json", "pyproject.toml", "CMakeLists.txt", "Makefile", "go.mod", ".git"];

/// Creates a folder if needed, and checks before long work that it can be written to.
///
/// # Errors
/// When it cannot be written to, or is a folder of sources.
pub fn make_writable(folder: &Path) -> Result<()> {
    // The program may write into the current folder.
    let is_named = folder != Path::new(".");
    if let Some(name) = OF_SOURCES.iter().find(|name| is_named && folder.join(name).exists()) {
        let folder = folder.display();
        bail!("{folder} is a folder of sources, as it has {name}; choose another one, such as {folder}-run");
    }
    // A temporary file without a name: a kill leaves none behind.
    fs::create_dir_all(folder)
        .and_then(|()| tempfile::tempfile_in(folder))
        .map(drop)
        .with_context(|| format!("cannot write to the folder {}; choose another", folder.display()))
}

/// Refuses to replace a file without `mark`, which is not ours. A pipe or a device is written to, not replaced.
///
/// # Errors
/// When there is such a file.
pub fn refuse_to_replace(path: &Path, mark: &str) -> Result<()> {
    // Reading a pipe would block until somebody writes to it.
    if is_device(path) {
        return Ok(());
    }
    match beginning(path) {
        Ok(text) if text.contains(mark) => Ok(()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        _ => bail!("{} was not written by this program; choose another place", path.display()),
    }
}

/// The mark of a file is within this many bytes.
const BEGINNING: u64 = 1 << 16;

fn beginning(path: &Path) -> std::io::Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(BEGINNING).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Once `--out sim` in a clone of this project wrote its run between the sources of the simulator.
    #[test]
    fn a_folder_of_sources_is_no_place_for_results() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in OF_SOURCES {
            let sources = folder.path().join(format!("with-{name}"));
            fs::create_dir_all(&sources).expect("made");
            make_writable(&sources).expect("an empty folder");
            fs::write(sources.join(name), "").expect("written");
            let refusal = make_writable(&sources).expect_err("sources").to_string();
            assert!(
                refusal.contains(&format!("is a folder of sources, as it has {name}; choose another")),
                "{refusal}"
            );
        }
        make_writable(&folder.path().join("with-Makefile-run")).expect("its remedy");
    }
}
