//! The start of a virtual rig's board, and its watchdog.

use std::time::{Duration, Instant};

use anyhow::{Result, anyhow};
use pneudrive_app::fault_log::{MEMORY_BYTES, Memory};
use pneudrive_app::ram_flash::RamFlash;
use pneudrive_app::store::FlashStore;
use pneudrive_app::{Board, Control, Server};
use pneudrive_controller::{Fault, Mode};

use super::caller::Caller;
use super::{VirtualBoard, VirtualRig};
use crate::persistent_flash::PersistentFlash;
use crate::wiring::WiringFault;

/// A watchdog that is not fed for this long resets the board, as on the Pico 2.
const TIMEOUT: Duration = Duration::from_millis(300);

/// The data that a board keeps.
type Kept = FlashStore<PersistentFlash, Box<Memory>>;

/// The watchdog, by the clock of the computer. A program that stalls stops it, too.
#[derive(Debug, Default)]
pub(super) struct Watchdog {
    /// Since when it has not been fed.
    hungry_since: Option<Instant>,
}

impl Watchdog {
    /// Whether it resets a board that feeds it, or does not.
    fn bites(&mut self, fed: bool) -> bool {
        if fed {
            self.hungry_since = None;
            return false;
        }
        self.hungry_since.get_or_insert_with(Instant::now).elapsed() >= TIMEOUT
    }
}

/// The store in this flash, with memory that has lost its power.
pub(super) fn without_power(flash: PersistentFlash) -> Kept {
    taken_up(flash, Box::new([0; MEMORY_BYTES]))
}

fn taken_up(flash: PersistentFlash, memory: Box<Memory>) -> Kept {
    let kept = FlashStore::take_up(flash, RamFlash::layout(), memory);
    kept.expect("the layout is that of this flash").0
}

/// The control of a board that starts with the true parameters of its rig, or those that it has stored; after a reset with
/// the fault that it was reset by.
///
/// # Errors
/// When the parameters do not go together.
pub(super) fn booted(board: &mut VirtualBoard, fault: Option<Fault>) -> Result<Box<Control>> {
    let mut control = Box::<Control>::default();
    control.load_parameters(board.rig.parameters()).map_err(|error| anyhow!("{}", error.advice()))?;
    if board.starts_referenced() {
        control.set_referenced().map_err(|_| anyhow!("a new rig is enabled"))?;
    }
    if let Some(fault) = fault {
        control.trip(fault);
    }
    control.take_up(board);
    Ok(control)
}

impl VirtualBoard {
    /// Begins again with the data that a reset leaves: the flash and the memory of the fault log. The plant stays
    /// where it is.
    fn reset(&mut self) {
        let nothing = without_power(PersistentFlash::default());
        let (flash, memory) = std::mem::replace(&mut self.store, nothing).into_parts();
        self.store = taken_up(flash, memory);
        self.mode = Mode::Disarmed;
        (self.time_us, self.since_sample_us, self.k) = (0, 0, 0);
        self.since = Instant::now();
        self.signals.restart();
    }
}

impl VirtualRig {
    /// Resets the board once its watchdog has not been fed for too long. The programs at its port stay connected, as at a
    /// serial port.
    pub(super) fn obey_watchdog(&mut self, callers: &mut [Caller]) -> Result<()> {
        let bites = self.watchdog.bites(self.control.feeds_watchdog());
        if !bites || self.wiring().has(WiringFault::WatchdogDead) {
            return Ok(());
        }
        self.watchdog = Watchdog::default();
        self.board.reset();
        self.control = booted(&mut self.board, Some(Fault::Watchdog))?;
        for caller in callers {
            caller.server = Server::default();
        }
        Ok(())
    }
}
