//! How exactly the data determine what was fitted, and what they do not show.
//!
//! ```text
//! C = (J' J)^-1                                 white residuals
//! C = (J' J)^-1 S (J' J)^-1,                    correlated ones (Newey and West 1987)
//! S = sum over t, |l| <= L of (1 - |l| / (L + 1)) g_t g_(t+l)',    g_t = J_t r_t,  L = sqrt(n)
//! ```
//!
//! J is that of the data alone, without the terms of the parameters. Standard errors of 95 % intervals are
//! those of the normal distribution: there are thousands of samples.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::Unseen;
use super::least_squares::Minimum;
use super::model::Model;
use super::parameter::Parameter;

/// Half of a 95 % interval of the normal distribution, standard deviations.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Residuals are correlated where the correlation of neighbours is so many standard deviations from zero.
const CORRELATED: f64 = 4.0;

/// Curvature below which nothing depends on a combination of parameters.
const FLAT: f64 = 1e-12;

/// A parameter shares a flat direction with another where its part of it is at least this.
const SHARES: f64 = 0.2;

/// Another parameter that would make up for one.
#[derive(Clone, Debug)]
pub struct Confusion {
    /// The key.
    pub path: &'static str,
    /// How far its u goes for a change of 1 of the other.
    pub part: f64,
}

/// The errors of the parameters of a fit, in u.
#[derive(Clone, Debug)]
pub struct Uncertainty {
    covariance: DMatrix<f64>,
    /// The direction that the data determine least.
    flattest: DVector<f64>,
    /// Whether residuals are correlated.
    pub robust: bool,
}

impl Uncertainty {
    pub(super) fn of(model: &Model<'_>, minimum: &Minimum) -> Uncertainty {
        let blocks = model.blocks();
        let rows = blocks.last().map_or(0, |block| block.rows.end);
        let jacobian = minimum.jacobian.rows(0, rows).into_owned();
        let residuals = minimum.residuals.rows(0, rows).into_owned();
        let eigen = SymmetricEigen::new(jacobian.tr_mul(&jacobian));
        let inverse = inverse(&eigen);
        let fits = model.channel_fits(&minimum.residuals);
        let correlated =
            |samples: usize, correlation: f64| correlation.abs() * (samples as f64).sqrt() > CORRELATED;
        let robust = fits.iter().flatten().any(|fit| correlated(fit.samples, fit.correlation));
        let covariance = if robust {
            let zero = DMatrix::zeros(inverse.nrows(), inverse.nrows());
            let meat = blocks.iter().fold(zero, |sum, block| {
                let rows = (block.rows.start, block.rows.len());
                sum + newey_west(
                    &jacobian.rows(rows.0, rows.1).into_owned(),
                    &residuals.rows(rows.0, rows.1).into_owned(),
                )
            });
            &inverse * meat * &inverse
        } else {
            inverse
        };
        let n = model.parameters.len();
        let flattest = eigen.eigenvectors.column(eigen.eigenvalues.imin()).rows(0, n).into_owned();
        Uncertainty { covariance: covariance.view((0, 0), (n, n)).into_owned(), flattest, robust }
    }

    /// Of a parameter, in u.
    #[must_use]
    pub fn standard_error(&self, i: usize) -> f64 {
        self.covariance[(i, i)].max(0.0).sqrt()
    }

    /// The parameter with the largest standard error above `limit`.
    #[must_use]
    pub fn worst(&self, limit: f64) -> Option<usize> {
        let beyond = (0..self.covariance.nrows()).filter(|&i| self.standard_error(i) > limit);
        beyond.max_by(|&a, &b| self.standard_error(a).total_cmp(&self.standard_error(b)))
    }

    /// What is to be said of a parameter that is not seen.
    pub(super) fn unseen(&self, parameters: &[Parameter], i: usize) -> Unseen {
        let own = self.flattest[i];
        let others = parameters.iter().zip(self.flattest.iter()).enumerate();
        let confused = others.filter(|&(j, (_, part))| j != i && (part / own).abs() >= SHARES);
        Unseen {
            parameter: parameters[i].clone(),
            standard_error: self.standard_error(i),
            confused_with: confused
                .map(|(_, (parameter, part))| Confusion { path: parameter.key.path, part: part / own })
                .collect(),
        }
    }

    /// Correlation of the errors.
    #[must_use]
    pub fn correlation(&self) -> DMatrix<f64> {
        let error = |i| self.standard_error(i);
        DMatrix::from_fn(self.covariance.nrows(), self.covariance.nrows(), |i, j| {
            self.covariance[(i, j)] / (error(i) * error(j))
        })
    }
}

fn inverse(eigen: &SymmetricEigen<f64, nalgebra::Dyn>) -> DMatrix<f64> {
    let scaled = eigen.eigenvalues.map(|value| 1.0 / value.max(FLAT));
    &eigen.eigenvectors * DMatrix::from_diagonal(&scaled) * eigen.eigenvectors.transpose()
}

/// S of one channel.
fn newey_west(jacobian: &DMatrix<f64>, residuals: &DVector<f64>) -> DMatrix<f64> {
    let n = residuals.len();
    let reach = (n as f64).sqrt() as usize;
    let scores: Vec<DVector<f64>> = (0..n).map(|t| jacobian.row(t).transpose() * residuals[t]).collect();
    let mut sum = DMatrix::zeros(jacobian.ncols(), jacobian.ncols());
    for t in 0..n {
        let mut weighted = scores[t].clone();
        for l in 1..=reach.min(n - 1 - t) {
            let weight = 2.0 * (1.0 - l as f64 / (reach + 1) as f64);
            weighted.axpy(weight, &scores[t + l], 1.0);
        }
        sum += &scores[t] * weighted.transpose();
    }
    0.5 * (&sum + sum.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_residuals_give_the_plain_covariance_and_correlated_ones_a_larger_one() {
        // Even numbers from a fixed sequence, and the same held for eight samples each.
        let mut seed = 1u64;
        let mut draw = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 12f64.sqrt()
        };
        let n = 1 << 16;
        let white = DVector::from_fn(n, |_, _| draw());
        let held = DVector::from_fn(n, |i, _| white[i / 8]);
        let jacobian = DMatrix::from_element(n, 1, 1.0);
        let plain = n as f64;
        let [white, held] = [white, held].map(|residuals| newey_west(&jacobian, &residuals)[(0, 0)] / plain);
        assert!((white - 1.0).abs() < 0.3, "{white}");
        assert!(held > 4.0, "{held}");
    }
}
