//! The instructions of simulator runs, counted by valgrind, and their table in docs/reference/counts.md.
//!
//! On one machine they repeat to within a few; on another processor family they differ, and are not compared.

use std::process::Command;

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo::{built, in_root, run};
use pneudrive_build::figures::{self, OffTable, SPEED};

use crate::tools::VALGRIND;

/// The table.
const TABLE: &str = "instructions";

/// The lines above its rows.
const HEAD_LINES: usize = 2;

/// The system and the processor of the counts.
const COUNTED_ON: (&str, &str) = ("linux", "x86_64");

/// Compares the table with the present needs of runs.
///
/// # Errors
/// When a run needs more, with the remedy, or nothing can be counted.
pub fn check() -> Result<()> {
    if (std::env::consts::OS, std::env::consts::ARCH) != COUNTED_ON {
        let (os, processor) = COUNTED_ON;
        println!("the table is of {processor} under {os}: instructions are not compared here");
        return Ok(());
    }
    figures::hold(SPEED, TABLE, &measured()?, OffTable::Above)
}

/// Writes the table again.
///
/// # Errors
/// When nothing can be counted or written.
pub fn write() -> Result<()> {
    figures::write(SPEED, TABLE, &measured()?)
}

/// The table, measured: its runs and their samples are those that it has.
fn measured() -> Result<String> {
    VALGRIND.ensure()?;
    run(&mut in_root(&["build", "--release", "--package", "pneudrive-sim", "--example", "cost"]))?;
    let head = |line: &str| Ok(format!("{line}\n"));
    let of = |(k, line)| if k < HEAD_LINES { head(line) } else { row(line) };
    figures::lines(SPEED, TABLE)?.lines().enumerate().map(of).collect()
}

/// A new line with the run's name and its samples from an old one.
fn row(line: &str) -> Result<String> {
    let mut cells = line.split('|').map(str::trim).skip(1);
    let (name, samples) = (cells.next().unwrap_or_default(), cells.next().unwrap_or_default());
    let samples: u64 = samples.parse().with_context(|| format!("the samples of {line:?}"))?;
    let instructions = count(name)?;
    Ok(format!("| {name} | {samples} | {} | {} |\n", instructions / 1000, instructions / samples))
}

/// The instructions of a run's process.
fn count(name: &str) -> Result<u64> {
    let program = built("release/examples/cost")?;
    let mut command = Command::new(VALGRIND.program);
    command.args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]);
    let output = command.arg(program).arg(name).output().context("valgrind can't be started")?;
    let said = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "the run of {name} ended with {}: {said}", output.status);
    counted(&said).with_context(|| format!("valgrind reported no count for {name}: {said}"))
}

/// `I   refs:      149,089,887`
fn counted(said: &str) -> Option<u64> {
    let line = said.lines().find(|line| line.contains("refs:") && line.contains(" I "))?;
    let digits: String = line.rsplit(':').next()?.chars().filter(char::is_ascii_digit).collect();
    digits.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_is_read_out_of_what_valgrind_says() {
        let said = "==1== Command: cost\n==1== \n==1== I   refs:      149,089,887\n";
        assert_eq!(counted(said), Some(149_089_887));
        assert_eq!(counted("==1== D   refs:      1\n"), None);
    }
}
