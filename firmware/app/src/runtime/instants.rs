//! The clock of the control: a free-running counter of microseconds with two compare channels.
//!
//! Channel 1 marks the samples, channel 2 their outputs. Each event sets its own channel to the next instant. It counts
//! from the event before and not from the time at which the processor handled it, so samples stay on the grid k * period.
//! An instant that cannot be met any more is skipped: the counter would reach it again only after 71 minutes.

use core::num::NonZeroU32;

/// A closer instant counts as missed, microseconds: writing it must be over by then.
pub const GUARD_US: u32 = 5;

/// Value of a timer's prescaler that makes it count microseconds; None if no value does.
#[must_use]
pub const fn prescaler(timer_hz: u32) -> Option<u16> {
    let ticks = timer_hz / 1_000_000;
    if ticks == 0 || ticks > 0x1_0000 || !timer_hz.is_multiple_of(1_000_000) {
        return None;
    }
    Some((ticks - 1) as u16)
}

/// Microseconds since the reset, from those at an earlier look and the counter now. Right if less than
/// 71 minutes lie between.
#[must_use]
pub fn extend(earlier_us: u64, counter: u32) -> u64 {
    let passed = counter.wrapping_sub(earlier_us as u32);
    earlier_us.wrapping_add(u64::from(passed))
}

/// Milliseconds, counted along: the processor has no instruction that divides 64 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Milliseconds {
    whole: u64,
    rest_us: u32,
}

impl Milliseconds {
    /// This many microseconds have passed.
    #[must_use]
    pub fn after(self, passed_us: u32) -> Milliseconds {
        let us = self.rest_us.saturating_add(passed_us);
        Milliseconds { whole: self.whole.saturating_add(u64::from(us / 1000)), rest_us: us % 1000 }
    }

    /// Whole milliseconds so far.
    #[must_use]
    pub fn whole(self) -> u64 {
        self.whole
    }
}

/// The next instant after `previous` on the grid of the period that can still be met at `now`.
#[must_use]
pub fn next_on_grid(previous: u32, period_us: NonZeroU32, now: u32) -> u32 {
    let busy = now.wrapping_add(GUARD_US).wrapping_sub(previous);
    // A look back into the future: `now` is before `previous`, which was only just reached.
    let busy = if busy > u32::MAX / 2 { 0 } else { busy };
    let periods = (busy / period_us).saturating_add(1);
    previous.wrapping_add(periods.wrapping_mul(period_us.get()))
}

/// The instant of an output: `delay` after the sample that is due, or after a later one if it can't be
/// met any more.
#[must_use]
pub fn output_after(sample: u32, delay_us: NonZeroU32, period_us: NonZeroU32, now: u32) -> u32 {
    let due = sample.wrapping_add(delay_us.get());
    let left = due.wrapping_sub(now);
    if left > GUARD_US && left <= u32::MAX / 2 { due } else { next_on_grid(due, period_us, now) }
}

/// Microseconds until the next of two instants, of which neither has passed for longer than a period.
#[must_use]
pub fn left(now: u32, instants: [u32; 2]) -> u32 {
    let until = |instant: u32| {
        let left = instant.wrapping_sub(now);
        if left > u32::MAX / 2 { 0 } else { left }
    };
    let [a, b] = instants.map(until);
    a.min(b)
}

