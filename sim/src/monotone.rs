//! A smooth curve through measured points that rises and falls only where they do: Hermite cubics with the slopes of
//! Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5(2), 1984), a weighted harmonic mean of the slopes to either side.
//!
//! ```text
//! d_i = (w_1 + w_2) / (w_1/s_(i-1) + w_2/s_i),   w_1 = 2 h_i + h_(i-1),  w_2 = h_i + 2 h_(i-1)      s_(i-1) s_i > 0
//! d_i = 0                                                                                          else
//! ```
//!
//! At its ends the curve is a parabola, as far as that is monotone; beyond them it holds its last value. Value and
//! slope are continuous in between.

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
        let mut slopes = vec![0.0; x.len()];
        slopes_into(&x, &y, &mut slopes);
        Monotone { x, y, slopes }
    }

    /// Value and slope at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> (f64, f64) {
        between(&self.x, &self.y, &self.slopes, x)
    }
}

/// Value and slope at `at` of a curve through points with slopes.
pub(crate) fn between(x: &[f64], y: &[f64], slopes: &[f64], at: f64) -> (f64, f64) {
    let after = x.partition_point(|place| *place <= at);
    if after == 0 || after == x.len() {
        return (y[after.saturating_sub(1)], 0.0);
    }
    let i = after - 1;
    let h = x[after] - x[i];
    let t = (at - x[i]) / h;
    let rise = y[after] - y[i];
    let [first, last] = [slopes[i] * h, slopes[after] * h];
    let (cube, bend) = (first + last - 2.0 * rise, 3.0 * rise - 2.0 * first - last);
    (y[i] + t * (first + t * (bend + t * cube)), (first + t * (2.0 * bend + t * 3.0 * cube)) / h)
}

/// The slopes at points in rising order of x, as many.
pub(crate) fn slopes_into(x: &[f64], y: &[f64], slopes: &mut [f64]) {
    let width = |i: usize| x[i + 1] - x[i];
    let rise = |i: usize| (y[i + 1] - y[i]) / width(i);
    let last = x.len() - 1;
    for (i, slope) in slopes.iter_mut().enumerate() {
        *slope = match (i, last) {
            (_, 0) => 0.0,
            (_, 1) => rise(0),
            (0, _) => end_slope([width(0), width(1)], [rise(0), rise(1)]),
            (i, last) if i == last => {
                end_slope([width(last - 1), width(last - 2)], [rise(last - 1), rise(last - 2)])
            }
            (i, _) => inner_slope([width(i - 1), width(i)], [rise(i - 1), rise(i)]),
        };
    }
}

fn inner_slope([before, after]: [f64; 2], [up, on]: [f64; 2]) -> f64 {
    if up * on <= 0.0 {
        return 0.0;
    }
    let weights = [2.0 * after + before, after + 2.0 * before];
    (weights[0] + weights[1]) / (weights[0] / up + weights[1] / on)
}

/// The end slope of the parabola through the last three points, limited so that the curve stays monotone.
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

    /// Widths and rises, some of them zero.
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
