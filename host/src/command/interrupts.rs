//! While a cylinder may move, the rig is stopped by Ctrl-C, and once nobody can read what the program says: a drive is
//! not left alone.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Error, Result};
use pneudrive_protocol::Mode;

use crate::exit::Exit;
use crate::output;

/// As long as there is one, Ctrl-C is noted for whoever follows the drive. At other times it ends the program.
pub(super) struct Interrupts;

/// Whether the drive is to stop, and whether Ctrl-C asked for it.
static STOP: AtomicBool = AtomicBool::new(false);
static PRESSED: AtomicBool = AtomicBool::new(false);
static WATCHED: AtomicBool = AtomicBool::new(false);

impl Interrupts {
    /// From now on until this is dropped.
    pub fn watch() -> Interrupts {
        static INSTALLED: Once = Once::new();
        INSTALLED.call_once(|| {
            let handler = || {
                if WATCHED.load(Ordering::Relaxed) {
                    PRESSED.store(true, Ordering::Relaxed);
                    STOP.store(true, Ordering::Relaxed);
                } else {
                    std::process::exit(Exit::Interrupted as i32);
                }
            };
            if ctrlc::set_handler(handler).is_err() {
                tell!("note: Ctrl-C will not stop the rig; use `pneudrive device stop`");
            }
        });
        WATCHED.store(true, Ordering::Relaxed);
        Interrupts
    }

    /// Whether the drive is to stop.
    pub fn seen(&self) -> &AtomicBool {
        &STOP
    }

    /// Looks whether the drive is to stop because nobody reads what the program says. Call it again and again while
    /// the drive may move.
    pub fn look(&self) -> bool {
        if output::is_broken() {
            STOP.store(true, Ordering::Relaxed);
        }
        STOP.load(Ordering::Relaxed)
    }

    /// Whether it is not Ctrl-C that the drive is to stop for.
    fn by_output() -> bool {
        STOP.load(Ordering::Relaxed) && !PRESSED.load(Ordering::Relaxed)
    }

    /// Why a drive is not moved that was to be.
    pub fn not_begun(&self) -> Error {
        match Interrupts::by_output() {
            true => output::verdict().error(format!("the run was not begun, as {UNHEARD}")),
            false => Exit::Interrupted.error("stopped before the start, as you asked"),
        }
    }

    /// What came of a drive that was followed, with how it is then: one that the program's own output has stopped says
    /// so.
    ///
    /// # Errors
    /// As `followed`, or that the output broke.
    pub fn explain(&self, followed: Result<Mode>) -> Result<()> {
        let ended = match followed {
            // It came to its end before it could be stopped.
            Ok(Mode::Done) => return Ok(()),
            // A trip is worse news.
            Err(error) if Exit::after(&error) != Exit::Interrupted => return Err(error),
            ended => ended.map(|_| ()),
        };
        match ended {
            Ok(()) if Interrupts::by_output() => {
                Err(output::verdict()
                    .error(format!("the run was ended and the drive disarmed, as {UNHEARD}")))
            }
            Err(_) if Interrupts::by_output() => Err(output::verdict().error(format!(
                "the drive was stopped, as {UNHEARD}; `pneudrive device arm` leaves the fault"
            ))),
            ended => ended,
        }
    }
}

const UNHEARD: &str = "what this program says cannot be written any more";

impl Drop for Interrupts {
    fn drop(&mut self) {
        WATCHED.store(false, Ordering::Relaxed);
    }
}
