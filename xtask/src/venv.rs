//! Environments of Python in the target folder, for tests that need packages of it.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Result;
use pneudrive_build::cargo::{built, run};

use crate::tools::PYTHON;

/// An environment, by the name of its folder.
#[derive(Clone, Copy, Debug)]
pub struct Environment(pub &'static str);

impl Environment {
    /// A program of the environment.
    ///
    /// # Errors
    /// When CARGO_TARGET_DIR is relative and the current folder is gone.
    pub fn program(self, name: &str) -> Result<PathBuf> {
        let folder = if cfg!(windows) { "Scripts" } else { "bin" };
        Ok(built(self.0)?.join(folder).join(name))
    }

    /// Its Python.
    ///
    /// # Errors
    /// As [`Environment::program`].
    pub fn interpreter(self) -> Result<PathBuf> {
        self.program(if cfg!(windows) { "python.exe" } else { "python" })
    }

    /// Whether the environment was made before.
    #[must_use]
    pub fn is_prepared(self) -> bool {
        self.interpreter().is_ok_and(|python| python.exists())
    }

    /// Makes the environment, and installs the packages listed in a file.
    ///
    /// # Errors
    /// Without Python, or when a package cannot be installed.
    pub fn prepare(self, requirements: &Path) -> Result<()> {
        if !self.is_prepared() {
            PYTHON.ensure()?;
            run(Command::new(PYTHON.program).args(["-m", "venv"]).arg(built(self.0)?))?;
        }
        self.pip(&["--requirement", &requirements.to_string_lossy()])
    }

    /// Installs packages.
    ///
    /// # Errors
    /// When one cannot be installed.
    pub fn pip(self, arguments: &[&str]) -> Result<()> {
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        run(Command::new(self.interpreter()?).args(install).args(arguments))
    }
}
