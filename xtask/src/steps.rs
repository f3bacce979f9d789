//! The commands. Each adds its results to a [`Tally`].

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::{Context, Result};
use clap::ValueEnum;
use pneudrive_build::cargo::{self, THUMB, THUMB_V8, in_firmware, in_root, run};
use pneudrive_build::firmware;

use crate::tally::{self, Counts, Tally};
use crate::tools::{CHROMIUM, QEMU};
use crate::{
    axe, boards, book, deny, dist, flashed, fmu, instructions, link, memory, probe, processors, programs,
    python, targets, web,
};

/// Formats all workspaces, or checks that they are formatted.
pub fn fmt(tally: &mut Tally, check: bool) {
    let check: &[&str] = if check { &["--", "--check"] } else { &[] };
    let root = [&["fmt", "--all"], check].concat();
    tally.check("format", || run(&mut in_root(&root)));
    // Without --all, which follows the paths to the outer workspace.
    let images = [&["fmt"], check].concat();
    tally.check("format of firmware/", || run(&mut in_firmware(&images, &cargo::image_folder()?)));
    tally.check("format of firmware/pico2/", || run(&mut in_pico2(&images)?));
    tally.check("format of fuzz/", || run(&mut cargo::in_folder(&cargo::root().join("fuzz"), &images)));
    tally.check("format of hil-tests/flashed-image/", || run(&mut flashed::cargo(&images)?));
    tally.check("format of host/python/", || run(&mut python::cargo(&images)?));
}

/// Clippy on the root workspace and the images; a warning is an error.
pub fn lint(tally: &mut Tally) {
    lint_root(tally);
    lint_images(tally);
}

fn lint_root(tally: &mut Tally) {
    let all = ["clippy", "--workspace", "--all-targets", "--keep-going", "--", "-D", "warnings"];
    tally.check("lint", || run(&mut in_root(&all)));
}

fn lint_images(tally: &mut Tally) {
    // A test harness does not build without std. The flags are those of the images, so that common crates are
    // compiled once.
    let images = ["clippy", "--release", "--workspace", "--", "-D", "warnings"];
    tally.check("lint of firmware/", || {
        cargo::ensure_thumb_target()?;
        run(&mut in_firmware(&images, &cargo::image_folder()?))
    });
    tally.check("lint of firmware/pico2/", || {
        cargo::ensure_target(THUMB_V8)?;
        run(&mut in_pico2(&images)?)
    });
}

/// A cargo call in the workspace of the Pico 2.
fn in_pico2(arguments: &[&str]) -> Result<Command> {
    Ok(cargo::in_inner(&cargo::firmware().join(firmware::PICO2), arguments, &cargo::image_folder()?))
}

/// Tests that need more than Rust and an emulator, or more time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Group {
    /// The HTML reports, the studio, and its page without a server in a browser: installs Chromium, and axe-core from
    /// npm, where allowed
    Web,
    /// The command compiled for Windows: installs the target
    Targets,
    /// A short run of the image that is flashed: installs cmake and clang where allowed
    Flashed,
    /// The Python package as a wheel, with what its tests need, in target/python-venv
    Python,
    /// FMUs, validated and simulated by FMPy in target/fmu-venv
    Fmu,
    /// The book, and where its links lead: builds mdBook
    Book,
    /// Long properties and soaks, all states of the link, instructions of the simulator
    Long,
    /// The images of the boards: what is in them, their calls, flash, memory and stack. Installs the targets
    Images,
}

/// How much of a group is tested when nothing is installed for it, and what it takes to test the rest.
enum Here {
    All,
    Part(String),
    Nothing(String),
}

