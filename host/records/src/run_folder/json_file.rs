//! Reading of run.json.

use std::path::Path;

use anyhow::{Context, Result, bail};

use super::FORMAT;
use crate::text_file;

/// Reads run.json.
///
/// # Errors
/// With the file, when this program has not written it.
pub(super) fn read_json(path: &Path) -> Result<serde_json::Value> {
    let text = text_file::read(path)?;
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
