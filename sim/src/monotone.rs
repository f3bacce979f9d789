//! A smooth curve through measured points that rises and falls only where they do: cubics by Hermite with the slopes of Fritsch
//! and Butland (SIAM J. Sci. Stat. Comput. 5(2), 1984), a weighted harmonic mean of the slopes to either side.
//!
//! ```text
//! d_i = (w_1 + w_2) / (w_1/s_(i-1) + w_2/s_i),   w_1 = 2 h_i + h_(i-1),  w_2 = h_i + 2 h_(i-1)      s_(i-1) s_i > 0
//! d_i = 0                                                                                          else
//! ```
//!
//! At its ends the curve is a parabola, as far as that is monotone; beyond them it holds its last value. Value and slope are
//! continuous in between.

/// A curve through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Monotone {
    x: Vec<f64>,
    y: Vec<f64>,
    slopes: Vec<f64>,
}

impl Monotone {
    /// Through points in rising order of x; of a single one a constant.
    ///
    /// # Panics
    /// When there are no points, or not as many y as x.
    #[must_use]
    pub fn through(x: Vec<f64>, y: Vec<f64>) -> Monotone {
        assert!(!x.is_empty() && x.len() == y.len(), "a curve needs points");
        let widths: Vec<f64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let rises: Vec<f64> = y.windows(2).zip(&widths).map(|(pair, h)| (pair[1] - pair[0]) / h).collect();
        let slopes = (0..x.len()).map(|i| slope(i, &widths, &rises)).collect();
        Monotone { x, y, slopes }
    }

    /// Value and slope at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> (f64, f64) {
        let after = self.x.partition_point(|place| *place <= x);
        if after == 0 || after == self.x.len() {
            return (self.y[after.saturating_sub(1)], 0.0);
        }
        let i = after - 1;
        let h = self.x[after] - self.x[i];
        let t = (x - self.x[i]) / h;
        let rise = self.y[after] - self.y[i];
        let [first, last] = [self.slopes[i] * h, self.slopes[after] * h];
        let (square, bend) = (first + last - 2.0 * rise, 3.0 * rise - 2.0 * first - last);
        let value = self.y[i] + t * (first + t * (bend + t * square));
        (value, (first + t * (2.0 * bend + t * 3.0 * square)) / h)
    }
}

/// The slope at point `i`, by the widths of the gaps and the slopes of their chords.
fn slope(i: usize, widths: &[f64], rises: &[f64]) -> f64 {
    let last = rises.len();
    match (i, last) {
        (_, 0) => 0.0,
        (_, 1) => rises[0],
        (0, _) => end_slope([widths[0], widths[1]], [rises[0], rises[1]]),
        (i, last) if i == last => {
            end_slope([widths[last - 1], widths[last - 2]], [rises[last - 1], rises[last - 2]])
        }
        (i, _) => inner_slope([widths[i - 1], widths[i]], [rises[i - 1], rises[i]]),
    }
}

fn inner_slope([before, after]: [f64; 2], [up, on]: [f64; 2]) -> f64 {
    if up * on <= 0.0 {
        return 0.0;
    }
    let weights = [2.0 * after + before, after + 2.0 * before];
    (weights[0] + weights[1]) / (weights[0] / up + weights[1] / on)
}

/// That of the parabola through three points, the end and its neighbours, as far as the curve stays monotone.
fn end_slope([near, far]: [f64; 2], [first, second]: [f64; 2]) -> f64 {
    let slope = ((2.0 * near + far) * first - near * second) / (near + far);
    if slope * first <= 0.0 {
        0.0
    } else if first * second <= 0.0 && slope.abs() > 3.0 * first.abs() {
        3.0 * first
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn it_goes_through_its_points_and_holds_its_ends() {
        let curve = Monotone::through(vec![0.0, 1.0, 3.0, 4.0], vec![0.0, 0.5, 2.0, 2.0]);
        for (x, y) in [(0.0, 0.0), (1.0, 0.5), (3.0, 2.0), (4.0, 2.0), (-1.0, 0.0), (9.0, 2.0)] {
            assert!((curve.at(x).0 - y).abs() < 1e-15, "{x}: {:?}", curve.at(x));
        }
        assert_eq!(curve.at(3.5), (2.0, 0.0), "level where the points are");
    }

    /// By hand: h = 1 and 2, s = 1 and 2: w_1 = 5, w_2 = 4, d = 9/(5/1 + 4/2) = 9/7.
    #[test]
    fn an_inner_slope_is_the_weighted_harmonic_mean() {
        let curve = Monotone::through(vec![0.0, 1.0, 3.0], vec![0.0, 1.0, 5.0]);
        assert!((curve.at(1.0).1 - 9.0 / 7.0).abs() < 1e-15, "{:?}", curve.at(1.0));
    }

    #[test]
    fn a_straight_line_stays_one() {
        let curve = Monotone::through(vec![0.0, 1.0, 3.0, 4.0], vec![1.0, 3.0, 7.0, 9.0]);
        for i in 0..400 {
            let x = 0.01 * f64::from(i);
            let (value, slope) = curve.at(x);
            assert!((value - 1.0 - 2.0 * x).abs() < 1e-13 && (slope - 2.0).abs() < 1e-12, "{x}");
        }
    }

    /// Widths and rises, of which some are none.
    fn steps() -> impl Strategy<Value = Vec<(f64, f64)>> {
        prop::collection::vec((0.01..3.0_f64, prop_oneof![Just(0.0_f64), 0.0..5.0_f64]), 1..12)
    }

    proptest! {
        #[test]
        fn between_rising_points_it_rises_and_never_leaves_their_values(steps in steps(), falling: bool) {
            let sign: f64 = if falling { -1.0 } else { 1.0 };
            let (mut x, mut y) = (vec![0.0_f64], vec![0.0_f64]);
            for (i, (width, rise)) in steps.into_iter().enumerate() {
                x.push(x[i] + width);
                y.push(y[i] + sign * rise);
            }
            let curve = Monotone::through(x.clone(), y.clone());
            for i in 1..x.len() {
                for part in 0..=20 {
                    let at = x[i - 1] + (x[i] - x[i - 1]) * f64::from(part) / 20.0;
                    let (value, slope) = curve.at(at);
                    prop_assert!(sign * slope >= -1e-9, "{at}: {slope}");
                    let inside = (y[i - 1].min(y[i]) - 1e-12..=y[i - 1].max(y[i]) + 1e-12).contains(&value);
                    prop_assert!(inside, "{at}: {value}");
                }
            }
        }

        #[test]
        fn its_slope_is_that_of_its_value(steps in steps(), place in 0.001..0.999_f64) {
            let (mut x, mut y) = (vec![0.0_f64], vec![0.0_f64]);
            for (i, (width, rise)) in steps.into_iter().enumerate() {
                x.push(x[i] + width);
                y.push(y[i] + rise);
            }
            let at = place * x[x.len() - 1];
            prop_assume!(x.iter().all(|knot| (knot - at).abs() > 1e-5));
            let curve = Monotone::through(x, y);
            let central: f64 = (curve.at(at + 1e-6).0 - curve.at(at - 1e-6).0) / 2e-6;
            prop_assert!((curve.at(at).1 - central).abs() < 1e-4 * (1.0 + central.abs()), "{at}");
        }
    }
}
