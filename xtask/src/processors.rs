//! The simulator's results on other processors than this one, by an emulator of user programs: the same bits.
//!
//! Programs choose instructions when they run: the C library does, and so do some crates. A processor without AVX has none
//! of the wider ones to choose from.

use std::process::Command;

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo::{built, in_root, run};

use crate::tools::QEMU_USER;

/// Processors of QEMU: with SSE2 and SSE3 alone, without AVX, and with all that QEMU has.
const PROCESSORS: [&str; 3] = ["kvm64", "Nehalem", "max"];

/// The system and the processor that the simulator is built for.
const BUILT_FOR: (&str, &str) = ("linux", "x86_64");

/// Runs every built-in rig here and on each of the processors, and compares all bits.
///
/// # Errors
/// When a run differs, or cannot be emulated.
pub fn check() -> Result<()> {
    ensure!(
        (std::env::consts::OS, std::env::consts::ARCH) == BUILT_FOR,
        "the emulator runs programs for x86-64 under Linux: start it there"
    );
    QEMU_USER.ensure()?;
    run(&mut in_root(&["build", "--release", "--package", "pneudrive-sim", "--example", "bits"]))?;
    let program = built("release/examples/bits")?;
    let here = said(&mut Command::new(&program))?;
    for processor in PROCESSORS {
        let there = said(Command::new(QEMU_USER.program).args(["-cpu", processor]).arg(&program))?;
        compare(&here, &there).with_context(|| format!("on {processor}"))?;
        println!("{processor}: the runs of {} rigs are the same to the last bit", here.lines().count());
    }
    Ok(())
}

fn said(command: &mut Command) -> Result<String> {
    let output = command.output().with_context(|| format!("{command:?} can't be started"))?;
    let errors = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{command:?} ended with {}: {errors}", output.status);
    Ok(String::from_utf8(output.stdout)?)
}

/// A line a rig, with its hash.
fn compare(here: &str, there: &str) -> Result<()> {
    ensure!(!here.is_empty() && here.lines().count() == there.lines().count(), "not the same rigs are run");
    for (here, there) in here.lines().zip(there.lines()) {
        ensure!(here == there, "a run has other bits: {there}, and here {here}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bit_or_a_rig_that_differs_is_told() {
        assert!(compare("servo-a 01\n", "servo-a 01\n").is_ok());
        let said =
            compare("servo-a 01\nburrows 02\n", "servo-a 01\nburrows 03\n").expect_err("a bit differs");
        assert!(said.to_string().contains("burrows 03"), "{said}");
        assert!(compare("servo-a 01\n", "").is_err() && compare("", "").is_err());
    }
}
