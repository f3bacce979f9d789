//! Reads a rig file: once for one rig, or for many rigs that differ in some values.

use super::reader::{Noted, Reader};
use super::value::{item_of, value_of};
use crate::keys;
use crate::rig::{Problems, find_key, preset_value, presets, unknown_key};
use crate::values::{Rig, Value};

impl Rig {
    /// Reads a rig file; `source` is its name for messages.
    ///
    /// ```
    /// use pneudrive_sim::{Rig, keys};
    ///
    /// let rig = Rig::read("mine.toml", "[supply]\npressure = \"6 bar(g)\"").expect("a valid file");
    /// assert_eq!(rig.get(&keys::supply::PRESSURE_PA), 701_300.0);
    /// assert_eq!(rig.get(&keys::load::MASS_KG), 1.6, "what a file does not say has a default");
    ///
    /// let problems = Rig::read("mine.toml", "[load]\nmas_kg = 8").expect_err("a misspelled key");
    /// assert_eq!(problems.to_string(), "mine.toml:2: load.mas_kg: unknown key; did you mean mass_kg?");
    /// ```
    ///
    /// # Errors
    /// Every problem with its line and key.
    pub fn read(source: &str, text: &str) -> Result<Rig, Problems> {
        RigFile::read(source, text).into_rig(&[""; 0])
    }

    /// Reads a rig file and applies `key=value` settings, each in TOML syntax.
    ///
    /// # Errors
    /// Every problem with its line and key.
    pub fn read_with(source: &str, text: &str, settings: &[impl AsRef<str>]) -> Result<Rig, Problems> {
        RigFile::read(source, text).into_rig(settings)
    }

    /// This rig with `key=value` settings applied, each in TOML syntax.
    ///
    /// ```
    /// use pneudrive_sim::{Rig, keys};
    ///
    /// let heavy = Rig::builtin("servo-b").expect("a built-in rig").with_settings(&["load.mass_kg=20"]);
    /// assert_eq!(heavy.expect("in its range").get(&keys::load::MASS_KG), 20.0);
    /// ```
    ///
    /// # Errors
    /// Every problem with its key.
    pub fn with_settings(&self, settings: &[impl AsRef<str>]) -> Result<Rig, Problems> {
        let mut reader = Reader::new(self.name(), "");
        let mut rig = self.changed(&mut reader, settings);
        // What a setting says, the controller knows.
        let Rig { values, nominal, .. } = &mut rig;
        nominal.retain(|path, _| values.get(path) == self.values.get(path));
        rig.checked_by(reader)
    }

    /// This rig with a plant that differs from what its controller takes it for, by `key=value` settings, each in TOML
    /// syntax. The parameters of the controller stay, but for what a setting of its own changes.
    ///
    /// # Errors
    /// Every problem with its key.
    pub fn with_plant(&self, settings: &[impl AsRef<str>]) -> Result<Rig, Problems> {
        let mut reader = Reader::new(self.name(), "");
        let mut rig = self.changed(&mut reader, settings);
        rig.keep_nominal_of(self);
        rig.checked_by(reader)
    }

    fn changed(&self, reader: &mut Reader, settings: &[impl AsRef<str>]) -> Rig {
        let mut rig = self.clone();
        for setting in settings {
            reader.setting(&mut rig, setting.as_ref());
        }
        reader.finish(&mut rig);
        rig
    }

    /// This rig with another test: the test of the empty file with these `key=value` settings.
    ///
    /// # Errors
    /// Every problem with its key.
    pub fn with_test(&self, settings: &[impl AsRef<str>]) -> Result<Rig, Problems> {
        let mut rig = self.clone();
        for key in keys::test::ALL {
            rig.put(key.path, preset_value(&key.preset));
            rig.set.remove(key.path);
            rig.origins.remove(key.path);
        }
        rig.with_settings(settings)
    }

    /// The rig that a reader has filled, if nothing is wrong with it.
    fn checked_by(mut self, mut reader: Reader) -> Result<Rig, Problems> {
        self.suit_others();
        if reader.file.problems.is_empty() {
            reader.note(self.findings(&reader.in_vain));
        }
        reader.file.end(self)
    }
}

/// A rig file that has been read, for rigs of it with different settings.
#[derive(Clone, Debug)]
pub struct RigFile {
    source: String,
    /// With the values of the file, unchecked.
    rig: Rig,
    noted: Noted,
}

impl RigFile {
    /// Reads a rig file; `source` is its name for messages. Its problems are reported with each rig.
    #[must_use]
    pub fn read(source: &str, text: &str) -> RigFile {
        let (mut reader, mut rig) = (Reader::new(source, text), presets());
        if let Some(document) = reader.file.document() {
            reader.top(&mut rig, document.as_table());
        }
        // A setting may take the effect of a key of the file away.
        let mut of_file = rig.clone();
        of_file.suit_others();
        reader.in_vain = of_file.written_in_vain();
        RigFile { source: source.to_owned(), rig, noted: reader.into_noted() }
    }

    /// The rig of the file with `key=value` settings applied, each in TOML syntax.
    ///
    /// # Errors
    /// Every problem with its line and key.
    pub fn with(&self, settings: &[impl AsRef<str>]) -> Result<Rig, Problems> {
        self.clone().into_rig(settings)
    }

    fn into_rig(self, settings: &[impl AsRef<str>]) -> Result<Rig, Problems> {
        let RigFile { source, mut rig, noted } = self;
        let mut reader = Reader::resume(&source, noted);
        for setting in settings {
            reader.setting(&mut rig, setting.as_ref());
        }
        reader.finish(&mut rig);
        rig.checked_by(reader)
    }
}

/// The value that a setting `path=text` gives a key, whatever the other keys are.
///
/// # Errors
/// The problem with a key or value.
pub fn value_of_setting(path: &str, text: &str) -> Result<Value, String> {
    let key = find_key(path).ok_or_else(|| unknown_key(path))?;
    value_of(key, &item_of(text))
}
