//! A minimum of a fit, and what its residuals are: as they were sampled, and without the rounding that the model knows
//! ([`super::rounding`]).

use anyhow::{Result, anyhow};
use nalgebra::{DMatrix, DVector};

use super::least_squares::Minimum;
use super::limits::step_within;
use super::model::{FittedModel, noise_at_rest, rest};
use super::posterior::inverse;
use super::recording::CHANNELS;
use super::rounding::{Whitened, judged};
use super::spectrum::{AtRest, Spectrum, Transform, at_rest};

/// Steps without rounding at most, and the least part of the sum of squares that one gains.
const STEPS: usize = 15;
const GAIN: f64 = 1e-3;

/// A minimum, and what its residuals are.
pub(super) struct Found {
    /// The minimum.
    pub minimum: Minimum,
    /// What remains, by frequency, without the rounding that the model knows.
    pub spectrum: Spectrum,
    /// The same with all rounding: what moves the estimates.
    pub moving: Spectrum,
    /// The residuals of `spectrum`.
    pub judged: Whitened,
    /// Covariance of the errors that noise makes.
    pub by_noise: DMatrix<f64>,
    /// (J' J + L)^-1, with L the inverse variances of the priors.
    inverse: DMatrix<f64>,
}

impl Found {
    /// Standard error of what changes with the unknowns of `model` by these slopes, of noise as correlated as the residuals
    /// are and of the priors.
    pub fn error(&self, model: &FittedModel, slopes: &DVector<f64>) -> f64 {
        let by_unknowns = &self.inverse * slopes;
        let of_prior = |i: usize| (by_unknowns[i] / model.prior(i)).powi(2);
        let by_priors: f64 = (0..slopes.len()).map(of_prior).sum();
        (slopes.dot(&(&self.by_noise * slopes)) + by_priors).max(0.0).sqrt()
    }

    /// Residuals of the data; those of the priors come after them.
    pub fn rows(&self) -> usize {
        self.minimum.residuals.len() - self.minimum.u.len()
    }
}

/// A minimum, and what its residuals are.
///
/// # Errors
/// When the sensitivities are too far apart.
pub(super) fn found_at(model: &FittedModel, minimum: Minimum) -> Result<Found> {
    let blocks = model.blocks();
    let rows = blocks.last().map_or(0, |block| block.rows.end);
    let jacobian = minimum.jacobian.rows(0, rows).into_owned();
    let priors = DVector::from_fn(minimum.u.len(), |i, _| model.prior(i));
    let covariance = inverse(&jacobian.tr_mul(&jacobian), &priors).ok_or_else(|| {
        anyhow!(
            "the sensitivities of the model to its parameters differ too much in size to be used together"
        )
    })?;
    let transform = Transform::of(&blocks, &minimum.residuals, &jacobian);
    let moving = transform.spectrum(&covariance, rests(model));
    let by_noise = &covariance * transform.weighted(&moving) * &covariance;
    let judged = judged(model, &minimum.residuals);
    if !judged.rounded.contains(&true) {
        let spectrum = moving.clone();
        return Ok(Found { minimum, spectrum, moving, judged, by_noise, inverse: covariance });
    }
    let spectrum = Transform::of(&blocks, &judged.residuals, &jacobian).spectrum(&covariance, rests(model));
    Ok(Found { minimum, spectrum, moving, judged, by_noise, inverse: covariance })
}

fn rests(model: &FittedModel) -> [AtRest; CHANNELS.len()] {
    std::array::from_fn(|channel| {
        let noise = noise_at_rest(model.recordings, channel);
        at_rest(model.noise[channel], noise, rest(model.recordings, channel).freedom)
    })
}

/// A fit that continues without the rounding that the model predicts.
///
/// # Errors
/// When the sensitivities are too far apart.
pub(super) fn refined(model: &FittedModel, found: Found) -> Result<Found> {
    let mut best = found;
    for _ in 0..STEPS {
        if !best.judged.rounded.contains(&true) {
            break;
        }
        let Some(minimum) = step(model, &best) else { break };
        let next = found_at(model, minimum)?;
        if next.judged.residuals.norm_squared() > (1.0 - GAIN) * best.judged.residuals.norm_squared() {
            break;
        }
        best = next;
    }
    Ok(best)
}

/// Where a step without rounding leads.
fn step(model: &FittedModel, found: &Found) -> Option<Minimum> {
    let Minimum { u, jacobian, .. } = &found.minimum;
    let (normal, gradient) = (jacobian.tr_mul(jacobian), jacobian.tr_mul(&found.judged.residuals));
    let step = step_within(&normal, &gradient, &model.limits(), u)?;
    let u: Vec<f64> = u.iter().zip(&step).map(|(u, d)| u + d).collect();
    let residuals = model.residuals_at(&u)?;
    Some(Minimum { u, residuals, ..found.minimum.clone() })
}
