//! Rigs named on the command line: a built-in rig, or a file.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};
use pneudrive_records::move_points::{Through, through};
pub(super) use pneudrive_records::rig_source::rig_text;
use pneudrive_sim::Rig;
use pneudrive_sim::rig::find_key;

use crate::cli::RigChoice;

/// A rig with its settings applied. A setting that would do nothing is refused, as such a line of the file is.
pub(super) fn load_rig(rig: &str, settings: &[String]) -> Result<Rig> {
    let (source, text) = rig_text(rig)?;
    let rig = Rig::read_with(&source, &text, settings)?;
    let in_vain = rig.written_in_vain();
    let mut typed = settings.iter().filter_map(|setting| find_key(setting.split_once('=')?.0.trim()));
    if let Some(key) = typed.find(|key| in_vain.contains(key.path)) {
        bail!("--set: {} has no effect with {}: leave it out", key.path, rig.idle(key).unwrap_or_default());
    }
    Ok(rig)
}

/// The rig that was chosen.
pub(super) fn load_choice(choice: &RigChoice) -> Result<Rig> {
    load_rig(&choice.rig, &choice.settings)
}

/// The rig with a test that goes through the points of a table; settings of a test hold beside them.
pub(super) fn through_points(rig: &Rig, table: &Path, settings: &[String]) -> Result<Through> {
    let bytes = fs::read(table).with_context(|| table.display().to_string())?;
    through(rig, &bytes, settings).with_context(|| table.display().to_string())
}
