//! The clock of the control: a free-running counter of microseconds with two compare channels, one for the samples
//! and one for their outputs. The arithmetic is in [`super::instants`].

use pneudrive_controller::config::Timing;

use super::instants::{Milliseconds, extend, has_time, left, next_on_grid, output_after};

/// Distance of the compare channels from the counter until a configuration sets them: its shortest period.
const SOON_US: u32 = 100;

/// The meaning of a compare channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// The samples.
    Sample,
    /// Their outputs.
    Output,
}

/// A counter of microseconds that runs freely through 32 bits, with a compare channel for each [`Mark`] that
/// interrupts when the counter reaches it.
pub trait Timer {
    /// The counter, microseconds.
    fn counter(&self) -> u32;

    /// The instant that a channel is set to.
    fn instant(&self, mark: Mark) -> u32;

    /// Sets a channel.
    fn set_instant(&mut self, mark: Mark, instant: u32);

    /// Whether the counter has reached a channel's instant since [`Timer::clear`].
    fn is_reached(&self, mark: Mark) -> bool;

    /// Clears the interrupt of a channel.
    fn clear(&mut self, mark: Mark);
}

/// The clock of the control.
#[derive(Debug)]
pub struct Clock<T> {
    timer: T,
    timing: Timing,
    /// Microseconds since the reset, at the last sample.
    base_us: u64,
    base_ms: Milliseconds,
}

impl<T: Timer> Clock<T> {
    /// A clock on a timer that counts from 0 since the reset. The first sample is a period from now.
    pub fn start(timer: T, timing: Timing) -> Clock<T> {
        let mut clock = Clock { timer, timing, base_us: 0, base_ms: Milliseconds::default() };
        clock.restart();
        clock
    }

    /// Sets both channels anew: the next sample is a period from now, and its output follows.
    fn restart(&mut self) {
        let sample = self.timer.counter().wrapping_add(self.timing.period_us.get().max(SOON_US));
        self.timer.set_instant(Mark::Sample, sample);
        self.timer.set_instant(Mark::Output, sample.wrapping_add(self.timing.delay_us.get()));
        self.timer.clear(Mark::Sample);
        self.timer.clear(Mark::Output);
    }

    /// Takes over the timing of a configuration, if it is another one: the grid begins anew. For a disabled drive.
    pub fn keep(&mut self, timing: Timing) {
        if timing != self.timing {
            self.timing = timing;
            self.restart();
        }
    }

    /// Whether a sample has become due since the last call; sets the next one.
    #[inline]
    pub fn sample_is_due(&mut self) -> bool {
        if !self.timer.is_reached(Mark::Sample) {
            return false;
        }
        self.timer.clear(Mark::Sample);
        let now = self.timer.counter();
        self.base_ms = self.base_ms.after(now.wrapping_sub(self.base_us as u32));
        self.base_us = extend(self.base_us, now);
        let due = self.timer.instant(Mark::Sample);
        self.timer.set_instant(Mark::Sample, next_on_grid(due, self.timing.period_us, now));
        true
    }

    /// Whether an output has become due since the last call; sets the next one, of the sample that is awaited.
    #[inline]
    pub fn output_is_due(&mut self) -> bool {
        if !self.timer.is_reached(Mark::Output) {
            return false;
        }
        self.timer.clear(Mark::Output);
        let sample = self.timer.instant(Mark::Sample);
        let Timing { delay_us, period_us, .. } = self.timing;
        let next = output_after(sample, delay_us, period_us, self.timer.counter());
        self.timer.set_instant(Mark::Output, next);
        true
    }

    /// Microseconds since the reset.
    #[inline]
    #[must_use]
    pub fn now_us(&self) -> u64 {
        extend(self.base_us, self.timer.counter())
    }

    /// Whether work of this length can be done before the next sample or output.
    #[must_use]
    pub fn has_time(&self, work_us: u32) -> bool {
        let instants = [Mark::Sample, Mark::Output].map(|mark| self.timer.instant(mark));
        has_time(left(self.timer.counter(), instants), work_us, self.timing.period_us)
    }

    /// Milliseconds since the reset, at the last sample.
    #[must_use]
    pub fn sampled_ms(&self) -> u64 {
        self.base_ms.whole()
    }

    /// The timer, to be looked at.
    #[must_use]
    pub fn timer(&self) -> &T {
        &self.timer
    }
}
