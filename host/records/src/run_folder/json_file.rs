//! Reading of run.json.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

use super::FORMAT;

/// Reads run.json.
///
/// # Errors
/// With the file, when this program has not written it.
pub(super) fn read_json(path: &Path) -> Result<serde_json::Value> {
    let text = fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    json_of(path, &text)
}

/// The same of a text that was read already.
///
/// # Errors
/// As [`read_json`].
pub(super) fn json_of(path: &Path, text: &str) -> Result<serde_json::Value> {
    let value: serde_json::Value =
        serde_json::from_str(text).with_context(|| format!("{} is not JSON", path.display()))?;
    if value["format"] != FORMAT {
        bail!("{} is not a run of this program: its format is not {FORMAT:?}", path.display());
    }
    Ok(value)
}
