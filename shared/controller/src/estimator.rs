//! Velocity and acceleration as differences of encoder counts (thesis 6.3.3, flags L(14), L(52), L(77)).
//!
//! ```text
//! n_v[k] = n[k] - n[k - Wv]          counts per Wv samples
//! n_a[k] = n_v[k] - n_v[k - Wa]      counts per Wv and Wa samples
//! ```
//!
//! The thesis's "vary mode" is lost; EQUATIONS section 9 replaces it by these windows (5 and 3 samples by default).
//! One history of positions serves both: n_a needs n at k, k - Wv, k - Wa and k - Wv - Wa. Values are exact: no
//! rounding, no overflow (34 bits at most, held in 64).

/// Positions kept; the sum of both windows must be smaller.
const HISTORY: usize = 128;

/// Longest window, samples. Two of them and the present sample fit the history.
pub const MAX_WINDOW_SAMPLES: u8 = 63;

/// The windows, in samples, 1 to [`MAX_WINDOW_SAMPLES`] each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EstimatorConfig {
    /// Wv, samples.
    pub velocity_window: u8,
    /// Wa, samples.
    pub acceleration_window: u8,
}

impl EstimatorConfig {
    /// Wv, Wa and their sum, samples.
    fn windows(&self) -> [usize; 3] {
        let (v, a) = (usize::from(self.velocity_window), usize::from(self.acceleration_window));
        [v, a, a + v]
    }
}

/// Position and its differences at one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Motion {
    /// `n[k]`, counts.
    pub position: i32,
    /// `|n[k] - n[k-1]|`, counts: the supervisor checks the encoder by it.
    pub step: u32,
    /// `n_v[k]`, counts per velocity window.
    pub velocity: i64,
    /// `n_a[k]`, counts per velocity window per acceleration window.
    pub acceleration: i64,
}

/// The history of positions. Before its first sample the drive counts as at rest at that position, so a drive at rest
/// has no velocity.
#[derive(Clone, Debug)]
pub struct Estimator {
    positions: [i32; HISTORY],
    newest: usize,
    /// Samples taken; not counted beyond the length of the history.
    taken: usize,
}

/// Two histories are equal if they give the same results from any further samples. Neither their arrangement in
/// memory counts, nor how long a drive has stood since its first sample.
impl PartialEq for Estimator {
    fn eq(&self, other: &Estimator) -> bool {
        let have_begun = [self, other].map(|it| it.taken > 0);
        have_begun == [false; 2] || have_begun == [true; 2] && self.history().eq(other.history())
    }
}

impl Eq for Estimator {}

impl Default for Estimator {
    fn default() -> Self {
        Estimator { positions: [0; HISTORY], newest: 0, taken: 0 }
    }
}

impl Estimator {
    /// The next sample is the first one.
    pub(crate) fn forget(&mut self) {
        self.taken = 0;
    }

    /// Takes the position at sample k and returns the motion at k.
    pub fn update(&mut self, config: &EstimatorConfig, position: i32) -> Motion {
        let windows = if self.taken < HISTORY { self.begin(config, position) } else { config.windows() };
        let step = position.abs_diff(self.back(0));
        self.newest = (self.newest + 1) % HISTORY;
        self.positions[self.newest] = position;

        let [n_v, n_a, n_va] = windows.map(|samples| self.back(samples));
        let velocity = i64::from(position) - i64::from(n_v);
        let velocity_before = i64::from(n_a) - i64::from(n_va);
        let acceleration = velocity - velocity_before;
        Motion { position, step, velocity, acceleration }
    }

    /// Windows that end at the first sample, and the position before that one.
    #[cold]
    #[inline(never)]
    fn begin(&mut self, config: &EstimatorConfig, position: i32) -> [usize; 3] {
        if self.taken == 0 {
            self.positions[self.newest % HISTORY] = position;
        }
        let taken = self.taken;
        self.taken += 1;
        config.windows().map(|samples| samples.min(taken))
    }

