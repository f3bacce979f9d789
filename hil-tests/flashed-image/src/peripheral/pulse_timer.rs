//! TIM4, which gives the step pulse. RM0390 section 17.3.10: one-pulse mode, channel 1 in PWM mode 2.
//!
//! ```text
//! the output is high from CCR1 counts after CEN is set until the counter has passed ARR; then the counter stops
//! ```

use crate::register::{Words, Write};
use crate::time::Ticks;

const CR1: u32 = 0x00;
const EGR: u32 = 0x14;
const CCMR1: u32 = 0x18;
const CCER: u32 = 0x20;
const PSC: u32 = 0x28;
const ARR: u32 = 0x2c;
const CCR1: u32 = 0x34;
const ONE_PULSE: u32 = 3;
const PWM_MODE_2: u32 = 7;

/// A pulse: when the output rises and falls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pulse {
    /// It rises.
    pub rises: Ticks,
    /// It falls, and the timer stops.
    pub falls: Ticks,
}

/// The peripheral.
pub struct PulseTimer {
    words: Words<32>,
    clock: Ticks,
    prescaler: u32,
    stops: Ticks,
}

impl PulseTimer {
    /// After a reset.
    #[must_use]
    pub fn new(clock: Ticks) -> PulseTimer {
        PulseTimer { words: Words::after_reset(&[(ARR, 0xffff)]), clock, prescaler: 0, stops: 0 }
    }

    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32, now: Ticks) -> u32 {
        let value = self.words.get(offset);
        if offset == CR1 { value | u32::from(now < self.stops) } else { value }
    }

    /// Writes a register; the pulse that this starts.
    pub fn write(&mut self, write: Write, now: Ticks) -> Option<Pulse> {
        let value = self.words.keep(write);
        match write.offset {
            EGR if value & 1 == 1 => self.prescaler = self.words.get(PSC),
            CR1 if value & 1 == 1 => {
                self.words.put(CR1, 0, false);
                return (now >= self.stops).then(|| self.start(now)).flatten();
            }
            _ => {}
        }
        None
    }

    fn start(&mut self, now: Ticks) -> Option<Pulse> {
        let drives = self.words.bit(CR1, ONE_PULSE)
            && self.words.field(CCMR1, 4, 3) == PWM_MODE_2
            && self.words.bit(CCER, 0);
        let after = |counts: u32| now + Ticks::from(counts) * self.clock * (Ticks::from(self.prescaler) + 1);
        let pulse = Pulse { rises: after(self.words.get(CCR1)), falls: after(self.words.get(ARR) + 1) };
        self.stops = pulse.falls;
        drives.then_some(pulse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::MICROSECOND;

    #[test]
    fn a_pulse_comes_after_the_compare_value_and_lasts_to_the_reload_value() {
        let mut timer = PulseTimer::new(8);
        let set = [(PSC, 89), (EGR, 1), (CCMR1, 7 << 4), (CCER, 1), (CCR1, 10), (ARR, 19)];
        set.into_iter()
            .for_each(|(offset, value)| assert_eq!(timer.write(Write::of(offset, 4, value), 0), None));
        let pulse = Pulse { rises: 10 * MICROSECOND, falls: 20 * MICROSECOND };
        assert_eq!(timer.write(Write::of(CR1, 4, 1 << ONE_PULSE | 1), 0), Some(pulse));
        assert_eq!(timer.read(CR1, 19 * MICROSECOND) & 1, 1);
        assert_eq!(timer.read(CR1, 20 * MICROSECOND) & 1, 0);
    }
}
