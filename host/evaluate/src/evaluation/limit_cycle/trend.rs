//! A straight line by least squares, and how well its slope is known.

/// `y = mean_y + slope (x - mean_x)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trend {
    mean: [f64; 2],
    /// The slope, y per x.
    pub slope: f64,
    /// Standard error of the slope.
    pub deviation: f64,
    /// Sum of the squares of `x - mean_x`.
    spread: f64,
}

impl Trend {
    /// The line of as many y as x; flat, and its slope unknown, where it is not determined.
    pub fn through(x: &[f64], y: &[f64]) -> Trend {
        let count = x.len() as f64;
        let mean = [x, y].map(|values| values.iter().sum::<f64>() / count);
        let products =
            |of: fn(f64, f64) -> f64| x.iter().zip(y).map(|(x, y)| of(x - mean[0], y - mean[1])).sum::<f64>();
        let spread = products(|x, _| x * x);
        let slope = if spread > 0.0 { products(|x, y| x * y) / spread } else { 0.0 };
        let left = (products(|_, y| y * y) - slope * slope * spread).max(0.0);
        let deviation = (left / (count - 2.0) / spread).sqrt();
        Trend {
            mean,
            slope,
            deviation: if deviation.is_finite() { deviation } else { f64::INFINITY },
            spread,
        }
    }

    /// The same of readings that have this standard deviation of their own, whatever their scatter.
    pub fn with_readings_within(self, deviation: f64) -> Trend {
        Trend { deviation: self.deviation.hypot(deviation / self.spread.sqrt()), ..self }
    }

    /// Its y at an x.
    pub fn at(&self, x: f64) -> f64 {
        self.mean[1] + self.slope * (x - self.mean[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_is_that_of_least_squares_with_its_standard_error() {
        let line = Trend::through(&[0.0, 1.0, 2.0, 3.0], &[1.0, 3.0, 4.0, 8.0]);
        assert!((line.slope - 2.2).abs() < 1e-12 && (line.at(0.0) - 0.7).abs() < 1e-12, "{line:?}");
        // Squares left: 0.09 + 0.01 + 1.21 + 0.49 = 1.8; over 2 degrees of freedom and the spread of 5.
        assert!((line.deviation - (1.8_f64 / 2.0 / 5.0).sqrt()).abs() < 1e-12, "{line:?}");
        let rough = line.with_readings_within(1.0);
        assert!((rough.deviation - (0.18_f64 + 0.2).sqrt()).abs() < 1e-12, "{rough:?}");
    }

    #[test]
    fn through_two_points_the_slope_is_known_to_no_accuracy() {
        assert_eq!(Trend::through(&[0.0, 1.0], &[1.0, 3.0]).deviation, f64::INFINITY);
        assert_eq!(Trend::through(&[2.0], &[1.0]).slope, 0.0);
    }
}
