//! TIM5, the clock of the control: a free-running counter with compare channels. RM0390 section 17.4.
//!
//! ```text
//! counts a second = timer clock / (PSC + 1)     PSC is taken over with an update (UG), which starts the counter at 0
//! CCxIF           = 1 when the counter reaches CCRx; zeros written to SR clear it
//! interrupt       = SR and DIER
//! ```

use crate::register::{Words, Write};
use crate::time::Ticks;

const CR1: u32 = 0x00;
const DIER: u32 = 0x0c;
const SR: u32 = 0x10;
const EGR: u32 = 0x14;
const CNT: u32 = 0x24;
const PSC: u32 = 0x28;
const CCR1: u32 = 0x34;

/// The flags of channels 1 and 2.
const CHANNELS: u32 = 6;

/// The counts at which channels 1 and 2 have matched, since the counter was started: 64 bits, so that they do not wrap.
pub type Matches = [Option<u64>; 2];

/// The peripheral.
pub struct ControlTimer {
    words: Words<32>,
    /// Ticks of the timer's clock.
    clock: Ticks,
    prescaler: u32,
    /// The counter at `since`.
    base: u64,
    since: Ticks,
    /// Matches were looked for up to here.
    settled: u64,
    frozen: bool,
}

impl ControlTimer {
    /// After a reset.
    #[must_use]
    pub fn new(clock: Ticks, now: Ticks) -> ControlTimer {
        let words = Words::after_reset(&[(0x2c, u32::MAX)]);
        ControlTimer { words, clock, prescaler: 0, base: 0, since: now, settled: 0, frozen: false }
    }

    /// The timer's clock is another one from now on.
    pub fn set_clock(&mut self, clock: Ticks, now: Ticks) {
        (self.base, self.since, self.clock) = (self.count(now), now, clock);
    }

    /// A debugger stops the counter, or lets it go on.
    pub fn freeze(&mut self, frozen: bool, now: Ticks) {
        (self.base, self.since, self.frozen) = (self.count(now), now, frozen);
    }

    /// A register.
    #[must_use]
    pub fn read(&self, offset: u32, now: Ticks) -> u32 {
        if offset == CNT { self.count(now) as u32 } else { self.words.get(offset) }
    }

    /// Writes a register, after [`ControlTimer::settle`].
    pub fn write(&mut self, write: Write, now: Ticks) {
        match write.offset {
            SR => self.words.set(SR, self.words.get(SR) & (write.value | !write.mask)),
            EGR if write.value & 1 == 1 => {
                (self.prescaler, self.base, self.since) = (self.words.get(PSC), 0, now);
                self.settled = 0;
            }
            EGR => {}
            CR1 => {
                (self.base, self.since) = (self.count(now), now);
                self.words.keep(write);
            }
            _ => {
                self.words.keep(write);
            }
        }
    }

    /// Sets the flags of what has matched up to now; when.
    pub fn settle(&mut self, now: Ticks) -> Matches {
        let (count, from) = (self.count(now), self.settled);
        self.settled = count;
        [0, 1].map(|channel| {
            let matched = from + self.distance(channel, from);
            (matched <= count).then(|| {
                self.words.put(SR, channel + 1, true);
                matched
            })
        })
    }

    /// Whether the interrupt is asked for.
    #[must_use]
    pub fn interrupts(&self) -> bool {
        self.words.get(SR) & self.words.get(DIER) & CHANNELS != 0
    }

    /// When a channel that interrupts matches next; None while the counter stands.
    #[must_use]
    pub fn next_match(&self) -> Option<Ticks> {
        let enabled = (0..2).filter(|channel| self.words.bit(DIER, channel + 1));
        let next = enabled.map(|channel| self.settled + self.distance(channel, self.settled)).min()?;
        self.runs().then(|| self.since + (next - self.base) * self.count_ticks())
    }

    /// When a count was reached, or will be.
    #[must_use]
    pub fn ticks_of(&self, count: u64) -> Ticks {
        self.since.saturating_add_signed((count as i64 - self.base as i64) * self.count_ticks() as i64)
    }

    /// Counts from one on to where a channel matches.
    fn distance(&self, channel: u32, from: u64) -> u64 {
        match self.words.get(CCR1 + 4 * channel).wrapping_sub(from as u32) {
            0 => 1 << 32,
            distance => u64::from(distance),
        }
    }

    fn runs(&self) -> bool {
        self.words.bit(CR1, 0) && !self.frozen
    }

    fn count_ticks(&self) -> Ticks {
        self.clock * (Ticks::from(self.prescaler) + 1)
    }

    fn count(&self, now: Ticks) -> u64 {
        if self.runs() { self.base + (now - self.since) / self.count_ticks() } else { self.base }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::MICROSECOND;

    /// Microseconds from tick 0 on, both channels interrupting.
    fn microseconds() -> ControlTimer {
        let mut timer = ControlTimer::new(8, 0);
        for (offset, value) in [(PSC, 89), (EGR, 1), (CR1, 1), (DIER, CHANNELS)] {
            timer.write(Write::of(offset, 4, value.into()), 0);
        }
        timer
    }

    #[test]
    fn a_channel_matches_when_the_counter_reaches_it_and_not_before() {
        let mut timer = microseconds();
        timer.write(Write::of(CCR1, 4, 1300), 0);
        timer.write(Write::of(CCR1 + 4, 4, 1800), 0);
        assert_eq!(timer.next_match(), Some(1300 * MICROSECOND));
        assert_eq!(timer.settle(1300 * MICROSECOND - 1), [None, None]);
        assert!(!timer.interrupts());
        assert_eq!(timer.settle(1300 * MICROSECOND), [Some(1300), None]);
        assert!(timer.interrupts());
        timer.write(Write::of(SR, 4, !2), 1301 * MICROSECOND);
        assert!(!timer.interrupts());
        assert_eq!(timer.next_match(), Some(1800 * MICROSECOND));
    }

    #[test]
    fn an_instant_that_has_passed_is_reached_again_after_71_minutes() {
        let mut timer = microseconds();
        assert_eq!(timer.settle(500 * MICROSECOND), [None, None]);
        timer.write(Write::of(CCR1, 4, 500), 500 * MICROSECOND);
        timer.write(Write::of(DIER, 4, 2), 500 * MICROSECOND);
        assert_eq!(timer.next_match(), Some(((1 << 32) + 500) * MICROSECOND));
    }

    #[test]
    fn a_counter_that_a_debugger_has_stopped_goes_on_from_where_it_stood() {
        let mut timer = microseconds();
        timer.freeze(true, 100 * MICROSECOND);
        assert_eq!((timer.read(CNT, 900 * MICROSECOND), timer.next_match()), (100, None));
        timer.freeze(false, 900 * MICROSECOND);
        assert_eq!(timer.read(CNT, 910 * MICROSECOND), 110);
    }
}
