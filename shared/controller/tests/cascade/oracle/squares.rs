//! Recursive least squares of unknowns in their deviations.

/// Added to the variances with each sample.
const DRIFT: f64 = 1.0 / 4_194_304.0;

pub struct Squares<const N: usize> {
    pub unknown: [f64; N],
    covariance: [[f64; N]; N],
}

impl<const N: usize> Default for Squares<N> {
    fn default() -> Squares<N> {
        let row = |i: usize| std::array::from_fn(|j| f64::from(u8::from(i == j)));
        Squares { unknown: [0.0; N], covariance: std::array::from_fn(row) }
    }
}

impl<const N: usize> Squares<N> {
    /// An unknown may have changed: its variance grows, up to that of the prior.
    pub fn doubt(&mut self, unknown: usize, by: f64) {
        self.covariance[unknown][unknown] = (self.covariance[unknown][unknown] + by).min(1.0);
    }

    pub fn fit(&mut self, h: [f64; N], y: f64, doubt: f64) {
        let p_h: [f64; N] =
            std::array::from_fn(|i| self.covariance[i].iter().zip(&h).map(|(p, h)| p * h).sum());
        let s = 1.0 + doubt * doubt + (0..N).map(|i| h[i] * p_h[i]).sum::<f64>();
        let error = y - (0..N).map(|i| h[i] * self.unknown[i]).sum::<f64>();
        for i in 0..N {
            self.unknown[i] += p_h[i] / s * error;
            for j in 0..N {
                self.covariance[i][j] -= p_h[i] * p_h[j] / s;
            }
            let variance = self.covariance[i][i] + DRIFT;
            self.covariance[i][i] = variance.clamp(DRIFT, 1.0);
        }
    }
}
