//! The watchdog, which counts by the ring oscillator, whatever becomes of the crystal (RP2350 data sheet, 12.9).
//!
//! Whoever feeds it compares the two clocks ([`pneudrive_plan::pico2::clocks`]). If they disagree, no period is right any
//! more: the drive is disabled, noted, reset.

use core::sync::atomic::{AtomicU32, Ordering};

use pneudrive_app::runtime::talk;
use pneudrive_plan::pico2::clocks::{LOOK_US, RUNNING_US, WRITING_FLASH_US, agree};
use rp235x_hal::pac::{PSM, WATCHDOG};

use crate::clock::{HALTS, now_us};
use crate::reset;
use crate::scratch::registers;

/// 32 us of the processor, dozens of cycles of the slowest ring oscillator.
const SETTLING_CYCLES: u32 = 4096;

/// When it was loaded last, by the timer.
static LOADED_AT_US: AtomicU32 = AtomicU32::new(0);

/// What is reset: everything but the two oscillators.
const RESET_ALL: u32 = 0x01ff_fff3;

/// The watchdog: the idle task feeds it, and the flash asks it for time. Both belong to the idle task.
#[derive(Clone, Copy)]
pub struct Watchdog(());

impl Watchdog {
    /// Gets it ready; it does not run yet. It goes on while a debugger has halted the processor: a valve that is open
    /// then would stay open. With the feature `debug` it stands.
    pub fn new(_: &WATCHDOG, power: &PSM) -> Watchdog {
        registers().ctrl().write(|w| {
            w.pause_dbg0().bit(HALTS).pause_dbg1().bit(HALTS).pause_jtag().bit(HALTS).enable().clear_bit()
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
    /// A watchdog that was fed a moment ago is left alone: the clocks are compared over a time that shows them.
    fn feed(&mut self) {
        if counted_us() < LOOK_US {
            return;
        }
        // Looked at twice: the counter of the other clock may not show yet what it was loaded with.
        if clocks_disagree() {
            cortex_m::asm::delay(SETTLING_CYCLES);
            if clocks_disagree() {
                reset::clock_failed();
            }
        }
        load(RUNNING_US);
    }
}

/// What the watchdog has counted since it was loaded while the drive may move.
fn counted_us() -> u32 {
    RUNNING_US.saturating_sub(registers().ctrl().read().time().bits())
}

fn clocks_disagree() -> bool {
    let passed_us = now_us().wrapping_sub(LOADED_AT_US.load(Ordering::Relaxed));
    let counted_us = counted_us();
    counted_us >= LOOK_US && !agree(counted_us, passed_us)
}

fn load(us: u32) {
    LOADED_AT_US.store(now_us(), Ordering::Relaxed);
    // SAFETY: 24 bits, and both times have fewer.
    registers().load().write(|w| unsafe { w.bits(us) });
}
