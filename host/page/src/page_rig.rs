//! The content of a request: a rig file, and the changes made on the page.

use pneudrive_sim::Rig;
use pneudrive_sim::rig::Problems;
use serde::Deserialize;

/// A rig on the page.
#[derive(Clone, Debug, Deserialize)]
pub struct PageRig {
    /// Name of the rig file or of the built-in rig, for messages.
    pub name: String,
    /// The rig file as it was opened.
    pub text: String,
    /// The changes since: `key=value`, as for `--set`.
    #[serde(default)]
    pub settings: Vec<String>,
}

impl PageRig {
    /// The rig with its settings.
    ///
    /// # Errors
    /// Every problem with its key.
    pub fn rig(&self) -> Result<Rig, Problems> {
        Rig::read_with(&self.name, &self.text, &self.settings)
    }

    /// The command line that simulates this rig.
    #[must_use]
    pub(crate) fn command_line(&self) -> String {
        self.command("simulate", "--out sim")
    }

    /// The command line of another command for this rig; `rest` follows the rig and its settings.
    pub(crate) fn command(&self, name: &str, rest: &str) -> String {
        let settings = self.settings.iter().map(|setting| format!(" --set {}", quoted(setting)));
        format!("pneudrive {name} {}{} {rest}", quoted(&self.name), settings.collect::<String>())
    }
}

/// A word, quoted for a POSIX shell.
pub(crate) fn quoted(word: &str) -> String {
    let plain = |letter: char| letter.is_ascii_alphanumeric() || "-_./=+:,@%".contains(letter);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_survives_a_shell() {
        let settings = ["load.mass_kg=2.5", "test.moves=[[0.0, 8192]]", "name=\"it's\""];
        let asked = PageRig {
            name: "my rig.toml".to_owned(),
            text: String::new(),
            settings: settings.map(str::to_owned).to_vec(),
        };
        assert_eq!(
            asked.command_line(),
            "pneudrive simulate 'my rig.toml' --set load.mass_kg=2.5 --set 'test.moves=[[0.0, 8192]]' --set 'name=\"it'\\''s\"' --out sim"
        );
    }
}
