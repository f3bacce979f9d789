//! Rigs named on the command line: a built-in rig, or a file.

use anyhow::Result;
pub(super) use pneudrive_records::rig_source::rig_text;
use pneudrive_sim::Rig;

use crate::cli::RigChoice;

/// A rig with its settings applied.
pub(super) fn load_rig(rig: &str, settings: &[String]) -> Result<Rig> {
    let (source, text) = rig_text(rig)?;
    Ok(Rig::read_with(&source, &text, settings)?)
}

/// The rig that was chosen.
pub(super) fn load_choice(choice: &RigChoice) -> Result<Rig> {
    load_rig(&choice.rig, &choice.settings)
}