/// Whether a piece of work can be done before the next of two instants, this far away. If the period never leaves the
/// time for it, a quarter of the period must do: some gap between sample and output is twice as long.
#[must_use]
pub fn has_time(left_us: u32, work_us: u32, period_us: NonZeroU32) -> bool {
    left_us > work_us.min(period_us.get() / 4)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD: NonZeroU32 = NonZeroU32::new(1300).unwrap();
    const DELAY: NonZeroU32 = NonZeroU32::new(500).unwrap();

    #[test]
    fn a_timer_of_90_mhz_counts_microseconds_with_prescaler_89() {
        assert_eq!(prescaler(90_000_000), Some(89));
        assert_eq!(prescaler(1_000_000), Some(0));
        assert_eq!((prescaler(500_000), prescaler(45_500_000)), (None, None));
    }

    #[test]
    fn time_goes_on_when_the_counter_wraps() {
        let before = u64::from(u32::MAX) - 10;
        assert_eq!(extend(before, u32::MAX - 10), before);
        assert_eq!(extend(before, 20), before + 31);
        assert_eq!(extend(7 << 32, 100), (7 << 32) + 100);
    }

    #[test]
    fn no_part_of_a_millisecond_is_lost() {
        let mut time = Milliseconds::default();
        for _ in 0..10 {
            time = time.after(1300);
        }
        assert_eq!(time.whole(), 13);
        assert_eq!(time.after(999).whole(), 13);
        assert_eq!(time.after(1000).whole(), 14);
    }

    #[test]
    fn samples_stay_on_the_grid_however_late_the_processor_comes() {
        for latency in [0, 1, 40, 1200, 1294] {
            assert_eq!(next_on_grid(1000, PERIOD, 1000 + latency), 2300, "{latency}");
        }
    }

    #[test]
    fn a_sample_that_cannot_be_met_is_left_out_and_the_grid_stays() {
        assert_eq!(next_on_grid(1000, PERIOD, 2295), 3600);
        assert_eq!(next_on_grid(1000, PERIOD, 2300), 3600);
        // A flash sector's erasure stalls the processor for most of a second.
        let next = next_on_grid(1000, PERIOD, 801_000);
        assert_eq!((next - 1000) % 1300, 0);
        assert!(next > 801_000 && next <= 801_000 + 1300 + GUARD_US);
    }

    #[test]
    fn instants_go_on_when_the_counter_wraps() {
        let last = u32::MAX - 99;
        assert_eq!(next_on_grid(last, PERIOD, last.wrapping_add(20)), 1200);
        assert_eq!(output_after(last, DELAY, PERIOD, last.wrapping_sub(800)), 400);
    }

    #[test]
    fn every_instant_that_is_set_lies_ahead_by_the_guard_and_not_by_more_than_a_period() {
        for period in [100, 1300, 100_000].map(|us| NonZeroU32::new(us).expect("not 0")) {
            for late in (0..300_000).step_by(7) {
                let ahead = next_on_grid(50, period, 50 + late) - (50 + late);
                assert!(ahead > GUARD_US && ahead <= period.get() + GUARD_US, "{period} {late}: {ahead}");
            }
        }
    }

    #[test]
    fn an_output_is_delay_after_its_sample() {
        // Set at the output before: 800 us ahead of the sample.
        assert_eq!(output_after(2300, DELAY, PERIOD, 1500), 2800);
        // A delay shorter than the way into the interrupt is met, since it is set before the sample.
        assert_eq!(output_after(2300, NonZeroU32::MIN, PERIOD, 1600), 2301);
    }

    #[test]
    fn an_output_that_cannot_be_met_is_left_out() {
        assert_eq!(output_after(2300, DELAY, PERIOD, 2798), 4100);
        assert_eq!(output_after(2300, DELAY, PERIOD, 2900), 4100);
    }

    #[test]
    fn what_is_left_is_the_time_to_the_next_instant_and_nothing_once_one_is_due() {
        assert_eq!(left(1000, [2300, 1500]), 500);
        assert_eq!(left(1600, [2300, 2800]), 700);
        assert_eq!(left(2301, [2300, 2800]), 0);
        assert_eq!(left(u32::MAX - 9, [90, 600]), 100);
    }

    #[test]
    fn work_is_begun_when_it_is_over_before_the_control_is_due() {
        assert!(has_time(81, 80, PERIOD) && !has_time(80, 80, PERIOD));
        let short = NonZeroU32::new(100).expect("not zero");
        assert!(has_time(26, 80, short), "a period of 100 us never leaves 80 us");
        assert!(!has_time(25, 80, short));
    }
}
