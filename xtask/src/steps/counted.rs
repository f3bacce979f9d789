//! Calls of `cargo test` whose tests are counted one by one.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use anyhow::{Context, Result};
use pneudrive_build::cargo::in_root;

use crate::tally::{self, Counts, Tally};

/// Tests that are counted one by one.
pub(super) fn tests(tally: &mut Tally, name: &str, arguments: &[&str]) {
    tests_by(tally, name, || Ok(in_root(arguments)));
}

/// The same for any call of cargo.
pub(super) fn tests_by(tally: &mut Tally, name: &str, call: impl FnOnce() -> Result<Command>) {
    let before = tally.failed();
    match tally.timed(name, |tally| follow_tests(tally, &mut call()?)) {
        Ok(true) => {}
        Ok(false) if tally.failed() > before => {}
        Ok(false) => tally.fail(1, format!("{name}: cargo test did not finish")),
        Err(error) => tally.fail(1, format!("{name}: {error:#}")),
    }
}

/// Runs the tests, shows their output as it comes and counts them; returns whether cargo succeeded.
fn follow_tests(tally: &mut Tally, command: &mut Command) -> Result<bool> {
    let mut child = command.stdout(Stdio::piped()).spawn().context("cargo can't be started")?;
    if let Some(stdout) = child.stdout.take() {
        for line in BufReader::new(stdout).split(b'\n') {
            let line = line.context("the tests' output")?;
            follow_line(tally, String::from_utf8_lossy(&line).trim_end());
        }
    }
    Ok(child.wait().context("cargo test")?.success())
}

fn follow_line(tally: &mut Tally, line: &str) {
    println!("{line}");
    if let Some(counts) = Counts::in_line(line) {
        tally.add(counts);
    } else if let Some(name) = tally::failed_test(line) {
        tally.fail(0, format!("test {name}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failed_tests_are_named_once_and_counted_once() {
        let mut tally = Tally::default();
        for line in [
            "test law::odd ... FAILED",
            "test law::even ... ok",
            "test result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out",
        ] {
            follow_line(&mut tally, line);
        }
        assert_eq!(tally.summary(), "1 passed, 1 failed");
    }
}
