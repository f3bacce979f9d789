//! TIMER0: a free-running counter of microseconds, with the sample on alarm 0 and its output on alarm 1.

use embedded_hal::delay::DelayNs;
use pneudrive_app::runtime::clock::{Mark, Timer};
use rp235x_hal::pac::timer0::RegisterBlock;
use rp235x_hal::pac::{RESETS, TIMER0};

/// The timer of the control.
pub struct ControlTimer(TIMER0);

impl ControlTimer {
    /// Starts the counter at 0; both alarms interrupt.
    pub fn start(timer: TIMER0, resets: &RESETS) -> ControlTimer {
        resets.reset().modify(|_, w| w.timer0().set_bit());
        resets.reset().modify(|_, w| w.timer0().clear_bit());
        while resets.reset_done().read().timer0().bit_is_clear() {}
        // The counter goes on while a debugger has halted the processor: a valve that is open then would stay open.
        timer.dbgpause().write(|w| w.dbg0().clear_bit().dbg1().clear_bit());
        timer.inte().write(|w| w.alarm_0().set_bit().alarm_1().set_bit());
        ControlTimer(timer)
    }
}

impl Timer for ControlTimer {
    #[inline]
    fn counter(&self) -> u32 {
        self.0.timerawl().read().bits()
    }

    #[inline]
    fn instant(&self, mark: Mark) -> u32 {
        match mark {
            Mark::Sample => self.0.alarm0().read().bits(),
            Mark::Output => self.0.alarm1().read().bits(),
        }
    }

    /// Writing the instant arms the alarm.
    #[inline]
    fn set_instant(&mut self, mark: Mark, instant: u32) {
        match mark {
            // SAFETY: any 32 bits are an instant.
            Mark::Sample => self.0.alarm0().write(|w| unsafe { w.bits(instant) }),
            // SAFETY: as above.
            Mark::Output => self.0.alarm1().write(|w| unsafe { w.bits(instant) }),
        };
    }

    #[inline]
    fn is_reached(&self, mark: Mark) -> bool {
        let reached = self.0.intr().read();
        match mark {
            Mark::Sample => reached.alarm_0().bit_is_set(),
            Mark::Output => reached.alarm_1().bit_is_set(),
        }
    }

    /// A flag is cleared by writing 1.
    #[inline]
    fn clear(&mut self, mark: Mark) {
        match mark {
            Mark::Sample => self.0.intr().write(|w| w.alarm_0().clear_bit_by_one()),
            Mark::Output => self.0.intr().write(|w| w.alarm_1().clear_bit_by_one()),
        };
    }
}

/// Waits by the counter, which [`ControlTimer`] has started.
pub struct Wait;

impl Wait {
    fn counter() -> u32 {
        // SAFETY: the counter is read and nothing else, and reading changes nothing.
        let timer: &RegisterBlock = unsafe { &*TIMER0::ptr() };
        timer.timerawl().read().bits()
    }
}

impl DelayNs for Wait {
    #[inline]
    fn delay_ns(&mut self, ns: u32) {
        let (begun, us) = (Wait::counter(), ns.div_ceil(1000));
        // One more: the present microsecond has begun already.
        while Wait::counter().wrapping_sub(begun) <= us {}
    }
}
