//! The significance of an effect against noise.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::super::found::Found;
use super::super::model::FittedModel;

/// Variance of the residuals along one direction, and the number of independent residuals behind it.
pub(super) fn noise(model: &FittedModel, found: &Found) -> (f64, f64) {
    let residuals = &found.minimum.residuals;
    let (mut squares, mut products) = (0.0, 0.0);
    for block in model.blocks() {
        let of = &residuals.as_slice()[block.rows];
        squares += of.iter().map(|r| r * r).sum::<f64>();
        products += of.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>();
    }
    let rho = (products / squares).clamp(0.0, 0.999);
    let worth = (1.0 + rho) / (1.0 - rho);
    let freedom = found.rows().saturating_sub(model.unknowns()).max(1) as f64;
    (worth * squares / freedom, freedom / worth)
}

/// How often F is above `ratio` by chance.
pub(super) fn chance(ratio: f64, freedom: f64) -> f64 {
    match FisherSnedecor::new(1.0, freedom.max(1.0)) {
        Ok(f) if ratio > 0.0 && ratio.is_finite() => f.sf(ratio),
        _ => 1.0,
    }
}
