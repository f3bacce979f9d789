//! TIM5: a free-running counter of microseconds, with the sample on compare channel 1 and its output on channel 2.

use pneudrive_app::runtime::clock::{Mark, Timer};
use pneudrive_app::runtime::instants::prescaler;
use stm32f4xx_hal::pac::TIM5;
use stm32f4xx_hal::rcc::{BusTimerClock, Enable, Rcc, Reset};

/// The timer of the control.
pub struct ControlTimer(TIM5);

impl ControlTimer {
    /// Starts the counter at 0; both channels interrupt. None if the timer's clock can't be divided to microseconds.
    pub fn start(timer: TIM5, rcc: &mut Rcc) -> Option<ControlTimer> {
        TIM5::enable(rcc);
        TIM5::reset(rcc);
        let divider = prescaler(TIM5::timer_clock(&rcc.clocks).raw())?;
        timer.psc().write(|w| w.psc().set(divider));
        timer.arr().write(|w| w.arr().set(u32::MAX));
        // The prescaler is taken over with an update, which starts the counter at 0.
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        timer.dier().write(|w| w.cc1ie().set_bit().cc2ie().set_bit());
        Some(ControlTimer(timer))
    }
}

impl Timer for ControlTimer {
    #[inline]
    fn counter(&self) -> u32 {
        self.0.cnt().read().cnt().bits()
    }

    #[inline]
    fn instant(&self, mark: Mark) -> u32 {
        match mark {
            Mark::Sample => self.0.ccr1().read().ccr().bits(),
            Mark::Output => self.0.ccr2().read().ccr().bits(),
        }
    }

    #[inline]
    fn set_instant(&mut self, mark: Mark, instant: u32) {
        match mark {
            Mark::Sample => self.0.ccr1().write(|w| w.ccr().set(instant)),
            Mark::Output => self.0.ccr2().write(|w| w.ccr().set(instant)),
        };
    }

    #[inline]
    fn is_reached(&self, mark: Mark) -> bool {
        let state = self.0.sr().read();
        match mark {
            Mark::Sample => state.cc1if().bit_is_set(),
            Mark::Output => state.cc2if().bit_is_set(),
        }
    }

    /// A flag is cleared by writing 0; a 1 leaves the others as they are.
    #[inline]
    fn clear(&mut self, mark: Mark) {
        match mark {
            Mark::Sample => self.0.sr().write(|w| w.cc1if().clear_bit()),
            Mark::Output => self.0.sr().write(|w| w.cc2if().clear_bit()),
        };
    }
}
