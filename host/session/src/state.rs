//! Where programs of this user keep what must outlast them: `PNEUDRIVE_STATE`, or the system's folder for it.

use std::path::PathBuf;

use anyhow::{Result, anyhow};

/// The file of a port in the folder of states, `PORT.KIND`: each port has a name of its own.
///
/// # Errors
/// When the user has no such folder.
pub fn file(port: &str, kind: &str) -> Result<PathBuf> {
    Ok(folder()?.join(file_name(port, kind)))
}

/// The name of that file.
#[must_use]
pub fn file_name(port: &str, kind: &str) -> String {
    let plain =
        |letter: char| if letter.is_ascii_alphanumeric() || "-.".contains(letter) { letter } else { '_' };
    format!("{}.{kind}", port.chars().map(plain).collect::<String>())
}

fn folder() -> Result<PathBuf> {
    let of = |name: &str| std::env::var_os(name).filter(|path| !path.is_empty()).map(PathBuf::from);
    let system = if cfg!(windows) { of("LOCALAPPDATA") } else { of("XDG_STATE_HOME") };
    let home = || std::env::home_dir().map(|home| home.join(".local").join("state"));
    of("PNEUDRIVE_STATE").or_else(|| system.or_else(home).map(|folder| folder.join("pneudrive"))).ok_or_else(
        || {
            anyhow!(
                "there is no home folder to keep the state of a drive in; set PNEUDRIVE_STATE to a folder"
            )
        },
    )
}
