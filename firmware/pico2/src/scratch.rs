//! The watchdog's registers, and those of them that are memory: every reset but that of the power leaves it as it is (RP2350
//! data sheet, 12.9).
//!
//! | register | holds |
//! |---|---|
//! | SCRATCH0 | the note of a breakdown |
//! | SCRATCH1, SCRATCH2 | where a stepper's spool is |
//! | SCRATCH4 to SCRATCH7 | the boot ROM's |

use pneudrive_app::runtime::spool::SpoolMemory;
use rp235x_hal::pac::WATCHDOG;
use rp235x_hal::pac::watchdog::RegisterBlock;

/// The registers.
pub fn registers() -> &'static RegisterBlock {
    // SAFETY: the watchdog and its scratch registers are reached through this function alone; each is read and written whole.
    unsafe { &*WATCHDOG::ptr() }
}

/// Resets the board at once.
pub fn reset() -> ! {
    registers().ctrl().modify(|_, w| w.trigger().set_bit());
    loop {
        cortex_m::asm::nop();
    }
}

/// Whether the watchdog has made the last reset: because it was not fed, or because the program asked for it.
pub fn reason() -> (bool, bool) {
    let reason = registers().reason().read();
    (reason.timer().bit_is_set(), reason.force().bit_is_set())
}

/// The note of a breakdown.
pub fn note() -> u32 {
    registers().scratch0().read().bits()
}

/// Leaves a note.
pub fn leave_note(note: u32) {
    // SAFETY: any 32 bits.
    registers().scratch0().write(|w| unsafe { w.bits(note) });
}

/// The memory for a stepper's spool. There is one, and the board has it.
pub struct KeptSpool;

impl SpoolMemory for KeptSpool {
    #[inline]
    fn keep(&mut self, [word, check]: [u32; 2]) {
        // SAFETY: any 32 bits.
        registers().scratch1().write(|w| unsafe { w.bits(word) });
        // SAFETY: any 32 bits.
        registers().scratch2().write(|w| unsafe { w.bits(check) });
    }

    fn kept(&self) -> [u32; 2] {
        [registers().scratch1().read().bits(), registers().scratch2().read().bits()]
    }
}
