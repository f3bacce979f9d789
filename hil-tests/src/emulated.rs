//! The emulated board as an execution level, and the builds for it.

use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use anyhow::{Context, Result, anyhow};
use pneudrive_sim::Rig;

use crate::emulated_board::EmulatedBoard;
use crate::service::commission;
use crate::{Delayed, Supplied, Target};

/// The firmware's image on an emulated Cortex-M4, its plant simulated in lock step.
pub struct QemuTarget {
    board: EmulatedBoard,
}

impl QemuTarget {
    /// An emulated board that is its model exactly, put into service as a new board is: the parameters
    /// of the rig downloaded, the axis referenced where it stands.
    ///
    /// # Errors
    /// When the image cannot be built or run.
    pub fn start(rig: &Rig) -> Result<QemuTarget> {
        QemuTarget::commission(EmulatedBoard::start(rig, image()?, 0)?, rig)
    }

    /// The same in real time.
    ///
    /// # Errors
    /// When the image cannot be built or run.
    pub fn start_in_step(rig: &Rig) -> Result<QemuTarget> {
        QemuTarget::commission(EmulatedBoard::start_in_step(rig, image()?, 0)?, rig)
    }

    /// The same with another image.
    ///
    /// # Errors
    /// When the image cannot be run.
    pub fn start_image(rig: &Rig, image: &Path) -> Result<QemuTarget> {
        QemuTarget::commission(EmulatedBoard::start(rig, image, 0)?, rig)
    }

    /// The same in real time, at a port that the caller has chosen.
    ///
    /// # Errors
    /// When the image cannot be built or run.
    pub fn serve(rig: &Rig, listener: TcpListener) -> Result<QemuTarget> {
        QemuTarget::commission(EmulatedBoard::serve(rig, image()?, 0, listener)?, rig)
    }

    fn commission(board: EmulatedBoard, rig: &Rig) -> Result<QemuTarget> {
        let target = QemuTarget { board };
        commission(&target, rig)?;
        Ok(target)
    }

    /// The board.
    #[must_use]
    pub fn board(&self) -> &EmulatedBoard {
        &self.board
    }
}

impl Target for QemuTarget {
    fn name(&self) -> &str {
        "emulated board"
    }

    fn port(&self) -> &str {
        self.board.port()
    }

    fn cost(&self) -> Option<String> {
        Some(self.board.figures().to_string())
    }
}

impl Delayed for QemuTarget {
    fn delay_sample(&self, k: u64, late_us: u16) {
        self.board.late_sample().set(k, late_us);
    }
}

impl Supplied for QemuTarget {
    fn cut_power_at(&self, nth: u64) {
        self.board.flash().cut_power_at(nth);
    }

    fn damage_configuration(&self) {
        self.board.flash().damage_configuration();
    }

    fn power_up(&mut self) -> Result<()> {
        self.board.power_up()
    }
}

/// The image for the emulated board, built from the sources as they are.
///
/// # Errors
/// When it cannot be built.
pub fn image() -> Result<&'static Path> {
    static IMAGE: OnceLock<Result<PathBuf, String>> = OnceLock::new();
    let built = IMAGE
        .get_or_init(|| pneudrive_build::firmware::build_emulated().map_err(|error| format!("{error:#}")));
    built.as_deref().map_err(|error| anyhow!("{error}"))
}

/// The `pneudrive` program, built from the sources as they are, with the profile and in the folder of
/// the test that asks.
///
/// # Errors
/// When it cannot be built.
pub fn program() -> Result<PathBuf> {
    Ok(built(&["--test", "pages"])?.join("pneudrive"))
}

/// The program that runs the test bodies on a board, built as [`program`].
///
/// # Errors
/// When it cannot be built.
pub fn board_runner() -> Result<PathBuf> {
    Ok(built(&["--example", "board"])?.join("examples").join("board"))
}

/// The program that serves the emulated board at a port, built as [`program`].
///
/// # Errors
/// When it cannot be built.
pub fn board_server() -> Result<PathBuf> {
    Ok(built(&["--example", "serve"])?.join("examples").join("serve"))
}

/// Builds a program, by itself or as one that a test runs, and tells the folder of its profile.
fn built(what: &[&str]) -> Result<PathBuf> {
    let test = std::env::current_exe()?;
    let profile = test.ancestors().nth(2).context("a test lies in a folder of its profile")?;
    // With the features of all tests of the workspace: then it is there already.
    let mut arguments = vec!["build", "--quiet", "--workspace"];
    arguments.extend(what);
    if profile.ends_with("release") {
        arguments.push("--release");
    }
    let mut build = pneudrive_build::cargo::in_root(&arguments);
    pneudrive_build::cargo::run(build.env("CARGO_TARGET_DIR", profile.parent().unwrap_or(profile)))?;
    Ok(profile.to_owned())
}
