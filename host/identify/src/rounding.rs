//! Rounding of readings with little noise: it is then determined by the reading.
//!
//! ```text
//! round(m + noise) - m = -sum over k of (-1)^(k+1) exp(-2 (pi k s)^2) sin(2 pi k m) / (pi k)     in the mean
//! ```
//!
//! m: reading of the model, counts; s: standard deviation of the noise, counts. With noise of half a count this mean is
//! negligible, and rounding acts as noise (Widrow 1956). With less noise it depends on the signal: it varies slowly
//! and repeats as the signal does, like residuals of a wrong model, and shifts the estimates by several standard errors.
//! So if the residuals r are smaller without it, it is subtracted, giving q, and the fit continues with steps
//! -(J' J)^-1 J' q until q is no longer reduced. A model that is wrong by more than a fraction of a count cannot predict
//! it, and is fitted and judged with it.

use std::f64::consts::{PI, TAU};

use nalgebra::DVector;

use super::model::{Block, FittedModel};
use super::recording::CHANNELS;

/// Noise that is tried, counts.
const TRIED: [f64; 5] = [0.0, 0.05, 0.1, 0.2, 0.3];

/// Terms of the series.
const TERMS: i32 = 12;

/// Rounding is known where its loss makes the scatter of the residuals smaller by this part.
const KNOWN: f64 = 0.01;

/// The first channel with a converter: an encoder's samples are chosen so that their rounding is independent.
const FIRST: usize = 1;

/// Residuals without the rounding that the model knows.
#[derive(Clone, Debug)]
pub(super) struct Whitened {
    /// The residuals of all channels.
    pub residuals: DVector<f64>,
    /// The channels whose rounding is known.
    pub rounded: [bool; CHANNELS.len()],
}

/// What rounding adds to a reading of `counts` with some noise, in the mean, counts.
fn mean_error(counts: f64, noise: f64) -> f64 {
    if noise == 0.0 {
        return counts.round() - counts;
    }
    let term = |k: i32| {
        let (sign, k) = (if k % 2 == 0 { 1.0 } else { -1.0 }, f64::from(k));
        sign * (-2.0 * (PI * k * noise).powi(2)).exp() * (TAU * k * counts).sin() / (PI * k)
    };
    (1..=TERMS).map(term).sum()
}

/// The residuals of a point as they are judged.
pub(super) fn judged(model: &FittedModel, residuals: &DVector<f64>) -> Whitened {
    let mut left = residuals.clone();
    let mut rounded = [false; CHANNELS.len()];
    for (channel, rounded) in rounded.iter_mut().enumerate().skip(FIRST) {
        let scatter = |of: &DVector<f64>| scatter(model, of, channel);
        let tried = TRIED.map(|noise| without_rounding(model, residuals, channel, noise));
        let best = tried.into_iter().min_by(|a, b| scatter(a).total_cmp(&scatter(b)));
        let Some(best) = best else { continue };
        if scatter(&best) < (1.0 - KNOWN) * scatter(residuals) {
            *rounded = true;
            copy(model, channel, &best, &mut left);
        }
    }
    Whitened { residuals: left, rounded }
}

/// The residuals, those of a channel without the rounding that is known at some noise.
fn without_rounding(
    model: &FittedModel,
    residuals: &DVector<f64>,
    channel: usize,
    noise: f64,
) -> DVector<f64> {
    let mut without = residuals.clone();
    let sigma = model.noise[channel];
    for (row, measured) in model.rows_of_channel(channel) {
        let counts = measured - sigma * residuals[row];
        without[row] -= mean_error(counts, noise) / sigma;
    }
    without
}

/// Sum of squared differences of neighbours: slow residuals, as a model leaves them, are hardly in it.
fn scatter(model: &FittedModel, residuals: &DVector<f64>, channel: usize) -> f64 {
    let of_block = |block: Block| {
        let of = &residuals.as_slice()[block.rows];
        of.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>()
    };
    model.blocks().into_iter().filter(|block| block.channel == channel).map(of_block).sum()
}

fn copy(model: &FittedModel, channel: usize, from: &DVector<f64>, to: &mut DVector<f64>) {
    for block in model.blocks().into_iter().filter(|block| block.channel == channel) {
        to.as_mut_slice()[block.rows.clone()].copy_from_slice(&from.as_slice()[block.rows]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the mean over evenly spaced quantiles of the noise.
    #[test]
    fn the_mean_error_of_rounding_is_that_of_many_draws() {
        let normal = statrs::distribution::Normal::new(0.0, 1.0).expect("valid");
        let draws = 20_000;
        for noise in [0.0, 0.1, 0.2, 0.3] {
            for counts in [7.0, 7.2, 7.45, 7.7] {
                let error = |i: i32| {
                    use statrs::distribution::ContinuousCDF;
                    let quantile = normal.inverse_cdf((f64::from(i) + 0.5) / f64::from(draws));
                    (counts + noise * quantile).round() - counts
                };
                let mean = (0..draws).map(error).sum::<f64>() / f64::from(draws);
                assert!((mean_error(counts, noise) - mean).abs() < 1e-3, "{counts} {noise}: {mean}");
            }
        }
    }
}
