//! The commands. Each adds its results to a [`Tally`].

mod counted;
mod group;

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, Result};
use clap::ValueEnum;
use pneudrive_build::cargo::{self, THUMB_V8, in_firmware, in_root, run};
use pneudrive_build::firmware;

use crate::tally::Tally;
use crate::tools::QEMU;
use crate::{boards, deny, dist, flashed, instructions, memory, processors, programs, python, web};
use counted::{tests, tests_by};
pub use group::{Group, book, probe, test_group};
use group::{Here, ensure_flashed, no_std_crates};

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

/// The studio's page as a folder of files.
pub fn web(tally: &mut Tally, out: Option<PathBuf>) {
    tally.check("the page without a server", || web::build(&out.map_or_else(web::usual_folder, Ok)?));
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

/// The documentation; a warning is an error, and so is a dead link.
pub fn docs(tally: &mut Tally) {
    tally.check("documentation", || {
        run(in_root(&["doc", "--workspace", "--no-deps", "--keep-going"]).env("RUSTDOCFLAGS", "-D warnings"))
    });
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
