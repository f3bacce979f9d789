//! The built-in rigs, and the text of a saved one.

use http::StatusCode;
use pneudrive_records::rig_text;
use pneudrive_sim::Rig;
use pneudrive_sim::rig::key_of;
use pneudrive_sim::rigfile::{BUILTIN, builtin};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::page_rig::PageRig;
use crate::refusal::HttpRefusal;

/// A rig file that the page can begin with.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Opened {
    /// Its name on the command line.
    pub name: String,
    /// The text.
    pub text: String,
}

impl Opened {
    /// A built-in rig.
    ///
    /// # Errors
    /// When there is none of that name.
    pub fn builtin(name: &str) -> Result<Opened, HttpRefusal> {
        let text = builtin(name).ok_or_else(|| {
            HttpRefusal::new(StatusCode::NOT_FOUND, format!("there is no built-in rig {name}"))
        })?;
        Ok(Opened { name: name.to_owned(), text: text.to_owned() })
    }
}

/// The built-in rigs, the one that was opened, and the version of the program.
#[must_use]
pub fn list(opened: &Opened) -> Value {
    let about = |text: &str| text.lines().next().unwrap_or("").trim_start_matches("# ").to_owned();
    let builtin = BUILTIN.iter().map(|(name, text)| json!({ "name": name, "about": about(text) }));
    json!({ "builtin": builtin.collect::<Vec<_>>(), "opened": opened, "version": env!("CARGO_PKG_VERSION") })
}

/// A rig to be saved.
#[derive(Debug, Deserialize)]
pub struct ToSave {
    /// The rig.
    #[serde(flatten)]
    pub asked: PageRig,
    /// The name of the file.
    pub file: String,
    /// Whether the user has agreed to replace a file.
    #[serde(default)]
    pub replace: bool,
}

/// The opened file, with the settings in place of the old values and all other lines kept.
///
/// # Errors
/// When the rig is not valid.
pub fn text_to_save(asked: &PageRig, file: &str) -> Result<String, HttpRefusal> {
    let rig = asked.rig()?;
    let settings = in_key_units(asked, &rig);
    let text = rig_text::with_settings(&asked.text, &settings, "given: set in the studio");
    let text = text.map_err(|error| HttpRefusal::of(&error))?;
    // The written file is the one that was shown.
    Rig::read(file, &text)?;
    Ok(text)
}

/// The settings with each value in the unit of its key.
pub(crate) fn in_key_units(asked: &PageRig, rig: &Rig) -> Vec<String> {
    let in_unit = |setting: &String| {
        let path = setting.split('=').next().unwrap_or_default().trim();
        let key = key_of(path)?;
        rig.value(key.path).map(|value| key.setting(value))
    };
    asked.settings.iter().filter_map(in_unit).collect()
}
