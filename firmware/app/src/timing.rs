//! The timer calibration (thesis 7.1.4), by the board's own clock: the jitter of the samples, and the latency from a
//! sample to its output.

use pneudrive_controller::config::Timing;
use pneudrive_protocol::{HISTOGRAM_BINS, Spread};

/// Samples since the clock was restarted. The control interrupt only notes its two times. The idle task
/// [settles](Clock::settle) them before the next sample. If it has not, the next sample does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clock {
    last_us: u32,
    runs: bool,
    interval_us: Option<u32>,
    latency_us: Option<u32>,
    intervals: Histogram,
    latencies: Histogram,
}

impl Clock {
    /// A sample has come: the time since the one before, microseconds; none at the first one. Times are
    /// differences of 32 bits, since a watchdog bites long before the 71 minutes at which those wrap.
    #[inline(always)] // As `output`: in the control interrupt.
    pub fn sample(&mut self, now_us: u32, timing: &Timing) -> Option<u32> {
        if self.interval_us.is_some() || self.latency_us.is_some() {
            self.settle(timing);
        }
        let interval_us = self.runs.then(|| now_us.wrapping_sub(self.last_us));
        self.interval_us = interval_us;
        self.last_us = now_us;
        self.runs = true;
        interval_us
    }

    /// Whether the output of the last sample comes too late. A sample from before a restart of the clock has no time.
    #[inline(always)]
    pub(crate) fn output_is_late(&self, now_us: u32, timing: &Timing) -> bool {
        self.runs && now_us.wrapping_sub(self.last_us) > timing.latest_output_us
    }

    /// The output of the last sample is done. One whose sample came before the clock was restarted has no
    /// latency.
    #[inline(always)]
    pub fn output(&mut self, now_us: u32) {
        self.latency_us = self.runs.then(|| now_us.wrapping_sub(self.last_us));
    }

    /// Takes the noted times into the histograms.
    #[cold]
    #[inline(never)]
    pub fn settle(&mut self, timing: &Timing) {
        if let Some(interval_us) = self.interval_us.take() {
            self.intervals.take(interval_us, timing.period_us.get());
        }
        if let Some(latency_us) = self.latency_us.take() {
            self.latencies.take(latency_us, timing.delay_us.get());
        }
    }

    /// Mean interval of the samples, ns; none before there are two.
    #[must_use]
    pub(crate) fn mean_interval_ns(&self) -> Option<u32> {
        let Histogram { sum_us, .. } = self.intervals;
        let mean = sum_us.saturating_mul(1000).checked_div(u64::from(self.intervals.count()))?;
        u32::try_from(mean).ok()
    }

    /// From one sample to the next, and from a sample to the end of its output.
    #[must_use]
    pub fn spreads(&self) -> [Spread; 2] {
        [self.intervals.spread(), self.latencies.spread()]
    }
}

/// Times on one side or the other of their nominal value. Counts wrap after 64 days of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Histogram {
    least_us: u32,
    most_us: u32,
    sum_us: u64,
    /// Bin b counts deviations of 2^(b-1) to 2^b - 1 us; bin 0 those of none, the last all larger ones.
    bins: [u32; HISTOGRAM_BINS],
}

impl Default for Histogram {
    fn default() -> Self {
        Histogram { least_us: u32::MAX, most_us: 0, sum_us: 0, bins: [0; HISTOGRAM_BINS] }
    }
}

impl Histogram {
    /// Takes a time that should be `nominal_us`.
    fn take(&mut self, time_us: u32, nominal_us: u32) {
        let deviation = time_us.abs_diff(nominal_us);
        let bin = (u32::BITS - deviation.leading_zeros()) as usize;
        if let Some(bin) = self.bins.get_mut(bin.min(HISTOGRAM_BINS - 1)) {
            *bin = bin.wrapping_add(1);
        }
        self.least_us = self.least_us.min(time_us);
        self.most_us = self.most_us.max(time_us);
        self.sum_us = self.sum_us.saturating_add(u64::from(time_us));
    }

    /// How many were taken.
    fn count(&self) -> u32 {
        self.bins.iter().fold(0, |sum, bin| sum.wrapping_add(*bin))
    }

    /// The statistics so far; all 0 without samples.
    fn spread(&self) -> Spread {
        let count = self.count();
        let least_us = if count == 0 { 0 } else { self.least_us };
        Spread { count, least_us, most_us: self.most_us, bins: self.bins }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::num::NonZeroU32;

    const TIMING: Timing = Timing {
        period_us: NonZeroU32::new(1300).unwrap(),
        delay_us: NonZeroU32::new(500).unwrap(),
        late_sample_us: 100,
        latest_output_us: 600,
        host_silence_ms: 0,
        hold_ms: 0,
        input_debounce_ms: 10,
        input_settling_ms: 20,
    };

    /// A clock after samples at these times, each with an output 510 us later; who is idle settles.
    fn clock(samples_us: &[u32], idle: bool) -> Clock {
        let mut clock = Clock::default();
        for &now_us in samples_us {
            clock.sample(now_us, &TIMING);
            clock.output(now_us.wrapping_add(510));
            if idle {
                clock.settle(&TIMING);
            }
        }
        clock.settle(&TIMING);
        clock
    }

    #[test]
    fn what_nobody_idle_has_settled_is_not_lost() {
        let times = [u32::MAX, 1299, 2600, 3900];
        let [intervals, latencies] = clock(&times, false).spreads();
        assert_eq!((intervals.count, intervals.least_us, intervals.most_us), (3, 1300, 1301));
        assert_eq!((latencies.count, latencies.least_us, latencies.most_us), (4, 510, 510));
        assert_eq!(clock(&times, true).spreads(), [intervals, latencies]);
        assert_eq!(clock(&times, true).mean_interval_ns(), Some(1_300_333));
    }

    #[test]
    fn an_output_behind_a_restart_of_the_clock_has_no_latency() {
        let mut clock = Clock::default();
        clock.output(70_000_000);
        clock.settle(&TIMING);
        assert_eq!(clock.spreads().map(|spread| spread.count), [0, 0]);
    }

    #[test]
    fn a_sample_whose_output_never_came_keeps_its_interval() {
        let mut clock = Clock::default();
        for now_us in [0, 5000, 6300] {
            clock.sample(now_us, &TIMING);
        }
        clock.settle(&TIMING);
        let [intervals, _] = clock.spreads();
        assert_eq!((intervals.count, intervals.most_us), (2, 5000), "a long lock has held both up");
    }

    #[test]
    fn the_first_sample_has_an_output_but_no_interval() {
        let first = clock(&[7], true);
        assert_eq!(first.spreads().map(|spread| spread.count), [0, 1]);
        assert_eq!(first.mean_interval_ns(), None);
    }

    #[test]
    fn deviations_are_counted_by_powers_of_two() {
        let mut histogram = Histogram::default();
        assert_eq!(histogram.spread(), Spread::default());
        for time in [1300, 1300, 1301, 1299, 1302, 1297, 1304, 5000, u32::MAX] {
            histogram.take(time, 1300);
        }
        let spread = histogram.spread();
        assert_eq!((spread.count, spread.least_us, spread.most_us), (9, 1297, u32::MAX));
        assert_eq!(spread.bins, [2, 2, 2, 1, 0, 0, 0, 0, 0, 0, 0, 2]);
    }
}