    /// All positions that may still matter, the newest first.
    fn history(&self) -> impl Iterator<Item = i32> + '_ {
        let first = self.taken.saturating_sub(1);
        (0..HISTORY - 1).map(move |samples| self.back(samples.min(first)))
    }

    /// `n[k - samples]`.
    fn back(&self, samples: usize) -> i32 {
        self.positions[self.newest.wrapping_sub(samples) % HISTORY]
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;

    const THESIS: EstimatorConfig = EstimatorConfig { velocity_window: 5, acceleration_window: 3 };

    #[test]
    fn a_drive_at_rest_has_no_velocity_from_the_first_sample_on() {
        let mut estimator = Estimator::default();
        for _ in 0..20 {
            let motion = estimator.update(&THESIS, 8192);
            assert_eq!((motion.velocity, motion.acceleration, motion.step), (0, 0, 0));
        }
    }

    #[test]
    fn what_was_before_a_new_beginning_is_no_motion() {
        let (mut used, mut new) = (Estimator::default(), Estimator::default());
        for k in 0..200 {
            used.update(&THESIS, 50 * k);
        }
        used.forget();
        for k in 0..200 {
            let position = 8192 + k * k;
            assert_eq!(used.update(&THESIS, position), new.update(&THESIS, position));
        }
    }

    #[test]
    fn estimators_are_equal_if_they_make_the_same_of_what_comes() {
        let after = |positions: &[i32]| {
            let mut estimator = Estimator::default();
            positions.iter().for_each(|&position| {
                estimator.update(&THESIS, position);
            });
            estimator
        };
        assert_eq!(after(&[7]), after(&[7; 300]), "it has stood there");
        assert_eq!(after(&[7, 7, 9]), after(&[7, 9]));
        assert_ne!(after(&[7, 9]), after(&[9]));
        assert_ne!(after(&[7, 9, 9]), after(&[7, 9]), "it moved at another time");
        assert_ne!(after(&[]), after(&[0]), "0 is a position");
        let forgot = |mut estimator: Estimator| {
            estimator.forget();
            estimator
        };
        assert_eq!(forgot(after(&[7, 9])), after(&[]));
        let old = [&[3][..], &[7; HISTORY]].concat();
        assert_eq!(after(&old), after(&[7]), "the move is out of sight");
        let seen = [&[3][..], &[7; HISTORY - 2]].concat();
        assert_ne!(after(&seen), after(&[7]), "it is still in sight of the longest windows");
    }

    #[test]
    fn constant_speed_is_counts_per_window_without_acceleration() {
        let mut estimator = Estimator::default();
        let motion = (0..20).map(|k| estimator.update(&THESIS, 7 * k)).last().expect("samples");
        assert_eq!((motion.velocity, motion.acceleration, motion.step), (35, 0, 7));
    }

    #[test]
    fn constant_acceleration_is_the_product_of_the_windows() {
        // n = k^2: n_v = 10 k - 25, n_a = 10 * 3.
        let mut estimator = Estimator::default();
        let motion = (0..20).map(|k| estimator.update(&THESIS, k * k)).last().expect("samples");
        assert_eq!((motion.velocity, motion.acceleration), (10 * 19 - 25, 30));
    }

    #[test]
    fn the_longest_windows_reach_back_exactly_so_far() {
        let longest =
            EstimatorConfig { velocity_window: MAX_WINDOW_SAMPLES, acceleration_window: MAX_WINDOW_SAMPLES };
        let mut estimator = Estimator::default();
        let motion = (0..300).map(|k| estimator.update(&longest, k * k)).last().expect("samples");
        assert_eq!(motion.velocity, 299 * 299 - (299 - 63) * (299 - 63));
        assert_eq!(motion.acceleration, 2 * 63 * 63);
    }

    #[test]
    fn the_ends_of_the_count_range_do_not_overflow() {
        let mut estimator = Estimator::default();
        estimator.update(&THESIS, i32::MIN);
        let motion = estimator.update(&THESIS, i32::MAX);
        assert_eq!(motion.velocity, (1 << 32) - 1);
        assert_eq!(motion.acceleration, (1 << 32) - 1);
    }
}
