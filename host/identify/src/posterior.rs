//! The uncertainty of the parameters from the data and the assumptions.
//!
//! ```text
//! C = (J' J + L)^-1                      L: the inverse variances of the priors
//! V = C S C + C L C                      covariance of the errors
//! S = J' J, each band of the spectrum weighted by its noise ([`super::spectrum`])
//! ```
//!
//! The first part of V is the effect of noise on the estimates, the second that of the priors: how far a value may deviate
//! from the file's without an effect on the data. It has a term for each unknown; where it is the larger part, the
//! parameter rests on assumptions, and the terms show which. Some unknowns are never fitted but may be wrong, too:
//! they are assumed (`assumed.rs`), so they are in V, as in the consider filter of orbit determination
//! (Schmidt 1966). Where that is small, V is that of plain least squares.
//!
//! ```text
//! sqrt((C J' J C)_ii) |d|                how far a model error d can move i: the bound of Cauchy and Schwarz
//! V_ii - V_iK (V_KK)^-1 V_Ki             the variance that is left of i once the values K are known
//! V_iK (V_KK)^-1                         by how much it changes with them
//! ```

use nalgebra::{DMatrix, DVector};

/// Half of a 95 % interval of the normal distribution, standard deviations.
pub(crate) const NORMAL_95: f64 = 1.959_963_984_540_054;

/// A parameter rests on the priors where they make more than this part of its variance.
pub const RESTS: f64 = 0.5;

/// A prior is reported if it contributes this part of a variance.
const PRIOR_SHARE: f64 = 0.1;

/// Most values that a parameter is said to depend on.
const MAX_LISTED: usize = 3;

/// Knowing one more value is worth telling of where it takes this part of the variance that was left.
const HELPS: f64 = 0.75;

/// Of values whose knowledge leaves less than so many times the least variance, the one that the data show least is told.
const AS_GOOD: f64 = 16.0;

/// The errors of the unknowns of a fit, in u.
#[derive(Clone, Debug)]
pub struct Posterior {
    covariance: DMatrix<f64>,
    /// C L: the entry (i, j) times C_ij is the part of the variance of i that the prior of j makes.
    by_prior: DMatrix<f64>,
    /// C.
    inverse: DMatrix<f64>,
    /// Prior standard deviations.
    priors: DVector<f64>,
}

/// What would make a parameter better known.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Places of the unknowns that would have to be known.
    pub unknowns: Vec<usize>,
    /// How much the parameter changes with each, u per u.
    pub slopes: Vec<f64>,
    /// Standard error that is left, in u.
    pub standard_error: f64,
}

/// (J' J + L)^-1; None where the numbers are too far apart.
pub(super) fn inverse(information: &DMatrix<f64>, priors: &DVector<f64>) -> Option<DMatrix<f64>> {
    // With the priors as units the matrix is 1 at least on its diagonal.
    let scaled = DMatrix::from_fn(priors.len(), priors.len(), |i, j| {
        priors[i] * information[(i, j)] * priors[j] + f64::from(u8::from(i == j))
    });
    let inverse = scaled.cholesky()?.inverse();
    Some(DMatrix::from_fn(priors.len(), priors.len(), |i, j| priors[i] * inverse[(i, j)] * priors[j]))
}

impl Posterior {
    /// From C, S and the priors' standard deviations.
    #[must_use]
    pub fn new(inverse: DMatrix<f64>, weighted: &DMatrix<f64>, priors: DVector<f64>) -> Posterior {
        let by_prior =
            DMatrix::from_fn(priors.len(), priors.len(), |i, j| inverse[(i, j)] / priors[j].powi(2));
        let covariance = &inverse * weighted * &inverse + &by_prior * inverse.transpose();
        Posterior { covariance: 0.5 * (&covariance + covariance.transpose()), by_prior, inverse, priors }
    }

