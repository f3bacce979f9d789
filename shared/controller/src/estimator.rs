//! Velocity and acceleration as differences of encoder counts (thesis 6.3.3, flags L(14), L(52), L(77)),
//! and the quasi-transient part of the pressure difference.
//!
//! ```text
//! n_v[k] = n[k] - n[k - Wv]          counts per Wv samples
//! n_a[k] = n_v[k] - n_v[k - Wa]      counts per Wv and Wa samples
//! n_q[k] = q[k] - mean of q          q = raw P1 - raw P2
//! ```
//!
//! The thesis's "vary mode" is lost; EQUATIONS section 9 resolves it to these windows (5 and 3
//! samples by default). One history of positions serves both: n_a needs n at k, k - Wv, k - Wa and
//! k - Wv - Wa. Values are exact: no rounding, no overflow (34 bits at most, held in 64).
//!
//! The mean of q forgets with a time constant of 64 samples, so that a standing pressure difference
//! (a load's weight) is no feedback: Burrows' servomechanism has it so (Burrows and Webb, "Further study
//! of a low-pressure on-off pneumatic servomechanism"; the time constant is our choice).

use crate::signal::Sample;

/// Positions kept; the sum of both windows must be smaller.
const HISTORY: usize = 128;

/// Longest window, samples. Two of them and the present sample fit the history.
pub const MAX_WINDOW_SAMPLES: u8 = 63;

/// The mean of the pressure difference forgets in 2^this samples.
const MEAN_SHIFT: u32 = 6;

/// The windows, in samples, 1 to [`MAX_WINDOW_SAMPLES`] each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EstimatorConfig {
    /// Wv, samples.
    pub velocity_window: u8,
    /// Wa, samples.
    pub acceleration_window: u8,
}

/// Position and its differences at one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Motion {
    /// `n[k]`, counts.
    pub position: i32,
    /// `|n[k] - n[k-1]|`, counts: what the supervisor judges the encoder by.
    pub step: u32,
    /// `n_v[k]`, counts per velocity window.
    pub velocity: i64,
    /// `n_a[k]`, counts per velocity window per acceleration window.
    pub acceleration: i64,
    /// `n_q[k]`, raw: the quasi-transient part of the pressure difference.
    pub pressure: i32,
}

/// The history of positions. Before its first sample the drive stood where that one found it, so a
/// drive at rest has no velocity.
#[derive(Clone, Debug)]
pub struct Estimator {
    positions: [i32; HISTORY],
    newest: usize,
    /// Samples taken, as far as they are kept.
    taken: usize,
    /// 2^MEAN_SHIFT times the mean of q.
    pressures: i32,
}

impl Default for Estimator {
    fn default() -> Self {
        Estimator { positions: [0; HISTORY], newest: 0, taken: 0, pressures: 0 }
    }
}

impl Estimator {
    /// The next sample is the first one.
    pub(crate) fn forget(&mut self) {
        self.taken = 0;
    }

    /// Takes the sample k and tells the motion at k.
    pub fn update(&mut self, config: &EstimatorConfig, input: &Sample) -> Motion {
        let difference = i32::from(input.pressure_1) - i32::from(input.pressure_2);
        if self.taken == 0 {
            self.pressures = difference << MEAN_SHIFT;
        }
        self.newest = (self.newest + 1) % HISTORY;
        self.positions[self.newest] = input.position;
        self.taken = HISTORY.min(self.taken + 1);
        self.pressures += difference - (self.pressures >> MEAN_SHIFT);

        let v = usize::from(config.velocity_window);
        let a = usize::from(config.acceleration_window);
        let [n, n_v, n_a, n_va] = [0, v, a, a + v].map(|samples| i64::from(self.back(samples)));
        let velocity = n - n_v;
        let velocity_before = n_a - n_va;
        Motion {
            position: input.position,
            step: input.position.abs_diff(self.back(1)),
            velocity,
            acceleration: velocity - velocity_before,
            pressure: difference - (self.pressures >> MEAN_SHIFT),
        }
    }

