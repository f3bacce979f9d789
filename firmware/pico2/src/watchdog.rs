//! The watchdog, which counts microseconds of the crystal, and its scratch registers: memory that every reset but that of
//! the power leaves as it is (RP2350 data sheet, 12.9).
//!
//! | register | holds |
//! |---|---|
//! | SCRATCH0 | the note of a breakdown |
//! | SCRATCH1, SCRATCH2 | where a stepper's spool is |
//! | SCRATCH4 to SCRATCH7 | the boot ROM's |

use pneudrive_app::runtime::spool::SpoolMemory;
use pneudrive_app::runtime::talk;
use rp235x_hal::pac::watchdog::RegisterBlock;
use rp235x_hal::pac::{PSM, WATCHDOG};

/// While the drive may move, microseconds: above the longest period of 100 ms.
const RUNNING_US: u32 = 300_000;

/// While a sector is erased or pages are written, microseconds: 4 KiB take 400 ms at most.
const WRITING_FLASH_US: u32 = 2_000_000;

/// What is reset: everything but the two oscillators.
const RESET_ALL: u32 = 0x01ff_fff3;

/// The registers.
fn registers() -> &'static RegisterBlock {
    // SAFETY: the watchdog and its scratch registers are reached through this module alone; each is read and written whole.
    unsafe { &*WATCHDOG::ptr() }
}

/// The watchdog: the idle task feeds it, and the flash asks it for time. Both belong to the idle task.
#[derive(Clone, Copy)]
pub struct Watchdog(());

impl Watchdog {
    /// Gets it ready; it does not run yet. It goes on while a debugger has halted the processor: a valve that is open
    /// then would stay open.
    pub fn new(_: &WATCHDOG, power: &PSM) -> Watchdog {
        registers().ctrl().write(|w| {
            w.pause_dbg0().clear_bit().pause_dbg1().clear_bit().pause_jtag().clear_bit().enable().clear_bit()
        });
        // SAFETY: any set of parts may be reset.
        power.wdsel().write(|w| unsafe { w.bits(RESET_ALL) });
        Watchdog(())
    }

    /// From now on it must be fed.
    pub fn start(&mut self) {
        load(RUNNING_US);
        registers().ctrl().modify(|_, w| w.enable().set_bit());
    }

    /// Gives the work the time that writing flash takes. For a disabled drive.
    pub fn while_writing<T>(&mut self, work: impl FnOnce() -> T) -> T {
        load(WRITING_FLASH_US);
        let result = work();
        load(RUNNING_US);
        result
    }
}

impl talk::Watchdog for Watchdog {
    fn feed(&mut self) {
        load(RUNNING_US);
    }
}

fn load(us: u32) {
    // SAFETY: 24 bits, and both times have fewer.
    registers().load().write(|w| unsafe { w.bits(us) });
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