impl Group {
    fn here(self) -> Here {
        match self {
            Group::Web if !CHROMIUM.is_there() => {
                Here::Nothing(format!("no page is opened, as there is no Chromium ({})", CHROMIUM.how()))
            }
            Group::Web if !axe::is_there() => {
                Here::Part("axe-core does not look at the pages (cargo xtask test web)".to_owned())
            }
            Group::Targets => targets::missing().map_or(Here::All, Here::Nothing),
            Group::Flashed => {
                flashed::TOOLS.into_iter().find(|tool| !tool.is_there()).map_or(Here::All, |tool| {
                    let (program, how) = (tool.program, tool.how());
                    Here::Nothing(format!("the flashed image is not run, as there is no {program} ({how})"))
                })
            }
            Group::Python if !python::ENVIRONMENT.is_prepared() => {
                Here::Nothing("the Python package is not tested (cargo xtask test python)".to_owned())
            }
            Group::Fmu if !fmu::ENVIRONMENT.is_prepared() => {
                Here::Nothing("no FMU is loaded by FMPy (cargo xtask test fmu)".to_owned())
            }
            Group::Fmu if !fmu::is_watched() => Here::Part(
                "the C functions of FMUs are not run under valgrind, which is for x86-64 Linux".to_owned(),
            ),
            Group::Book if !book::is_there() => {
                Here::Nothing("the book is not made (cargo xtask test book)".to_owned())
            }
            Group::Long => {
                Here::Nothing("long properties and soaks are not run (cargo xtask test long)".to_owned())
            }
            Group::Images => {
                Here::Nothing("the images of the boards are not built (cargo xtask test images)".to_owned())
            }
            Group::Web | Group::Python | Group::Fmu | Group::Book => Here::All,
        }
    }

    /// Installs the tools of the group; one that cannot be installed is a failure.
    fn install(self, tally: &mut Tally) {
        match self {
            Group::Web => {
                tally.check("browser", || CHROMIUM.ensure());
                tally.check("axe-core", axe::ensure);
            }
            Group::Flashed => ensure_flashed(tally),
            Group::Python => tally.check("environment of Python", python::prepare),
            Group::Fmu => tally.check("environment of FMPy", fmu::prepare),
            Group::Images => tally.check("target of the boards", cargo::ensure_thumb_target),
            Group::Book => tally.check("mdBook", book::ensure),
            Group::Targets | Group::Long => {}
        }
    }

    fn lint(self, tally: &mut Tally) {
        match self {
            Group::Flashed => tally.check("lint of hil-tests/flashed-image/", || {
                run(&mut flashed::cargo(&["clippy", "--all-targets", "--", "-D", "warnings"])?)
            }),
            Group::Python => tally.check("lint of host/python/", || {
                run(&mut python::cargo(&["clippy", "--locked", "--", "-D", "warnings"])?)
            }),
            _ => {}
        }
    }

    fn run(self, tally: &mut Tally) {
        match self {
            Group::Web => pages(tally),
            Group::Targets => targets::check_all(tally),
            Group::Flashed => short_flashed(tally),
            Group::Python => package(tally),
            Group::Fmu => fmus(tally),
            Group::Book => book(tally, None),
            Group::Long => long(tally),
            Group::Images => images(tally),
        }
    }
}

/// One group of tests; its tools are installed, or it fails.
pub fn test_group(tally: &mut Tally, group: Group) {
    group.install(tally);
    if let Here::Part(without) = group.here() {
        tally.leave_out(without);
    }
    group.lint(tally);
    group.run(tally);
}

/// The tests that take minutes: those that are otherwise ignored, and all states of the link within the bounds of CI.
fn long(tally: &mut Tally) {
    tests(tally, "long properties", &["test", "--workspace", "--tests", "--no-fail-fast", "--", "--ignored"]);
    link::states_in_short(tally);
    tally.check("instructions of the simulator", instructions::check);
}

/// The checks of the boards that need no board.
fn images(tally: &mut Tally) {
    no_std_crates(tally);
    probe(tally);
}

fn no_std_crates(tally: &mut Tally) {
    tally.check("no_std crates for the boards", || {
        let crates = ["pneudrive-controller", "pneudrive-protocol", "pneudrive-app", "pneudrive-interfaces"];
        let mut arguments = vec!["build", "--lib", "--keep-going", "--target", THUMB];
        arguments.extend(crates.iter().flat_map(|name| ["--package", name]));
        run(&mut in_root(&arguments))
    });
}

/// The FMUs, written by the command and loaded by FMPy.
fn fmus(tally: &mut Tally) {
    tally.check("FMUs in FMPy", fmu::test);
    if fmu::is_watched() {
        tally.check("C functions of FMUs under valgrind", fmu::watch);
    }
}

/// The Python package, built, installed and tested.
fn package(tally: &mut Tally) {
    tally.check("wheel of the Python package", python::install);
    tally.check("types of the Python package", python::check_types);
    tally.check("tests of the Python package", python::test);
}

fn ensure_flashed(tally: &mut Tally) {
    for tool in flashed::TOOLS {
        tally.check(tool.program, || tool.ensure());
    }
}

fn short_flashed(tally: &mut Tally) {
    tests_by(tally, "a short run of the flashed image", flashed::short);
}

