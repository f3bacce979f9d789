//! Straight lines through measured points, by least squares.

use super::figures::Figure;

/// y = intercept + slope x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// At x = 0; exactly 0 of a line that is made to go through there.
    pub intercept: Figure,
    /// Over x.
    pub slope: Figure,
    /// Standard deviation of the points from the line.
    pub scatter: f64,
}

impl Line {
    /// Through points; None where fewer than three, or no two with different x.
    ///
    /// ```
    /// use pneudrive_identify::regression::Line;
    ///
    /// // Force over speed of a load that is pulled along: Coulomb friction of 40 N, viscous friction of 30 N s/m.
    /// let pulled = [(0.1, 43.1), (0.2, 45.8), (0.3, 49.1), (0.4, 52.0)];
    /// let line = Line::through(&pulled).expect("different speeds");
    /// assert!((line.intercept.value - 40.0).abs() < 2.0 * line.intercept.error);
    /// assert!((line.slope.value - 30.0).abs() < 2.0 * line.slope.error);
    /// ```
    #[must_use]
    pub fn through(points: &[(f64, f64)]) -> Option<Line> {
        let n = points.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
        let (x_0, y_0) = (mean(|point| point.0), mean(|point| point.1));
        let moved: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x - x_0, y - y_0)).collect();
        let Line { slope, .. } = Line::through_origin(&moved)?;
        let freedom = (points.len() > 2).then_some(n - 2.0)?;
        let scatter = (squares(&moved, slope.value) / freedom).sqrt();
        let spread: f64 = moved.iter().map(|(x, _)| x * x).sum();
        Some(Line {
            intercept: Figure {
                value: y_0 - slope.value * x_0,
                error: scatter * (1.0 / n + x_0 * x_0 / spread).sqrt(),
            },
            slope: Figure { value: slope.value, error: scatter / spread.sqrt() },
            scatter,
        })
    }

    /// Through points and the origin; None where fewer than two, or all at x = 0.
    #[must_use]
    pub(crate) fn through_origin(points: &[(f64, f64)]) -> Option<Line> {
        let spread: f64 = points.iter().map(|(x, _)| x * x).sum();
        if points.len() < 2 || spread == 0.0 {
            return None;
        }
        let slope = points.iter().map(|(x, y)| x * y).sum::<f64>() / spread;
        let scatter = (squares(points, slope) / (points.len() - 1) as f64).sqrt();
        let intercept = Figure { value: 0.0, error: 0.0 };
        Some(Line { intercept, slope: Figure { value: slope, error: scatter / spread.sqrt() }, scatter })
    }
}

fn squares(points: &[(f64, f64)], slope: f64) -> f64 {
    points.iter().map(|(x, y)| (y - slope * x).powi(2)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: x = 0, 1, 2 with y = 1, 2, 4: slope 1.5, intercept 5/6, squares left 1/6.
    #[test]
    fn a_line_through_three_points_is_that_of_the_textbook() {
        let line = Line::through(&[(0.0, 1.0), (1.0, 2.0), (2.0, 4.0)]).expect("a line");
        assert!((line.slope.value - 1.5).abs() < 1e-12 && (line.intercept.value - 5.0 / 6.0).abs() < 1e-12);
        assert!((line.scatter - (1.0f64 / 6.0).sqrt()).abs() < 1e-12);
        assert!((line.slope.error - (1.0f64 / 12.0).sqrt()).abs() < 1e-12);
        assert!((line.intercept.error - (1.0f64 / 6.0 * (1.0 / 3.0 + 0.5)).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn points_that_make_no_line_give_none() {
        assert!(Line::through(&[(0.0, 1.0), (1.0, 2.0)]).is_none());
        assert!(Line::through(&[(1.0, 1.0), (1.0, 2.0), (1.0, 3.0)]).is_none());
        assert!(Line::through_origin(&[(0.0, 1.0), (0.0, 2.0)]).is_none());
    }
}
