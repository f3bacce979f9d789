//! The quasi-transient part of the pressure difference, which the on-off law feeds back.
//!
//! ```text
//! n_q[k] = q[k] - mean of q          q = raw P1 - raw P2
//! ```
//!
//! The mean of q forgets with a time constant of 64 samples, so that a standing pressure difference (a load's weight)
//! is not fed back. Burrows' servomechanism does the same (Burrows and Webb, "Further study of a low-pressure on-off
//! pneumatic servomechanism"). The time constant is our choice.

/// The time constant of the mean is 2^this samples.
const MEAN_SHIFT: u32 = 6;

/// 2^[`MEAN_SHIFT`] times the mean of q; None before the first sample, which counts as a standing difference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Mean(Option<i32>);

impl Mean {
    /// Takes sample k; `n_q[k]`, raw.
    pub fn transient(&mut self, [pressure_1, pressure_2]: [i16; 2]) -> i32 {
        let difference = i32::from(pressure_1) - i32::from(pressure_2);
        let before = self.0.unwrap_or(difference << MEAN_SHIFT);
        let mean = before + difference - (before >> MEAN_SHIFT);
        self.0 = Some(mean);
        difference - (mean >> MEAN_SHIFT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_of_pressure_is_fed_back_and_forgotten() {
        let mut mean = Mean::default();
        assert_eq!(mean.transient([1000, 2000]), 0, "standing from the start");
        let after =
            |n: usize, mean: &mut Mean| (0..n).map(|_| mean.transient([1640, 2000])).last().expect("samples");
        assert_eq!(after(1, &mut mean), 630, "640 less what the mean took of it");
        let after_64 = after(63, &mut mean);
        assert!((230..=240).contains(&after_64), "640 / e after 64 samples: {after_64}");
        assert!((0..=1).contains(&after(1000, &mut mean)), "a standing difference is no feedback");
    }

    #[test]
    fn the_ends_of_the_pressure_range_do_not_overflow() {
        let mut mean = Mean::default();
        mean.transient([i16::MIN, i16::MAX]);
        for _ in 0..1000 {
            assert!(mean.transient([i16::MAX, i16::MIN]).abs() <= 2 * 65_535);
        }
    }
}
