//! The test programs of the workspace: compiled by one call of cargo, then run side by side.
//!
//! ```text
//! emulated  first and by themselves: an emulator and its plant wait for each other, and on a busy machine long
//! longest   next, so that none is left over at the end
//! others    beside them, one program a core; with more threads than cores where tests wait for processes and time-outs
//! alone     then, one after the other: they measure what a line carries in real time
//! examples  last: programs for readers, of which each prints what it is known to print
//! ```

use std::num::NonZero;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use pneudrive_build::cargo::{in_root, root};
use serde::Deserialize;

use crate::examples;
use crate::tally::{Counts, Tally, failed_test};

/// Programs that take longest.
const LONGEST: [&str; 2] = ["host/tests/all", "sim/tests/all"];

/// The program of the emulated boards.
const EMULATED: [&str; 1] = ["hil-tests/tests/all"];

/// Programs whose tests wait more than they compute.
const WAITING: [&str; 2] = ["host/tests/all", "host/studio/tests/all"];

/// Programs that no other may run beside.
const ALONE: [&str; 1] = ["host/rigs/tests/all"];

/// What cargo builds: every test program, and the examples that tests run. Other examples are checked by `cargo xtask lint`.
const BUILD: [&str; 5] = ["build", "--workspace", "--tests", "--example", "board"];

/// A line of cargo's messages.
#[derive(Deserialize)]
struct Message {
    #[serde(default)]
    manifest_path: PathBuf,
    target: Option<Target>,
    profile: Option<Profile>,
    executable: Option<PathBuf>,
}

#[derive(Deserialize)]
struct Target {
    name: String,
    kind: Vec<String>,
}

#[derive(Deserialize)]
struct Profile {
    test: bool,
}

/// Whether a program is a test or an example.
#[derive(Clone, Copy)]
enum Kind {
    Tests,
    Example,
}

/// A test program, or an example.
struct Program {
    /// Its crate's folder in the workspace and where its tests are: `host/tests/all`, `sim/src`; an example's own name.
    name: String,
    /// Its crate's folder.
    folder: PathBuf,
    executable: PathBuf,
}

/// What cargo has built.
#[derive(Default)]
struct Built {
    programs: Vec<Program>,
    examples: Vec<Program>,
}

/// The outcome of a program.
struct Execution {
    output: Output,
    took: Duration,
}

/// Compiles them.
///
/// # Errors
/// When they do not compile.
pub fn build() -> Result<()> {
    built().map(drop)
}

/// Compiles and runs them, and counts their tests. What a program prints is shown if a test of it fails.
pub fn run(tally: &mut Tally) {
    let Built { mut programs, examples } = match tally.timed("tests, compiled", |_| built()) {
        Ok(built) => built,
        Err(error) => return tally.fail(1, format!("tests: {error:#}")),
    };
    programs.sort_by_key(|program| !is_of(&LONGEST, program));
    let (emulated, others): (Vec<_>, Vec<_>) =
        programs.into_iter().partition(|program| is_of(&EMULATED, program));
    let (alone, others) = others.into_iter().partition(|program| is_of(&ALONE, program));
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    tally.timed("tests of emulated boards", |tally| run_on(tally, emulated, 1, cores));
    tally.timed("tests, side by side", |tally| run_on(tally, others, cores, cores));
    tally.timed("tests, alone", |tally| run_on(tally, alone, 1, 1));
    for example in examples::ALL {
        tally.check(&format!("example {}", example.name), || {
            let built =
                examples.iter().find(|built| built.name == example.name).context("it is not built")?;
            example.check(&built.executable)
        });
    }
}

fn is_of(names: &[&str], program: &Program) -> bool {
    names.contains(&program.name.as_str())
}

fn built() -> Result<Built> {
    let examples = examples::ALL.iter().flat_map(|example| ["--example", example.name]);
    let format = ["--message-format", "json-render-diagnostics"];
    let mut build = in_root(&BUILD.into_iter().chain(examples).chain(format).collect::<Vec<&str>>());
    let output = build.stderr(Stdio::inherit()).output().context("cargo can't be started")?;
    ensure!(output.status.success(), "they do not compile");
    let mut built = Built::default();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        match Program::of(line)? {
            Some((program, Kind::Tests)) => built.programs.push(program),
            Some((example, Kind::Example)) => built.examples.push(example),
            None => {}
        }
    }
    Ok(built)
}

