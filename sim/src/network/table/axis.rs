//! Piecewise cubic interpolation along one axis, in polynomials a cell.
//!
//! A cell has its values at both ends, and slopes there from the cubic through the four knots nearest to it
//! (order 3, so that the whole is of order 4); cells share the slope at a knot: value and slope are continuous.

use crate::number::Number;

/// Coefficients of 1, t, t^2, t^3 in one cell, t from 0 to 1.
pub(super) type Cubic<N = f64> = [N; 4];

/// Knots from the lowest to the highest, four at least.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    pub knots: Vec<f64>,
    /// Where each slope is taken from: the first of four knots, and their weights.
    stencils: Vec<(usize, [f64; 4])>,
}

impl Axis {
    pub fn new(knots: Vec<f64>) -> Axis {
        let last = knots.len() - 4;
        let stencil = |i: usize| {
            let first = i.saturating_sub(1).min(last);
            (first, slope_weights(&knots[first..first + 4], knots[i]))
        };
        let stencils = (0..knots.len()).map(stencil).collect();
        Axis { knots, stencils }
    }

    /// Of the same width from `low` to `high`.
    pub fn even(low: f64, high: f64, cells: usize) -> Axis {
        let at = |i: usize| low + (high - low) * i as f64 / cells as f64;
        Axis::new((0..=cells).map(at).collect())
    }

    pub fn cells(&self) -> usize {
        self.knots.len() - 1
    }

    pub fn width(&self, cell: usize) -> f64 {
        self.knots[cell + 1] - self.knots[cell]
    }

    /// The polynomials through a value a knot.
    pub fn cubics<N: Number>(&self, values: impl Fn(usize) -> N) -> impl Iterator<Item = Cubic<N>> {
        let slope = move |i: usize| {
            let (first, [a, b, c, d]) = self.stencils[i];
            let part = |weight: f64, k: usize| N::from(weight) * values(first + k);
            (values(i), part(a, 0) + part(b, 1) + part(c, 2) + part(d, 3))
        };
        let (two, three) = (N::from(2.0), N::from(3.0));
        let mut last = slope(0);
        (0..self.cells()).map(move |i| {
            let next = slope(i + 1);
            let ((value, begin), (end_value, end)) = (last, next);
            last = next;
            let (h, rise) = (N::from(self.width(i)), end_value - value);
            let (begin, end) = (h * begin, h * end);
            [value, begin, three * rise - two * begin - end, begin + end - two * rise]
        })
    }
}

/// What makes of four values the slope at `x` of the cubic through them.
fn slope_weights(knots: &[f64], x: f64) -> [f64; 4] {
    std::array::from_fn(|k| {
        let others = || (0..4).filter(move |&j| j != k);
        let product: f64 = others().map(|j| knots[k] - knots[j]).product();
        let without =
            |left: usize| -> f64 { others().filter(|&j| j != left).map(|j| x - knots[j]).product() };
        others().map(without).sum::<f64>() / product
    })
}

/// Coefficients of the powers of t of the polynomial through values at `places`.
pub(super) fn polynomial<const O: usize>(places: &[f64; O], values: [f64; O]) -> [f64; O] {
    let mut differences = values;
    for order in 1..O {
        for i in (order..O).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (places[i] - places[i - order]);
        }
    }
    let mut powers = [0.0; O];
    for i in (0..O).rev() {
        for k in (1..O).rev() {
            powers[k] = powers[k - 1] - places[i] * powers[k];
        }
        powers[0] = differences[i] - places[i] * powers[0];
    }
    powers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_met_on_uneven_knots() {
        let f = |x: f64| 2.0 - x + 0.5 * x * x - 3.0 * x * x * x;
        let axis = Axis::new(vec![-1.0, -0.7, 0.1, 0.2, 1.5, 2.0]);
        for (i, [a, b, c, d]) in axis.cubics(|i| f(axis.knots[i])).enumerate() {
            let x = axis.knots[i] + 0.3 * axis.width(i);
            assert!((a + 0.3 * (b + 0.3 * (c + 0.3 * d)) - f(x)).abs() < 1e-12, "{i}");
        }
    }

    #[test]
    fn a_polynomial_goes_through_its_values() {
        let places = [0.1, 0.5, 0.8];
        let [a, b, c] = polynomial(&places, [3.0, -1.0, 2.0]);
        for (t, value) in places.into_iter().zip([3.0, -1.0, 2.0]) {
            assert!((a + t * (b + t * c) - value).abs() < 1e-12, "{t}");
        }
        assert_eq!(polynomial(&[0.5], [7.0]), [7.0]);
    }
}
