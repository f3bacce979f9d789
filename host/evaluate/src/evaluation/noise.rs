//! The noise of a channel, estimated from the channel itself, as a record does not state it.
//!
//! White noise of standard deviation s has sixth differences of s sqrt(924); those of a smooth motion are negligible up
//! to a tenth of the sampling rate. The median ignores the samples at which a valve opens or a drive hits its stop.

/// How often differences are taken.
const ORDER: usize = 6;

/// Root of the sum of the squared binomial coefficients of that order.
const GAIN: f64 = 30.397_368_307_141_326;

/// Standard deviation of a normal distribution over the median of its sizes.
const FROM_MEDIAN: f64 = 1.4826;

/// The standard deviation of a channel's noise, in the channel's unit; 0 of fewer than seven samples.
///
/// The quantisation of a constant reading does not show: the caller knows its step.
pub(super) fn deviation(values: &[f64]) -> f64 {
    // The previous sample: its value, and its differences up to the fifth.
    let mut before = [0.0; ORDER];
    let difference = |value: &f64| {
        before.iter_mut().fold(*value, |rising, before| rising - std::mem::replace(before, rising))
    };
    let mut sizes: Vec<f64> = values.iter().map(difference).skip(ORDER).map(f64::abs).collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    FROM_MEDIAN * *median / GAIN
}

#[cfg(test)]
pub(super) mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    use super::*;

    /// Normal draws of standard deviation 1, the same for a seed.
    pub fn normal(seed: u64) -> impl FnMut() -> f64 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut unit = move || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        move || (-2.0 * (1.0 - unit()).ln()).sqrt() * (std::f64::consts::TAU * unit()).cos()
    }

    #[test]
    fn noise_is_found_under_a_drive_that_moves_and_vibrates() {
        for (size, seed) in [(0.3, 1), (1.0, 2), (5.0, 3)] {
            let mut draw = normal(seed);
            let motion = |k: f64| 5000.0 * (1.0 - (-k / 150.0).exp()) + 20.0 * (0.4 * k).sin();
            let values: Vec<f64> = (0..2000).map(|k| motion(f64::from(k)) + size * draw()).collect();
            let found = deviation(&values);
            assert!((found / size - 1.0).abs() < 0.15, "{size}: {found}");
        }
    }

    #[test]
    fn a_smooth_motion_in_whole_counts_has_their_rounding_for_noise() {
        let counts: Vec<f64> = (0..2000).map(|k| (3000.0 * (f64::from(k) / 300.0).sin()).floor()).collect();
        assert!((deviation(&counts) * 12_f64.sqrt() - 1.0).abs() < 0.15, "{}", deviation(&counts));
        assert_eq!(deviation(&[7.0; 100]), 0.0);
        assert_eq!(deviation(&[7.0; 3]), 0.0);
    }
}