    /// `n[k - samples]`; before the first sample, that one's.
    fn back(&self, samples: usize) -> i32 {
        let samples = samples.min(self.taken.wrapping_sub(1));
        self.positions[self.newest.wrapping_sub(samples) % HISTORY]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(position: i32) -> Sample {
        Sample { position, ..Sample::default() }
    }

    fn pressures(pressure_1: i16, pressure_2: i16) -> Sample {
        Sample { pressure_1, pressure_2, ..Sample::default() }
    }

    const THESIS: EstimatorConfig = EstimatorConfig { velocity_window: 5, acceleration_window: 3 };

    #[test]
    fn a_drive_at_rest_has_no_velocity_from_the_first_sample_on() {
        let mut estimator = Estimator::default();
        for _ in 0..20 {
            let motion = estimator.update(&THESIS, &at(8192));
            assert_eq!((motion.velocity, motion.acceleration, motion.step), (0, 0, 0));
        }
    }

    #[test]
    fn what_was_before_a_new_beginning_is_no_motion() {
        let (mut used, mut new) = (Estimator::default(), Estimator::default());
        for k in 0..200 {
            used.update(&THESIS, &at(50 * k));
        }
        used.forget();
        for k in 0..200 {
            let input = Sample { pressure_1: 3000, ..at(8192 + k * k) };
            assert_eq!(used.update(&THESIS, &input), new.update(&THESIS, &input));
        }
    }

    #[test]
    fn constant_speed_is_counts_per_window_without_acceleration() {
        let mut estimator = Estimator::default();
        let motion = (0..20).map(|k| estimator.update(&THESIS, &at(7 * k))).last().expect("samples");
        assert_eq!((motion.velocity, motion.acceleration, motion.step), (35, 0, 7));
    }

    #[test]
    fn constant_acceleration_is_the_product_of_the_windows() {
        // n = k^2: n_v = 10 k - 25, n_a = 10 * 3.
        let mut estimator = Estimator::default();
        let motion = (0..20).map(|k| estimator.update(&THESIS, &at(k * k))).last().expect("samples");
        assert_eq!((motion.velocity, motion.acceleration), (10 * 19 - 25, 30));
    }

    #[test]
    fn the_longest_windows_reach_back_exactly_so_far() {
        let longest =
            EstimatorConfig { velocity_window: MAX_WINDOW_SAMPLES, acceleration_window: MAX_WINDOW_SAMPLES };
        let mut estimator = Estimator::default();
        let motion = (0..300).map(|k| estimator.update(&longest, &at(k * k))).last().expect("samples");
        assert_eq!(motion.velocity, 299 * 299 - (299 - 63) * (299 - 63));
        assert_eq!(motion.acceleration, 2 * 63 * 63);
    }

    #[test]
    fn the_ends_of_the_count_range_do_not_overflow() {
        let mut estimator = Estimator::default();
        estimator.update(&THESIS, &at(i32::MIN));
        let motion = estimator.update(&THESIS, &at(i32::MAX));
        assert_eq!(motion.velocity, (1 << 32) - 1);
        assert_eq!(motion.acceleration, (1 << 32) - 1);
    }

    #[test]
    fn a_step_of_pressure_is_fed_back_and_forgotten() {
        let mut estimator = Estimator::default();
        assert_eq!(estimator.update(&THESIS, &pressures(1000, 2000)).pressure, 0, "standing from the start");
        let after = |n: usize, estimator: &mut Estimator| {
            (0..n)
                .map(|_| estimator.update(&THESIS, &pressures(1640, 2000)).pressure)
                .last()
                .expect("samples")
        };
        assert_eq!(after(1, &mut estimator), 630, "640 less what the mean took of it");
        let after_64 = after(63, &mut estimator);
        assert!((230..=240).contains(&after_64), "640 / e after 64 samples: {after_64}");
        assert!((0..=1).contains(&after(1000, &mut estimator)), "a standing difference is no feedback");
    }

    #[test]
    fn the_ends_of_the_pressure_range_do_not_overflow() {
        let mut estimator = Estimator::default();
        estimator.update(&THESIS, &pressures(i16::MIN, i16::MAX));
        for _ in 0..1000 {
            let motion = estimator.update(&THESIS, &pressures(i16::MAX, i16::MIN));
            assert!(motion.pressure.abs() <= 2 * 65_535);
        }
    }
}
