//! The SysTick: a counter of the control's ticks, and the alarm that ends a rest.
//!
//! In the emulator ticks are a measure of instructions: virtual time goes on by the same amount with
//! each.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use pneudrive_app::lock_step::Stopwatch;

/// Ticks of the SysTick a microsecond: the processor's 25 MHz.
const TICKS_PER_US: u32 = 25;

/// The largest value of the counter, which counts down.
const MAX: u32 = 0x00ff_ffff;

/// The counter.
pub struct Clock(SYST);

impl Clock {
    /// Starts the counter.
    pub fn start(mut syst: SYST) -> Clock {
        syst.set_clock_source(SystClkSource::Core);
        syst.enable_interrupt();
        let mut clock = Clock(syst);
        clock.count_from(MAX);
        clock.0.enable_counter();
        clock
    }

    fn count_from(&mut self, ticks: u32) {
        self.0.set_reload(ticks);
        self.0.clear_current();
        SCB::clear_pendst();
    }

    /// Waits for this time or for a byte on the port.
    pub fn rest(&mut self, microseconds: u32) {
        self.count_from(microseconds.saturating_mul(TICKS_PER_US).min(MAX));
        cortex_m::asm::wfi();
        self.count_from(MAX);
    }
}

impl Stopwatch for Clock {
    /// No work is moved across the reading.
    fn now(&self) -> u32 {
        compiler_fence(Ordering::SeqCst);
        let now = SYST::get_current();
        compiler_fence(Ordering::SeqCst);
        now
    }

    fn since(&self, reading: u32) -> u32 {
        reading.wrapping_sub(self.now()) & MAX
    }
}
