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
    load_rig_judged_by(rig, settings, |_| true)
}

/// The same for a test that will go through points, if there are any: settings of the test hold for these, not for that of
/// the rig.
pub(super) fn load_rig_with(rig: &str, settings: &[String], points: bool) -> Result<Rig> {
    load_rig_judged_by(rig, settings, |key| !(points && key.starts_with("test.")))
}

fn load_rig_judged_by(rig: &str, settings: &[String], is_judged: impl Fn(&str) -> bool) -> Result<Rig> {
    let (source, text) = rig_text(rig)?;
    let rig = Rig::read_with(&source, &text, settings)?;
    let in_vain = rig.written_in_vain();
    let keys = settings.iter().filter_map(|setting| Some(setting.split_once('=')?.0.trim()));
    let mut typed = keys.filter(|key| is_judged(key)).filter_map(find_key);
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
