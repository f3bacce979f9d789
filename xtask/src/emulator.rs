//! The emulator: QEMU for the boards' processor.

use std::process::{Command, Stdio};

use anyhow::{Result, bail};

use crate::cargo::run;

/// The emulator, and the package that brings it.
const QEMU: &str = "qemu-system-arm";

/// Makes sure that there is an emulator; installs it where apt-get is and may.
///
/// # Errors
/// When it's missing and can't be installed, with what to do.
pub fn ensure() -> Result<()> {
    if answers(QEMU, "--version") {
        return Ok(());
    }
    if !answers("apt-get", "--version") || !is_root() {
        bail!(
            "{QEMU} is not found, and the tests need it: install it (apt-get install {QEMU}, brew install qemu, ...)"
        );
    }
    println!("installing the emulator: apt-get install {QEMU}");
    run(Command::new("apt-get").arg("update"))?;
    run(Command::new("apt-get").args(["install", "--yes", "--no-install-recommends", QEMU]))
}

fn answers(program: &str, argument: &str) -> bool {
    let status = Command::new(program).arg(argument).stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}
