//! The commit that is released, checked out into the folder in which every release is made: compilers write into programs
//! where their sources lay.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo::{in_folder, root, run};

use super::version::{self, git};

/// A commit and its folder.
#[derive(Clone, Debug)]
pub struct Source {
    version: String,
    commit: String,
    /// Seconds since 1970: when it was committed.
    time: String,
    folder: PathBuf,
}

impl Source {
    /// The last commit.
    ///
    /// # Errors
    /// When something is not committed, or files disagree about the version.
    pub fn of_head() -> Result<Source> {
        let version = version::check()?;
        let changed = git(&["status", "--porcelain"])?;
        ensure!(
            changed.is_empty(),
            "a release is made from a commit, and these are not committed:\n{changed}"
        );
        let folder = std::env::temp_dir().join(format!("pneudrive-{version}"));
        Ok(Source {
            commit: git(&["rev-parse", "HEAD"])?,
            time: git(&["log", "-1", "--format=%ct"])?,
            version,
            folder,
        })
    }

    /// Puts the sources there anew, without anything that was built before.
    ///
    /// # Errors
    /// When the folder cannot be emptied or git fails.
    pub fn check_out(&self) -> Result<()> {
        let folder = &self.folder;
        if folder.exists() {
            std::fs::remove_dir_all(folder).with_context(|| folder.display().to_string())?;
        }
        run(Command::new("git").args(["clone", "--quiet"]).arg(root()).arg(folder))?;
        run(Command::new("git").args(["checkout", "--quiet", &self.commit]).current_dir(folder))
    }

    /// Where the sources are.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Where they are built.
    #[must_use]
    pub fn target(&self) -> PathBuf {
        self.folder.join("target")
    }

    /// Name and version.
    #[must_use]
    pub fn name(&self) -> String {
        format!("pneudrive-{}", self.version)
    }

    /// The id that images of this commit bear (firmware/app/build.rs).
    #[must_use]
    pub fn build_id(&self) -> String {
        format!("{}+{}", self.version, self.commit.get(..12).unwrap_or(&self.commit))
    }

    /// Gives a call of a compiler this source's date and target folder, and other names for the folders of this machine.
    ///
    /// # Errors
    /// Without cargo or rustc.
    pub fn without_folders<'a>(&self, call: &'a mut Command) -> Result<&'a mut Command> {
        let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
        let home = home.or_else(|| Some(std::env::home_dir()?.join(".cargo"))).context("no home folder")?;
        let named = [(home, "/cargo"), (PathBuf::from(self.rustc(&["--print", "sysroot"])?), "/rust")];
        let flags = named.map(|(folder, name)| format!("--remap-path-prefix={}={name}", folder.display()));
        call.env("CARGO_ENCODED_RUSTFLAGS", flags.join("\x1f")).env_remove("RUSTFLAGS");
        call.env("CARGO_TARGET_DIR", self.target()).env("CARGO_INCREMENTAL", "0");
        Ok(call.env("SOURCE_DATE_EPOCH", &self.time))
    }

    /// Runs cargo in a folder of the sources.
    ///
    /// # Errors
    /// When it fails.
    pub fn cargo(&self, folder: &str, arguments: &[&str]) -> Result<()> {
        run(self.without_folders(&mut in_folder(&self.folder.join(folder), arguments))?)
    }

    /// What it was made from and with, for the release's readers.
    ///
    /// # Errors
    /// Without rustc.
    pub fn described(&self) -> Result<String> {
        let Source { version, commit, folder, .. } = self;
        let (rustc, build) = (self.rustc(&["--version"])?, self.build_id());
        Ok(format!(
            "pneudrive {version}\ncommit {commit}\nbuild id of the images {build}\n{rustc}\nsources in {}\n\n\
             The same bytes are made by `cargo xtask dist` at this commit.\n",
            folder.display()
        ))
    }

    /// What the pinned compiler prints.
    fn rustc(&self, arguments: &[&str]) -> Result<String> {
        let mut rustc = Command::new("rustc");
        let output = rustc.args(arguments).current_dir(root()).env_remove("RUSTUP_TOOLCHAIN").output()?;
        ensure!(output.status.success(), "rustc: {}", String::from_utf8_lossy(&output.stderr).trim());
        Ok(String::from_utf8(output.stdout)?.trim().to_owned())
    }
}
