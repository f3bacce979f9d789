//! A proportion estimated from draws.

use std::fmt;

/// A number of draws out of a number of draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proportion {
    /// Draws in which it holds.
    pub met: usize,
    /// All draws.
    pub of: usize,
}

/// 95 % of a normal distribution lie within this many standard deviations.
const DEVIATIONS_95: f64 = 1.959_963_984_540_054;

impl Proportion {
    /// Ends of the 95 % interval of the share among all draws there could be (Wilson 1927, the score interval):
    ///
    /// ```text
    /// (p + z^2 / 2n +- z sqrt(p (1 - p) / n + z^2 / 4n^2)) / (1 + z^2 / n)
    /// ```
    ///
    /// Unlike p +- z sqrt(p (1 - p) / n) it has a width where p is 0 or 1. Of no draws nothing is known: 0 to 1.
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        if self.of == 0 {
            return [0.0, 1.0];
        }
        let (n, z2) = (self.of as f64, DEVIATIONS_95 * DEVIATIONS_95);
        let p = self.met as f64 / n;
        let half = (z2 * (p * (1.0 - p) / n + z2 / (4.0 * n * n))).sqrt();
        [-half, half].map(|end| ((p + z2 / (2.0 * n) + end) / (1.0 + z2 / n)).clamp(0.0, 1.0))
    }
}

impl fmt::Display for Proportion {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [low, high] = self.interval().map(|end| 100.0 * end);
        let share = 100.0 * self.met as f64 / self.of.max(1) as f64;
        write!(f, "{} of {}, {share:.0} % ({low:.0} to {high:.0} %)", self.met, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Examples of Newcombe (1998), Two-sided confidence intervals for the single proportion, table I, method 3.
    #[test]
    fn the_interval_is_that_of_published_examples() {
        for (met, of, ends) in [
            (81, 263, [0.2553, 0.3662]),
            (15, 148, [0.0624, 0.1605]),
            (0, 20, [0.0, 0.1611]),
            (1, 29, [0.0061, 0.1718]),
        ] {
            for (end, published) in (Proportion { met, of }).interval().into_iter().zip(ends) {
                assert!((end - published).abs() < 5.1e-5, "{met} of {of}: {end}, {published}");
            }
        }
        assert_eq!((Proportion { met: 0, of: 0 }).interval(), [0.0, 1.0]);
    }

    #[test]
    fn it_is_said_with_its_interval() {
        assert_eq!(Proportion { met: 6, of: 20 }.to_string(), "6 of 20, 30 % (15 to 52 %)");
        assert_eq!(Proportion { met: 60, of: 60 }.to_string(), "60 of 60, 100 % (94 to 100 %)");
    }
}
