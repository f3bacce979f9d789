//! While a cylinder may move, Ctrl-C stops the rig, and so does an output that can no longer be written: a drive is not
//! left unattended.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, LazyLock, Once};

use anyhow::{Error, Result};
use pneudrive_protocol::Mode;

use crate::exit::Exit;
use crate::output;

/// While one exists, Ctrl-C or a signal to end sets a flag for the code that follows the drive. At other times it ends the
/// program.
pub(super) struct Interrupts;

/// Whether the drive is to stop, and whether Ctrl-C or a signal asked for it.
static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
static PRESSED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// Whether nothing follows a drive, so that the program may end at once.
static UNWATCHED: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// How many watch.
static WATCHES: AtomicUsize = AtomicUsize::new(0);

impl Interrupts {
    /// Watches from now on until this is dropped.
    pub fn watch() -> Interrupts {
        static INSTALLED: Once = Once::new();
        INSTALLED.call_once(|| {
            let handler = || {
                if UNWATCHED.load(Ordering::Relaxed) {
                    std::process::exit(Exit::Interrupted as i32);
                }
                PRESSED.store(true, Ordering::Relaxed);
                STOP.store(true, Ordering::Relaxed);
            };
            if ctrlc::set_handler(handler).is_err() {
                tell!("note: Ctrl-C will not stop the rig; use `pneudrive device stop`");
            }
            if let Err(error) = watch_signals() {
                tell!("note: a signal will not stop the rig ({error}); use `pneudrive device stop`");
            }
        });
        WATCHES.fetch_add(1, Ordering::Relaxed);
        UNWATCHED.store(false, Ordering::Relaxed);
        Interrupts
    }

    /// Whether the drive is to stop.
    pub fn seen(&self) -> &AtomicBool {
        &STOP
    }

    /// Whether the drive is to stop, also because the output can no longer be written. Call it repeatedly while the drive
    /// may move.
    pub fn look(&self) -> bool {
        if output::is_broken() {
            STOP.store(true, Ordering::Relaxed);
        }
        STOP.load(Ordering::Relaxed)
    }

    /// An error once the program was asked to end.
    pub fn refuse_if_seen(&self) -> Result<()> {
        match self.look() {
            false => Ok(()),
            true if Interrupts::by_output() => {
                Err(output::verdict().error(format!("nothing more was run because {UNHEARD}")))
            }
            true => Err(Exit::Interrupted.error("stopped by Ctrl-C")),
        }
    }

    /// Whether the drive is to stop because of the output and not because of Ctrl-C.
    fn by_output() -> bool {
        STOP.load(Ordering::Relaxed) && !PRESSED.load(Ordering::Relaxed)
    }

    /// Why the run was not started.
    pub fn not_begun(&self) -> Error {
        match Interrupts::by_output() {
            true => output::verdict().error(format!("the run was not started because {UNHEARD}")),
            false => Exit::Interrupted.error("stopped by Ctrl-C before the run was started"),
        }
    }

    /// The result of following a drive; if the program stopped the drive because of its output, the error says so.
    ///
    /// # Errors
    /// The error of `followed`, or that the output can no longer be written.
    pub fn explain(&self, followed: Result<Mode>) -> Result<()> {
        let ended = match followed {
            // The run ended before it could be stopped.
            Ok(Mode::Done) => return Ok(()),
            // A trip matters more.
            Err(error) if Exit::after(&error) != Exit::Interrupted => return Err(error),
            ended => ended.map(|_| ()),
        };
        match ended {
            Ok(()) if Interrupts::by_output() => Err(output::verdict()
                .error(format!("the run was ended and the drive disarmed because {UNHEARD}"))),
            Err(_) if Interrupts::by_output() => Err(output::verdict().error(format!(
                "the drive was stopped because {UNHEARD}; `pneudrive device arm` clears the fault"
            ))),
            ended => ended,
        }
    }
}

/// Makes SIGTERM and, unless it is ignored as under nohup, SIGHUP act like Ctrl-C.
#[cfg(unix)]
fn watch_signals() -> std::io::Result<()> {
    use signal_hook::consts::{SIGHUP, SIGTERM};
    use signal_hook::flag;
    for signal in [SIGTERM, SIGHUP].into_iter().filter(|&signal| !is_ignored(signal)) {
        flag::register_conditional_shutdown(signal, Exit::Interrupted as i32, Arc::clone(&UNWATCHED))?;
        flag::register(signal, Arc::clone(&PRESSED))?;
        flag::register(signal, Arc::clone(&STOP))?;
    }
    Ok(())
}

/// Whether the program was started with a signal ignored. Linux tells; elsewhere none counts as ignored.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

#[cfg(not(unix))]
fn watch_signals() -> std::io::Result<()> {
    Ok(())
}

const UNHEARD: &str = "the output of this program can no longer be written";

impl Drop for Interrupts {
    fn drop(&mut self) {
        if WATCHES.fetch_sub(1, Ordering::Relaxed) == 1 {
            UNWATCHED.store(true, Ordering::Relaxed);
        }
    }
}