    /// Standard error of an unknown, in u.
    #[must_use]
    pub fn standard_error(&self, i: usize) -> f64 {
        self.covariance[(i, i)].max(0.0).sqrt()
    }

    /// How far residuals of a norm can move an unknown, in u: C J' d is largest where d has the direction of what the
    /// unknown does to the data.
    #[must_use]
    pub(crate) fn max_shift(&self, i: usize, norm: f64) -> f64 {
        let by_priors: f64 =
            (0..self.priors.len()).map(|j| self.by_prior[(i, j)] * self.inverse[(i, j)]).sum();
        (self.inverse[(i, i)] - by_priors).max(0.0).sqrt() * norm
    }

    /// Standard error of an unknown over that before there were data.
    #[must_use]
    pub fn over_prior(&self, i: usize) -> f64 {
        self.standard_error(i) / self.priors[i]
    }

    /// The part of the variance of `i` that the priors make.
    #[must_use]
    pub(crate) fn part_of_priors(&self, i: usize) -> f64 {
        (0..self.priors.len()).map(|j| self.part_of_prior(i, j)).sum()
    }

    fn part_of_prior(&self, i: usize, j: usize) -> f64 {
        self.by_prior[(i, j)] * self.inverse[(i, j)] / self.covariance[(i, i)]
    }

    /// The unknowns among `these` whose priors make a good part of the variance of `i`, the largest part first, each
    /// with its part.
    #[must_use]
    pub fn rests_on(&self, i: usize, these: std::ops::Range<usize>) -> Vec<(usize, f64)> {
        let parts = these.map(|j| (j, self.part_of_prior(i, j))).filter(|(_, part)| *part >= PRIOR_SHARE);
        let mut parts: Vec<_> = parts.collect();
        parts.sort_by(|a, b| b.1.total_cmp(&a.1));
        parts
    }

    /// Correlation of the errors of the first `n` unknowns.
    #[must_use]
    pub fn correlation(&self, n: usize) -> DMatrix<f64> {
        let error = |i| self.standard_error(i);
        DMatrix::from_fn(n, n, |i, j| self.covariance[(i, j)] / (error(i) * error(j)))
    }

    /// Which of `these` unknowns would have to be known, a few at most, and what that would leave of the error of `i`.
    /// None where no knowledge helps much.
    #[must_use]
    pub fn known(&self, i: usize, these: std::ops::Range<usize>) -> Option<Known> {
        let mut unknowns: Vec<usize> = Vec::new();
        let mut left = self.covariance[(i, i)];
        while unknowns.len() < MAX_LISTED {
            let with = |j: usize| [&unknowns[..], &[j]].concat();
            let others = these.clone().filter(|j| *j != i && !unknowns.contains(j));
            let tried: Vec<(usize, f64)> = others.map(|j| (j, self.given(i, &with(j)).1)).collect();
            let least = tried.iter().map(|(_, variance)| *variance).fold(f64::INFINITY, f64::min);
            let as_good = tried.into_iter().filter(|(_, variance)| *variance <= AS_GOOD * least);
            let best = as_good.max_by(|a, b| self.over_prior(a.0).total_cmp(&self.over_prior(b.0)));
            let Some((j, variance)) = best.filter(|(_, variance)| *variance < (1.0 - HELPS) * left) else {
                break;
            };
            unknowns.push(j);
            left = variance;
        }
        let (slopes, variance) = self.given(i, &unknowns);
        let standard_error = variance.max(0.0).sqrt();
        (!unknowns.is_empty()).then_some(Known { unknowns, slopes, standard_error })
    }