impl Program {
    /// The program that a message of cargo names, if it names one.
    fn of(line: &str) -> Result<Option<(Program, Kind)>> {
        let message: Message = serde_json::from_str(line).with_context(|| format!("cargo says {line}"))?;
        let Message { manifest_path, target: Some(target), profile: Some(profile), executable } = message
        else {
            return Ok(None);
        };
        let is = |kind: &str| target.kind.iter().any(|one| one == kind);
        let kind = if profile.test { Kind::Tests } else { Kind::Example };
        let Some(executable) = executable.filter(|_| profile.test || is("example")) else { return Ok(None) };
        let folder = manifest_path.parent().context("a manifest lies in a folder")?.to_owned();
        let home = folder.strip_prefix(root()).unwrap_or(&folder).to_string_lossy();
        let name = match kind {
            Kind::Example => target.name,
            Kind::Tests if is("test") => format!("{home}/tests/{}", target.name),
            Kind::Tests => format!("{home}/src"),
        };
        Ok(Some((Program { name, folder, executable }, kind)))
    }

    fn run(&self, threads: usize) -> Result<Execution> {
        let threads = if is_of(&WAITING, self) { 2 * threads } else { threads };
        let mut command = Command::new(&self.executable);
        command.current_dir(&self.folder).env("RUST_TEST_THREADS", threads.to_string());
        let begin = Instant::now();
        let output = command.output().with_context(|| format!("{} can't be started", self.name))?;
        Ok(Execution { output, took: begin.elapsed() })
    }
}

/// Runs programs in order, this many at a time, each with this many threads.
fn run_on(tally: &mut Tally, programs: Vec<Program>, at_once: usize, threads: usize) {
    let (queue, tally) = (Mutex::new(programs.into_iter()), Mutex::new(tally));
    let next = || queue.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).next();
    let work = || {
        while let Some(program) = next() {
            let ran = program.run(threads);
            follow(*tally.lock().unwrap_or_else(|poisoned| poisoned.into_inner()), &program.name, ran);
        }
    };
    thread::scope(|scope| {
        for _ in 0..at_once {
            scope.spawn(work);
        }
    });
}

/// Counts what a program printed, and shows it if a test failed.
fn follow(tally: &mut Tally, name: &str, ran: Result<Execution>) {
    let Execution { output, took } = match ran {
        Ok(ran) => ran,
        Err(error) => return tally.fail(1, format!("{error:#}")),
    };
    let printed = String::from_utf8_lossy(&output.stdout);
    let counts = printed.lines().find_map(Counts::in_line);
    println!("{:>6.1} s {:>5} tests  {name}", took.as_secs_f64(), counts.map_or(0, |counts| counts.passed));
    if !output.status.success() {
        println!("{printed}{}", String::from_utf8_lossy(&output.stderr));
        printed.lines().filter_map(failed_test).for_each(|test| tally.fail(0, format!("{name}: {test}")));
    }
    match counts {
        Some(counts) if output.status.success() || counts.failed > 0 => tally.add(counts),
        _ => tally.fail(1, format!("{name} ended with {}", output.status)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(kind: &str, name: &str, test: bool) -> Option<(Program, Kind)> {
        let manifest = root().join("sim/solver/Cargo.toml");
        let line = serde_json::json!({
            "manifest_path": manifest,
            "target": { "kind": [kind], "name": name },
            "profile": { "test": test },
            "executable": "/target/it",
        });
        Program::of(&line.to_string()).expect("a message")
    }

    #[test]
    fn examples_are_told_from_programs_of_tests_and_from_those_of_users() {
        for (told, name, is_example) in [
            (told("test", "all", true), "sim/solver/tests/all", false),
            (told("lib", "pneudrive_solver", true), "sim/solver/src", false),
            (told("example", "bouncing_ball", true), "sim/solver/src", false),
            (told("example", "bouncing_ball", false), "bouncing_ball", true),
        ] {
            let (program, kind) = told.expect("a program");
            assert_eq!((program.name.as_str(), matches!(kind, Kind::Example)), (name, is_example));
        }
        assert!(told("bin", "pneudrive", false).is_none());
    }
}
