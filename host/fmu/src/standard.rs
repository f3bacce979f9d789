//! The version of the standard that an FMU is of.

use anyhow::{Context, Result};

use crate::library::Library;

/// A version of the Functional Mock-up Interface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Standard {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    #[default]
    Fmi3,
}

impl Standard {
    /// All of them.
    pub const ALL: [Standard; 2] = [Standard::Fmi2, Standard::Fmi3];

    /// Its number, as in modelDescription.xml.
    #[must_use]
    pub fn version(self) -> &'static str {
        match self {
            Standard::Fmi2 => "2.0",
            Standard::Fmi3 => "3.0",
        }
    }

    /// Its name of the system of a library: the folder of the library in the archive.
    ///
    /// # Errors
    /// When it has none.
    pub fn platform(self, library: &Library) -> Result<String> {
        let [architecture, system] = library.system;
        match self {
            Standard::Fmi2 => platform_of_2(architecture, system).map(str::to_owned).with_context(|| {
                format!("FMI 2.0 has no name for {architecture}-{system}: write an FMU of 3.0 (--fmi 3.0)")
            }),
            Standard::Fmi3 => {
                let system = if system == "macos" { "darwin" } else { system };
                Ok(format!("{architecture}-{system}"))
            }
        }
    }
}

fn platform_of_2(architecture: &str, system: &str) -> Option<&'static str> {
    match (architecture, system) {
        ("x86_64", "linux") => Some("linux64"),
        ("x86_64", "windows") => Some("win64"),
        ("x86_64", "macos") => Some("darwin64"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_older_standard_has_names_for_processors_of_one_family_only() {
        assert_eq!(platform_of_2("x86_64", "linux"), Some("linux64"));
        assert_eq!(platform_of_2("x86_64", "macos"), Some("darwin64"));
        assert_eq!(platform_of_2("aarch64", "macos"), None);
    }
}
