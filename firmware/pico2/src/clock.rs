//! TIMER0: a free-running counter of the processor's cycles, read as microseconds, with the sample on alarm 0 and its
//! output on alarm 1. The processor's clock is the crystal's; the ticks that the timer could count instead come from the
//! watchdog's clock ([`pneudrive_plan::pico2::clocks`]).

use embedded_hal::delay::DelayNs;
use pneudrive_app::runtime::clock::{Mark, Timer};
use pneudrive_plan::pico2::clocks::{cycles, microseconds, wait_cycles};
use rp235x_hal::pac::timer0::RegisterBlock;
use rp235x_hal::pac::{RESETS, TIMER0};

/// Whether watchdog and timer stand while a debugger has halted the processor.
pub const HALTS: bool = cfg!(feature = "debug");

/// The registers, to be read.
fn registers() -> &'static RegisterBlock {
    // SAFETY: outside of `ControlTimer`, the counter is read and nothing else, and reading changes nothing.
    unsafe { &*TIMER0::ptr() }
}

/// The counter, microseconds.
#[inline]
pub fn now_us() -> u32 {
    let timer = registers();
    loop {
        let high = timer.timerawh().read().bits();
        let low = timer.timerawl().read().bits();
        if timer.timerawh().read().bits() == high {
            return microseconds(high, low);
        }
    }
}

/// The timer of the control.
pub struct ControlTimer {
    timer: TIMER0,
    /// What the alarms are set to, microseconds.
    instants: [u32; 2],
}

impl ControlTimer {
    /// Starts the counter at 0; both alarms interrupt.
    pub fn start(timer: TIMER0, resets: &RESETS) -> ControlTimer {
        resets.reset().modify(|_, w| w.timer0().set_bit());
        resets.reset().modify(|_, w| w.timer0().clear_bit());
        while resets.reset_done().read().timer0().bit_is_clear() {}
        timer.source().write(|w| w.clk_sys().clk_sys());
        // The counter goes on while a debugger has halted the processor, but with the feature `debug`.
        timer.dbgpause().write(|w| w.dbg0().bit(HALTS).dbg1().bit(HALTS));
        timer.inte().write(|w| w.alarm_0().set_bit().alarm_1().set_bit());
        ControlTimer { timer, instants: [0; 2] }
    }
}

impl Timer for ControlTimer {
    #[inline]
    fn counter(&self) -> u32 {
        now_us()
    }

    #[inline]
    fn instant(&self, mark: Mark) -> u32 {
        let [sample, output] = self.instants;
        match mark {
            Mark::Sample => sample,
            Mark::Output => output,
        }
    }

    /// Writing the instant arms the alarm.
    #[inline]
    fn set_instant(&mut self, mark: Mark, instant: u32) {
        let [sample, output] = &mut self.instants;
        match mark {
            Mark::Sample => {
                *sample = instant;
                // SAFETY: any 32 bits are a count.
                self.timer.alarm0().write(|w| unsafe { w.bits(cycles(instant)) });
            }
            Mark::Output => {
                *output = instant;
                // SAFETY: as above.
                self.timer.alarm1().write(|w| unsafe { w.bits(cycles(instant)) });
            }
        }
    }

    #[inline]
    fn is_reached(&self, mark: Mark) -> bool {
        let reached = self.timer.intr().read();
        match mark {
            Mark::Sample => reached.alarm_0().bit_is_set(),
            Mark::Output => reached.alarm_1().bit_is_set(),
        }
    }

    /// A flag is cleared by writing 1.
    #[inline]
    fn clear(&mut self, mark: Mark) {
        match mark {
            Mark::Sample => self.timer.intr().write(|w| w.alarm_0().clear_bit_by_one()),
            Mark::Output => self.timer.intr().write(|w| w.alarm_1().clear_bit_by_one()),
        };
    }
}

/// Waits by the counter, which [`ControlTimer`] has started.
pub struct Wait;

impl Wait {
    fn counter() -> u32 {
        registers().timerawl().read().bits()
    }
}

impl DelayNs for Wait {
    /// To the cycle of 7.8 ns.
    #[inline]
    fn delay_ns(&mut self, ns: u32) {
        let (begun, long) = (Wait::counter(), wait_cycles(ns));
        while Wait::counter().wrapping_sub(begun) < long {}
    }
}
