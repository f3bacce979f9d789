//! The watchdog, a CMSDK APB watchdog on the processor's clock. Its first time-out interrupts, which leaves
//! a note; the second one resets the board. In the emulator its time is that of instructions: a processor
//! that stands still for the plant is not late.

use pneudrive_controller::Fault;

use crate::hardware::{BITTEN, WatchdogRegisters, take_note};

/// A time-out, clocks of 25 MHz: four seconds. While the board rests, virtual time follows the computer's,
/// which may be busy with something else.
const TIMEOUT: u32 = 100_000_000;

/// The watchdog. Nothing stops it once it has started.
pub struct Watchdog(WatchdogRegisters);

impl Watchdog {
    /// From now on it must be fed.
    pub fn start(mut registers: WatchdogRegisters) -> Watchdog {
        registers.start(TIMEOUT);
        Watchdog(registers)
    }

    /// Control and server have run.
    pub fn feed(&mut self) {
        self.0.reload();
    }
}

/// The fault that the board was reset by, if there was one. Once after a reset: the next one finds none of
/// this.
pub fn fault_before_reset() -> Option<Fault> {
    (take_note() == BITTEN).then_some(Fault::Watchdog)
}
