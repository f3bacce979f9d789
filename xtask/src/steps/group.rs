//! Groups of tests that need tools of their own, or minutes.

use std::path::PathBuf;

use clap::ValueEnum;
use pneudrive_build::cargo::{self, THUMB, in_root, run};

use super::counted::{tests, tests_by};
use crate::tally::Tally;
use crate::tools::CHROMIUM;
use crate::{axe, boards, book, flashed, fmu, instructions, link, memory, probe, python, targets, web};

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
pub(super) enum Here {
    All,
    Part(String),
    Nothing(String),
}

impl Group {
    pub(super) fn here(self) -> Here {
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

    pub(super) fn run(self, tally: &mut Tally) {
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

fn short_flashed(tally: &mut Tally) {
    tests_by(tally, "a short run of the flashed image", flashed::short);
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

/// The checks of the boards that need no board.
fn images(tally: &mut Tally) {
    no_std_crates(tally);
    probe(tally);
}

pub(super) fn no_std_crates(tally: &mut Tally) {
    tally.check("no_std crates for the boards", || {
        let crates = ["pneudrive-controller", "pneudrive-protocol", "pneudrive-app", "pneudrive-interfaces"];
        let mut arguments = vec!["build", "--lib", "--keep-going", "--target", THUMB];
        arguments.extend(crates.iter().flat_map(|name| ["--package", name]));
        run(&mut in_root(&arguments))
    });
}

pub(super) fn ensure_flashed(tally: &mut Tally) {
    for tool in flashed::TOOLS {
        tally.check(tool.program, || tool.ensure());
    }
}

/// The book as a folder of pages.
pub fn book(tally: &mut Tally, out: Option<PathBuf>) {
    tally.check("the book", || {
        book::ensure()?;
        book::build(&out.map_or_else(book::usual_folder, Ok)?)
    });
}

/// The image that links the controller alone: no panic, no float, no division routine; then the board's.
pub fn probe(tally: &mut Tally) {
    tally.check("probe image", probe::check);
    tally.check("image for the Nucleo board", boards::check_nucleo);
    tally.check("image for the Pico 2", boards::check_pico2);
    tally.check("flash, memory and stack of the images", memory::check);
}