/// Every body on the image that is flashed.
pub fn flashed(tally: &mut Tally, write: bool) {
    ensure_flashed(tally);
    tests_by(tally, "the flashed image", || flashed::all(write));
}

/// All tests on the PC and in the emulator. It first names the groups that it leaves out: those whose tools are missing, and
/// those that take longer than a first look at the sources may.
pub fn test(tally: &mut Tally) {
    let groups = Group::value_variants().iter().filter(|group| match group.here() {
        Here::All => true,
        Here::Part(without) => {
            tally.leave_out(without);
            true
        }
        Here::Nothing(what) => {
            tally.leave_out(what);
            false
        }
    });
    let groups: Vec<Group> = groups.copied().collect();
    test_without_groups(tally);
    groups.into_iter().for_each(|group| group.run(tally));
}

fn pages(tally: &mut Tally) {
    tests(tally, "pages in a browser", &["test", "--workspace", "--test", "pages"]);
    tests(tally, "the studio in a browser", &in_browser("in_browser", &["--skip", "browser_access"]));
    if axe::is_there() {
        tests_by(tally, "the studio for everybody", || {
            let mut tests = in_root(&in_browser("in_browser", &["browser_access"]));
            tests.env("PNEUDRIVE_AXE", axe::script()?);
            Ok(tests)
        });
    }
    tests_by(tally, "the studio without a server", || {
        let folder = web::usual_folder()?;
        web::build(&folder)?;
        let mut tests = in_root(&in_browser("without_server", &[]));
        tests.env("PNEUDRIVE_WEB", folder);
        Ok(tests)
    });
}

