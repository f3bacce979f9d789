//! Ctrl-C while a cylinder may move: the rig is stopped, not left alone.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// As long as there is one, Ctrl-C is noted for whoever follows the drive. At other times it ends the program.
pub(super) struct Interrupts;

static SEEN: AtomicBool = AtomicBool::new(false);
static WATCHED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that Ctrl-C has ended.
const INTERRUPTED: i32 = 130;

impl Interrupts {
    /// From now on until this is dropped.
    pub fn watch() -> Interrupts {
        static INSTALLED: Once = Once::new();
        INSTALLED.call_once(|| {
            let handler = || {
                if WATCHED.load(Ordering::Relaxed) {
                    SEEN.store(true, Ordering::Relaxed);
                } else {
                    std::process::exit(INTERRUPTED);
                }
            };
            if ctrlc::set_handler(handler).is_err() {
                eprintln!("note: Ctrl-C will not stop the rig; use `pneudrive device stop`");
            }
        });
        WATCHED.store(true, Ordering::Relaxed);
        Interrupts
    }

    /// Whether Ctrl-C was pressed.
    pub fn seen(&self) -> &AtomicBool {
        &SEEN
    }
}

impl Drop for Interrupts {
    fn drop(&mut self) {
        WATCHED.store(false, Ordering::Relaxed);
    }
}
