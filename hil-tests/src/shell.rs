//! The `pneudrive` program at an execution level's port, as a user runs it.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use anyhow::Result;
use tempfile::TempDir;

use crate::program;

/// The exit code of a request that the rig refuses (docs/reference/exit-codes.md).
const REFUSED: i32 = 5;

/// A folder to type in, and the port that `device` means.
pub struct Shell {
    program: PathBuf,
    folder: TempDir,
    port: String,
}

impl Shell {
    /// A new folder; the program, built from the sources as they are.
    ///
    /// # Errors
    /// When it cannot be built.
    pub fn at(port: &str) -> Result<Shell> {
        Ok(Shell { program: program()?, folder: tempfile::tempdir()?, port: port.to_owned() })
    }

    /// What the program prints.
    ///
    /// # Panics
    /// When it does not end well.
    #[must_use]
    pub fn says(&self, arguments: &str) -> String {
        let (code, said, errors) = self.run(arguments);
        assert_eq!(code, Some(0), "pneudrive {arguments}: {said}{errors}");
        said
    }

    /// The same with `device`, its port and an action.
    ///
    /// # Panics
    /// When it does not end well.
    #[must_use]
    pub fn device(&self, action: &str) -> String {
        self.says(&self.at_port(action))
    }

    /// What `device` says of an action that the rig refuses.
    ///
    /// # Panics
    /// When it ends otherwise than by saying no.
    #[must_use]
    pub fn device_refuses(&self, action: &str) -> String {
        let (code, said, errors) = self.run(&self.at_port(action));
        assert_eq!(code, Some(REFUSED), "pneudrive device {action}: {said}{errors}");
        errors
    }

    /// Whether there is a file of that name.
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        Path::new(self.folder.path()).join(name).is_file()
    }

    fn at_port(&self, action: &str) -> String {
        format!("device --port {} {action}", self.port)
    }

    /// Exit code, output and errors.
    fn run(&self, arguments: &str) -> (Option<i32>, String, String) {
        let mut command = Command::new(&self.program);
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        let Output { status, stdout, stderr } = command.output().expect("the program runs");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (status.code(), text(&stdout), text(&stderr))
    }
}