/// Tests in a browser, one after the other: they measure times. With the features of the whole workspace, whose crates are
/// built already where all tests are run.
fn in_browser<'a>(program: &'a str, which: &[&'a str]) -> Vec<&'a str> {
    let call = ["test", "--workspace", "--test", program, "--", "--nocapture", "--test-threads=1"];
    [&call[..], which].concat()
}

/// The studio's page as a folder of files.
pub fn web(tally: &mut Tally, out: Option<PathBuf>) {
    tally.check("the page without a server", || web::build(&out.map_or_else(web::usual_folder, Ok)?));
}

/// The book as a folder of pages.
pub fn book(tally: &mut Tally, out: Option<PathBuf>) {
    tally.check("the book", || {
        book::ensure()?;
        book::build(&out.map_or_else(book::usual_folder, Ok)?)
    });
}

fn test_without_groups(tally: &mut Tally) {
    tally.check("target of the boards", cargo::ensure_thumb_target);
    tally.check("emulator", || QEMU.ensure());
    beside(tally, |images| images.check("image for the emulator", boards::check_emulated), |_| {});
    test_programs(tally);
}

/// Compiles the tests, and images at the same time: these are built in a folder of their own, mostly by one core. Tests are run
/// after both, because some measure times.
fn beside(tally: &mut Tally, images: fn(&mut Tally), before: fn(&mut Tally)) {
    let images = std::thread::spawn(move || {
        let mut tally = Tally::default();
        images(&mut tally);
        tally
    });
    before(tally);
    tally.check("tests, compiled", programs::build);
    match images.join() {
        Ok(images) => tally.absorb(images),
        Err(_) => tally.fail(1, "the images: a panic, told above".to_owned()),
    }
}

fn test_programs(tally: &mut Tally) {
    programs::run(tally);
    // Of all crates at once, so that nothing is compiled again with other features. `--doc` overrides `doctest = false`.
    let others = ["--exclude", "pneudrive-hil-tests"];
    let call = [&["test", "--workspace", "--doc", "--no-fail-fast"], &others[..]].concat();
    tests(tally, "examples of the documentation", &call);
}

/// Tests that are counted one by one.
fn tests(tally: &mut Tally, name: &str, arguments: &[&str]) {
    tests_by(tally, name, || Ok(in_root(arguments)));
}

/// The same for any call of cargo.
fn tests_by(tally: &mut Tally, name: &str, call: impl FnOnce() -> Result<Command>) {
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

/// The documentation; a warning is an error, and so is a dead link.
pub fn docs(tally: &mut Tally) {
    tally.check("documentation", || {
        run(in_root(&["doc", "--workspace", "--no-deps", "--keep-going"]).env("RUSTDOCFLAGS", "-D warnings"))
    });
}

/// The image that links the controller alone: no panic, no float, no division routine; then the board's.
pub fn probe(tally: &mut Tally) {
    tally.check("probe image", probe::check);
    tally.check("image for the Nucleo board", boards::check_nucleo);
    tally.check("image for the Pico 2", boards::check_pico2);
    tally.check("flash, memory and stack of the images", memory::check);
}

/// Rewrites the figures of the control interrupt and of the images.
pub fn figures(tally: &mut Tally) {
    tally.check("emulator", || QEMU.ensure());
    tally.check("instructions of the control", || example("figures", &[]));
    tally.check("flash, memory and stack of the images", memory::write);
}

/// Rewrites the instructions of the simulator's runs.
pub fn cost(tally: &mut Tally) {
    tally.check("work of the simulator", || {
        run(&mut in_root(&["run", "--release", "--package", "pneudrive-sim", "--example", "cost"]))
    });
    tally.check("instructions of the simulator", instructions::write);
}

/// The simulator's results on other processors.
pub fn processors(tally: &mut Tally) {
    tally.check("bits on other processors", processors::check);
}

/// The numbers of the whole thesis, studies and all.
pub fn thesis(tally: &mut Tally, write: bool) {
    let arguments = [
        "test",
        "--release",
        "--package",
        "pneudrive",
        "--test",
        "all",
        "--",
        "thesis::the_numbers_are",
        "--nocapture",
    ];
    tally.check("numbers of the thesis", || {
        run(in_root(&arguments).env("PNEUDRIVE_THESIS", if write { "write" } else { "all" }))
    });
}

/// The test bodies on a real board.
pub fn hil(tally: &mut Tally, bodies: &[String]) {
    let bodies: Vec<&str> = bodies.iter().map(String::as_str).collect();
    tally.check("tests on the board", || example("board", &bodies));
}

/// The emulated board at a port, until it is interrupted.
pub fn board(tally: &mut Tally, rig: &str, listen: &str) {
    tally.check("target of the boards", cargo::ensure_thumb_target);
    tally.check("emulator", || QEMU.ensure());
    tally.check("the emulated board", || {
        // The program runs in the root of the project.
        let file = std::path::absolute(rig)?;
        let rig = if file.is_file() { file.to_str().context("the name of the rig file")? } else { rig };
        in_place(&mut call_of("serve", &[rig, listen]))
    });
}

/// Goes on as another program, for which Ctrl-C is then meant.
fn in_place(command: &mut Command) -> Result<()> {
    #[cfg(unix)]
    return Err(std::os::unix::process::CommandExt::exec(command).into());
    #[cfg(not(unix))]
    run(command)
}

/// A long run in the emulator.
pub fn soak(tally: &mut Tally, seconds: u32) {
    tally.check("emulator", || QEMU.ensure());
    tally.check("soak", || example("soak", &[&seconds.to_string()]));
}

/// Proves that the tests notice a changed rounding.
pub fn prove_rounding(tally: &mut Tally) {
    tally.check("emulator", || QEMU.ensure());
    tally.check("a changed rounding makes the test fail", || example("prove_rounding", &[]));
    ensure_flashed(tally);
    tests_by(tally, "a changed rounding in the flashed image", flashed::changed_rounding);
}

/// Makes changed results the golden ones.
pub fn bless(tally: &mut Tally, cause: &str) {
    tally.check("golden hashes", || example("bless", &[cause]));
}

/// Runs a program of hil-tests.
fn example(name: &str, arguments: &[&str]) -> Result<()> {
    run(&mut call_of(name, arguments))
}

fn call_of(name: &str, arguments: &[&str]) -> Command {
    let run_it = ["run", "--package", "pneudrive-hil-tests", "--example", name, "--"];
    in_root(&[&run_it, arguments].concat())
}

/// The checks of CI.
pub fn ci(tally: &mut Tally) {
    fmt(tally, true);
    tally.check("target of the boards", cargo::ensure_thumb_target);
    tally.check("emulator", || QEMU.ensure());
    let images = |images: &mut Tally| {
        images.check("image for the emulator", boards::check_emulated);
        lint_images(images);
        probe(images);
    };
    beside(tally, images, lint_root);
    no_std_crates(tally);
    test_programs(tally);
    for group in Group::value_variants().iter().filter(|group| **group != Group::Images) {
        test_group(tally, *group);
    }
    deny::check(tally);
    dist::check(tally);
    docs(tally);
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
