//! Rigs by name: built in, or a file.

use std::fs::File;
use std::io::{Error as IoError, ErrorKind, Read};
use std::path::Path;

use anyhow::{Context, Result, bail};
use pneudrive_sim::rigfile::{BUILTIN, builtin};
use pneudrive_tables::text::utf8;

/// The longest rig file, bytes.
const LONGEST_RIG: u64 = 1 << 20;

/// The name, for messages, and the text of a built-in rig or a rig file.
///
/// # Errors
/// When there is neither, or the file cannot be read.
pub fn rig_text(rig: &str) -> Result<(String, String)> {
    if let Some(text) = builtin(rig) {
        return Ok((rig.to_owned(), text.to_owned()));
    }
    let path = Path::new(rig);
    if !path.exists() {
        let names: Vec<&str> = BUILTIN.iter().map(|(name, _)| *name).collect();
        let message = format!(
            "there is no rig file {rig}, and no built-in rig of that name (built in: {})",
            names.join(", ")
        );
        return Err(IoError::new(ErrorKind::NotFound, message).into());
    }
    let text = text_of(path).with_context(|| format!("cannot read {rig}"))?;
    Ok((rig.to_owned(), text))
}

/// The text of a file or of a pipe, up to the length limit of a rig file.
fn text_of(path: &Path) -> Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(LONGEST_RIG + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LONGEST_RIG {
        bail!("it is longer than {LONGEST_RIG} bytes, so it is not a rig file");
    }
    Ok(utf8(&bytes)?)
}
