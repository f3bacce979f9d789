//! TIM5: a free-running counter of microseconds, with the sample on compare channel 1 and its output
//! on channel 2. The arithmetic is in [`pneudrive_nucleo_plan::time`].

use pneudrive_controller::config::Timing;
use pneudrive_nucleo_plan::time::{Milliseconds, extend, left, next_on_grid, output_after, prescaler};
use stm32f4xx_hal::pac::TIM5;
use stm32f4xx_hal::rcc::{BusTimerClock, Enable, Rcc, Reset};

/// What the compare channels are at until they are set: a configuration's shortest period.
const SOON_US: u32 = 100;

/// The clock of the control.
pub struct Clock {
    timer: TIM5,
    timing: Timing,
    /// Microseconds since the reset, at the last event.
    base_us: u64,
    base_ms: Milliseconds,
}

impl Clock {
    /// Starts the counter; the first sample is a period from now. None if the timer's clock can't be
    /// divided to microseconds.
    pub fn start(timer: TIM5, timing: Timing, rcc: &mut Rcc) -> Option<Clock> {
        TIM5::enable(rcc);
        TIM5::reset(rcc);
        let divider = prescaler(TIM5::timer_clock(&rcc.clocks).raw())?;
        timer.psc().write(|w| w.psc().set(divider));
        timer.arr().write(|w| w.arr().set(u32::MAX));
        // The prescaler is taken over with an update, which starts the counter at 0.
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
        let mut clock = Clock { timer, timing, base_us: 0, base_ms: Milliseconds::default() };
        clock.restart();
        clock.timer.dier().write(|w| w.cc1ie().set_bit().cc2ie().set_bit());
        Some(clock)
    }

    fn counter(&self) -> u32 {
        self.timer.cnt().read().cnt().bits()
    }

    /// Sets both channels anew: the next sample is a period from now, and its output follows.
    fn restart(&mut self) {
        let sample = self.counter().wrapping_add(self.timing.period_us.get().max(SOON_US));
        self.timer.ccr1().write(|w| w.ccr().set(sample));
        self.timer.ccr2().write(|w| w.ccr().set(sample.wrapping_add(self.timing.delay_us.get())));
        self.timer.sr().write(|w| w.cc1if().clear_bit().cc2if().clear_bit());
    }

    /// Takes over the timing of a configuration, if it is another one. For a disabled drive: the grid
    /// begins anew.
    pub fn keep(&mut self, timing: Timing) {
        if timing != self.timing {
            self.timing = timing;
            self.restart();
        }
    }

    /// Whether a sample has become due since the last call; sets the next one.
    pub fn sample_is_due(&mut self) -> bool {
        if self.timer.sr().read().cc1if().bit_is_clear() {
            return false;
        }
        self.timer.sr().write(|w| w.cc1if().clear_bit());
        let now = self.counter();
        self.base_ms = self.base_ms.after(now.wrapping_sub(self.base_us as u32));
        self.base_us = extend(self.base_us, now);
        let due = self.timer.ccr1().read().ccr().bits();
        let next = next_on_grid(due, self.timing.period_us, now);
        self.timer.ccr1().write(|w| w.ccr().set(next));
        true
    }

    /// Whether an output has become due since the last call; sets the next one, of the sample that
    /// channel 1 waits for.
    pub fn output_is_due(&mut self) -> bool {
        if self.timer.sr().read().cc2if().bit_is_clear() {
            return false;
        }
        self.timer.sr().write(|w| w.cc2if().clear_bit());
        let sample = self.timer.ccr1().read().ccr().bits();
        let next = output_after(sample, self.timing.delay_us, self.timing.period_us, self.counter());
        self.timer.ccr2().write(|w| w.ccr().set(next));
        true
    }

    /// Microseconds since the reset.
    pub fn now_us(&self) -> u64 {
        extend(self.base_us, self.counter())
    }

    /// Microseconds until the next sample or output.
    pub fn left_us(&self) -> u32 {
        let [sample, output] = [self.timer.ccr1().read(), self.timer.ccr2().read()];
        left(self.counter(), [sample.ccr().bits(), output.ccr().bits()])
    }

    /// Milliseconds since the reset, at the last sample.
    pub fn sampled_ms(&self) -> u64 {
        self.base_ms.whole()
    }
}
