//! Rigs named on the command line: a built-in rig, or a file.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};
use pneudrive_records::move_points::{Through, through};
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

/// The rig with a test that goes through the points of a table; settings of a test hold beside them.
pub(super) fn through_points(rig: &Rig, table: &Path, settings: &[String]) -> Result<Through> {
    let bytes = fs::read(table).with_context(|| table.display().to_string())?;
    through(rig, &bytes, settings).with_context(|| table.display().to_string())
}