    /// The slopes of `i` over known unknowns, and the variance that these leave of it.
    fn given(&self, i: usize, known: &[usize]) -> (Vec<f64>, f64) {
        let among = DMatrix::from_fn(known.len(), known.len(), |a, b| self.covariance[(known[a], known[b])]);
        let with = DVector::from_fn(known.len(), |a, _| self.covariance[(known[a], i)]);
        let Some(slopes) = among.cholesky().map(|cholesky| cholesky.solve(&with)) else {
            return (vec![0.0; known.len()], self.covariance[(i, i)]);
        };
        let variance = self.covariance[(i, i)] - slopes.dot(&with);
        (slopes.as_slice().to_vec(), variance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of unknowns with a prior of 1 each, from the rows of J with white noise of 1.
    fn posterior(rows: &[&[f64]]) -> Posterior {
        let jacobian = DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j]);
        let information = jacobian.tr_mul(&jacobian);
        let priors = DVector::from_element(rows[0].len(), 1.0);
        Posterior::new(inverse(&information, &priors).expect("positive"), &information, priors)
    }

    #[test]
    fn what_the_data_show_has_the_error_of_least_squares() {
        let posterior = posterior(&[&[1e3, 0.0], &[0.0, 1e3]]);
        assert!((posterior.standard_error(0) - 1e-3).abs() < 1e-8);
        assert!(posterior.part_of_priors(0) < 1e-5);
        assert!(posterior.rests_on(0, 0..2).is_empty());
    }

    #[test]
    fn what_no_sample_depends_on_keeps_its_prior() {
        let posterior = posterior(&[&[1e3, 0.0]]);
        assert_eq!(posterior.over_prior(1), 1.0);
        assert!((posterior.part_of_priors(1) - 1.0).abs() < 1e-12);
    }

    /// Of two that only act together each is as well known as the priors say of their difference, 1 / sqrt(2), and once
    /// one is known, so is the other.
    #[test]
    fn members_of_a_sum_rest_on_one_another() {
        let posterior = posterior(&[&[1e3, 1e3]]);
        assert!((posterior.standard_error(0) - 0.5f64.sqrt()).abs() < 1e-3);
        let parts = posterior.rests_on(0, 0..2);
        assert!(parts.len() == 2 && (parts[0].1 - 0.5).abs() < 1e-3, "{parts:?}");
        let known = posterior.known(0, 0..2).expect("the other one");
        assert_eq!(known.unknowns, [1]);
        assert!(
            (known.slopes[0] + 1.0).abs() < 1e-3 && (known.standard_error - 1e-3).abs() < 1e-5,
            "{known:?}"
        );
    }

    /// A misfit in the very direction of the first unknown moves it by as much as the reach says, any other by less.
    #[test]
    fn no_model_error_moves_an_estimate_beyond_its_reach() {
        let jacobian = DMatrix::from_row_slice(4, 2, &[3.0, 1.0, 0.5, 2.0, 0.0, 1.0, 1.0, 0.2]);
        let information = jacobian.tr_mul(&jacobian);
        let priors = DVector::from_row_slice(&[1.0, 0.5]);
        let inverse = inverse(&information, &priors).expect("positive");
        let posterior = Posterior::new(inverse.clone(), &information, priors);
        let to_first = (&inverse * jacobian.transpose()).row(0).transpose();
        let worst = 2.0 * &to_first / to_first.norm();
        let moved = |error: &DVector<f64>| (&inverse * jacobian.tr_mul(error))[0];
        assert!((moved(&worst) - posterior.max_shift(0, 2.0)).abs() < 1e-12);
        let other = DVector::from_row_slice(&[1.0, -1.0, 1.0, 1.0]);
        assert!(moved(&other).abs() < posterior.max_shift(0, other.norm()));
    }

    #[test]
    fn louder_noise_widens_the_error_by_its_root() {
        let information = DMatrix::from_diagonal_element(2, 2, 1e6);
        let priors = DVector::from_element(2, 1.0);
        let inverse = inverse(&information, &priors).expect("positive");
        let posterior = Posterior::new(inverse, &(4.0 * &information), priors);
        assert!((posterior.standard_error(0) - 2e-3).abs() < 1e-8);
    }
}
