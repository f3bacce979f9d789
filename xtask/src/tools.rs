//! The programs that tests need besides Rust: the emulator of the boards' processor, a counter of instructions, a
//! browser, and the build tools for the emulator of the flashed image.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Result, bail};
use pneudrive_build::cargo::{built, in_root, run};

/// A program, and the package that brings it.
pub struct Tool {
    /// Name of the program.
    pub program: &'static str,
    /// The package of apt.
    package: &'static str,
    /// How it is installed, in words.
    how: &'static str,
}

/// The emulator.
pub const QEMU: Tool = Tool {
    program: "qemu-system-arm",
    package: "qemu-system-arm",
    how: "apt-get install qemu-system-arm, brew install qemu, ...",
};

/// The emulator of other processors of this kind, for programs of Linux.
pub const QEMU_USER: Tool =
    Tool { program: "qemu-x86_64", package: "qemu-user", how: "apt-get install qemu-user, ..." };

/// The counter of instructions.
pub const VALGRIND: Tool =
    Tool { program: "valgrind", package: "valgrind", how: "apt-get install valgrind, ..." };

/// The browser that opens the pages.
pub const CHROMIUM: Tool = Tool {
    program: "chromium",
    package: "chromium",
    how: "apt-get install chromium, brew install --cask chromium, ...",
};

/// The tool that brings axe-core.
pub const NPM: Tool =
    Tool { program: "npm", package: "npm", how: "apt-get install npm, brew install node, ..." };

/// The interpreter of the Python package.
pub const PYTHON: Tool = Tool {
    program: "python3",
    package: "python3",
    how: "apt-get install python3 python3-venv, brew install python, ...",
};

/// The tool that builds the emulator of the flashed image.
pub const CMAKE: Tool =
    Tool { program: "cmake", package: "cmake", how: "apt-get install cmake, brew install cmake, ..." };

/// The tool that reads the headers of that emulator.
pub const CLANG: Tool =
    Tool { program: "clang", package: "clang", how: "apt-get install clang, brew install llvm, ..." };

/// A program of Rust that is built from crates.io, in the folder of what is built.
pub struct CargoTool {
    /// Its package and its name.
    pub name: &'static str,
    /// The version that is built.
    pub version: &'static str,
    /// Its features, without those of the default.
    pub features: &'static [&'static str],
}

impl CargoTool {
    /// The path of the program once it is built.
    ///
    /// # Errors
    /// When the target folder is not known.
    pub fn path(&self) -> Result<PathBuf> {
        Ok(built("tools")?.join("bin").join(format!("{}{}", self.name, std::env::consts::EXE_SUFFIX)))
    }

    /// Builds the program if it is missing, and returns its path.
    ///
    /// # Errors
    /// When it cannot be built.
    pub fn ensure(&self) -> Result<PathBuf> {
        let path = self.path()?;
        if !path.exists() {
            let (package, features) = (format!("{}@{}", self.name, self.version), self.features.join(","));
            println!("building {package} in {}", built("tools")?.display());
            let install = ["install", &package, "--locked", "--no-default-features", "--features", &features];
            // It runs for seconds and is built once: what an optimisation saves, building it costs several times.
            let mut install = in_root(&install);
            install.arg("--root").arg(built("tools")?).env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0");
            run(&mut install)?;
        }
        Ok(path)
    }
}

impl Tool {
    /// Whether the program is installed.
    #[must_use]
    pub fn is_there(&self) -> bool {
        answers(self.program, "--version")
    }

    /// How the program is installed, in words.
    #[must_use]
    pub fn how(&self) -> &'static str {
        self.how
    }

    /// Ensures that the program is installed: apt-get installs it where that is possible and allowed.
    ///
    /// # Errors
    /// When it is missing and cannot be installed, with the remedy.
    pub fn ensure(&self) -> Result<()> {
        let Tool { program, package, how } = self;
        if self.is_there() {
            return Ok(());
        }
        if !answers("apt-get", "--version") || !is_root() {
            bail!("{program} is not found, and the tests need it: install it ({how})");
        }
        println!("installing {program}: apt-get install {package}");
        run(Command::new("apt-get").arg("update"))?;
        run(Command::new("apt-get").args(["install", "--yes", "--no-install-recommends", package]))
    }
}

fn answers(program: &str, argument: &str) -> bool {
    let status = Command::new(program).arg(argument).stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}
