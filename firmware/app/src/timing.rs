//! The timer calibration (thesis 7.1.4), by the board's own clock: how even the samples come, and how
//! long a sample takes to become an output.

use pneudrive_protocol::{HISTOGRAM_BINS, Spread};

/// Times on one side or the other of what they should be. Counts wrap after 64 days of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Histogram {
    least_us: u32,
    most_us: u32,
    /// Bin b counts deviations of 2^(b-1) to 2^b - 1 us; bin 0 those of none, the last all larger ones.
    bins: [u32; HISTOGRAM_BINS],
}

impl Default for Histogram {
    fn default() -> Self {
        Histogram { least_us: u32::MAX, most_us: 0, bins: [0; HISTOGRAM_BINS] }
    }
}

impl Histogram {
    /// Takes a time that should be `nominal_us`.
    #[inline(always)] // Twice a sample, in the control interrupt.
    pub fn take(&mut self, time_us: u32, nominal_us: u32) {
        let deviation = time_us.abs_diff(nominal_us);
        let bin = (u32::BITS - deviation.leading_zeros()) as usize;
        if let Some(bin) = self.bins.get_mut(bin.min(HISTOGRAM_BINS - 1)) {
            *bin = bin.wrapping_add(1);
        }
        self.least_us = self.least_us.min(time_us);
        self.most_us = self.most_us.max(time_us);
    }

    /// What was taken so far; all 0 for nothing.
    #[must_use]
    pub fn spread(&self) -> Spread {
        let count = self.bins.iter().fold(0u32, |sum, bin| sum.wrapping_add(*bin));
        let least_us = if count == 0 { 0 } else { self.least_us };
        Spread { count, least_us, most_us: self.most_us, bins: self.bins }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
