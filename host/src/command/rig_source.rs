//! Rigs named on the command line: a built-in rig, or a file.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use anyhow::{Context, Result, bail};
use pneudrive_sim::Rig;
use pneudrive_sim::rig::{BUILTIN, builtin};

use crate::cli::RigChoice;
use crate::exit::Exit;

/// The name, for messages, and the text of a built-in rig or a rig file.
pub(super) fn rig_text(rig: &str) -> Result<(String, String)> {
    if let Some(text) = builtin(rig) {
        return Ok((rig.to_owned(), text.to_owned()));
    }
    let path = Path::new(rig);
    if !path.exists() {
        let names: Vec<&str> = BUILTIN.iter().map(|(name, _)| *name).collect();
        return Err(Exit::NotThere.error(format!(
            "there is no rig file {rig}, and no built-in rig of that name (built in: {})",
            names.join(", ")
        )));
    }
    let text = text_of(path).with_context(|| format!("cannot read {rig}"))?;
    Ok((rig.to_owned(), text))
}

/// The longest rig file, bytes.
const LONGEST_RIG: u64 = 1 << 20;

/// The text of a file or of a pipe, up to the length limit of a rig file.
fn text_of(path: &Path) -> Result<String> {
    let mut text = String::new();
    File::open(path)?.take(LONGEST_RIG + 1).read_to_string(&mut text)?;
    if text.len() as u64 > LONGEST_RIG {
        bail!("it is longer than {LONGEST_RIG} bytes, so it is not a rig file");
    }
    Ok(text)
}

/// A rig with its settings applied.
pub(super) fn load_rig(rig: &str, settings: &[String]) -> Result<Rig> {
    let (source, text) = rig_text(rig)?;
    Ok(Rig::read_with(&source, &text, settings)?)
}

/// The rig that was chosen.
pub(super) fn load_choice(choice: &RigChoice) -> Result<Rig> {
    load_rig(&choice.rig, &choice.settings)
}
