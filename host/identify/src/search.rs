//! The search for the minimum of a fit: in stages, from other points if it ends in a wrong minimum, and with the noise
//! that the residuals show.

use anyhow::{Result, anyhow};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use pneudrive_sim::rig::unit_interval;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::approach::approach;
use super::calibration;
use super::causes::{self, Causes, Traces};
use super::found::{Found, found_at, refined};
use super::least_squares::{Minimum, minimise};
use super::model::{FittedModel, first_noise};

/// Number of times that a search is restarted.
const RESTARTS: usize = 2;

/// How far from a point another search begins, in u of one parameter.
const SCAN: [f64; 8] = [-0.2, -0.12, -0.07, -0.03, 0.03, 0.07, 0.12, 0.2];

/// The noise is looked at anew so often at most, and until it changes by less than this part.
const ROUNDS: usize = 4;
const SAME_NOISE: f64 = 0.03;

/// Number of times that a search looks beyond the jumps around its minimum, the number of points it tries, and how far away
/// they are in standard errors.
const LOOKS: usize = 3;
const POINTS: usize = 36;
const AWAY: [f64; 3] = [1.0, 2.0, 4.0];

/// There is a jump where a point's sum of squares is by so much below what the derivatives promise.
const BELOW: f64 = 25.0;

/// Why the model cannot follow the recordings at a point.
pub(super) fn cannot_follow(model: &FittedModel, u: &[f64]) -> anyhow::Error {
    let reason = model.failure(u).unwrap_or_else(|| anyhow!("it has no derivatives there"));
    reason.context(format!("the model of {} cannot follow the commands of the transients", model.rig.name()))
}

/// Where a search ended.
pub(super) struct Termination {
    /// The best minimum that was found.
    pub found: Found,
    /// The effects that explain its residuals, if they have been searched for.
    pub causes: Option<Causes>,
    /// Those of the first minimum, where they leave more than noise.
    pub of_first: Causes,
}

/// From `start` to a minimum that leaves noise alone, or noise and an effect that the rig file lacks; from other points
/// where it is another one.
pub(super) fn search(
    model: &mut FittedModel,
    start: Vec<f64>,
    progress: &mut dyn FnMut(&str),
) -> Result<Termination> {
    let start = calibration::freed(model, start);
    let near = approach(model, start.clone(), progress);
    model.fine = true;
    let mut first = found(model, &near, progress)?;
    model.budget.go_on();
    let mut of_first = Causes::default();
    if first.spectrum.is_more_than_noise() {
        of_first = causes::explain(model, &first, &Traces::of(model, &first), progress);
        if let Some(u) = of_first.not_come_to.take() {
            model.budget.finish();
            first = found(model, &u, progress)?;
        } else if of_first.explain_to_noise() {
            return Ok(Termination { found: first, causes: Some(of_first), of_first: Causes::default() });
        }
    }
    let best = settled(model, first, progress)?;
    Ok(Termination { found: from_elsewhere(model, best, start, progress)?, causes: None, of_first })
}

/// The best minimum of searches from other points as well, while none leaves noise alone.
fn from_elsewhere(
    model: &mut FittedModel,
    mut best: Found,
    mut from: Vec<f64>,
    progress: &mut dyn FnMut(&str),
) -> Result<Found> {
    for _ in 0..RESTARTS {
        if !best.spectrum.is_more_than_noise() || model.budget.is_spent() {
            break;
        }
        progress("that is not a fit: the search starts again at another point");
        let noise = std::mem::replace(&mut model.noise, first_noise(model.recordings));
        let near = approach(model, scanned(model, from), progress);
        model.fine = true;
        let other = found(model, &near, progress)?;
        let other = settled(model, other, progress)?;
        if spread(model, &other) < spread(model, &best) {
            best = other;
        } else {
            model.noise = noise;
        }
        from = best.minimum.u.clone();
    }
    Ok(best)
}

/// The best of the points that lie beside one along a parameter.
fn scanned(model: &FittedModel, from: Vec<f64>) -> Vec<f64> {
    let mut best = (model.mean_square(&from), from.clone());
    let of_the_rig = |i: &usize| !model.parameters[*i].is_calibration;
    for i in (0..model.parameters.len()).filter(of_the_rig) {
        for step in SCAN {
            let mut u = from.clone();
            u[i] += step;
            let left = model.mean_square(&u);
            if left < best.0 {
                best = (left, u);
            }
        }
    }
    best.1
}

/// A minimum with the noise that its residuals show; beyond the jumps around it, if it leaves more.
fn settled(model: &mut FittedModel, first: Found, progress: &mut dyn FnMut(&str)) -> Result<Found> {
    let mut best = with_its_noise(model, first, progress)?;
    for _ in 0..LOOKS {
        if model.budget.is_spent() {
            break;
        }
        let Some(u) = beyond_a_jump(model, &best).filter(|_| best.spectrum.is_more_than_noise()) else {
            break;
        };
        progress("the sum of squares jumps near that point: the search continues there");
        let noise = model.noise;
        let other = found(model, &u, progress)?;
        let other = with_its_noise(model, other, progress)?;
        if spread(model, &other) >= spread(model, &best) {
            model.noise = noise;
            break;
        }
        best = other;
    }
    Ok(best)
}

/// n ln(rms) over the channels, which compares two fits independently of their weights.
fn spread(model: &FittedModel, found: &Found) -> f64 {
    let fits = model.channel_fits(&found.minimum.residuals);
    fits.iter().flatten().map(|fit| fit.samples as f64 * fit.after.ln()).sum()
}

/// The point around a minimum whose sum of squares is farthest below what the derivatives promise, if there is one.
fn beyond_a_jump(model: &FittedModel, found: &Found) -> Option<Vec<f64>> {
    let Minimum { u, residuals, jacobian, .. } = &found.minimum;
    let eigen = SymmetricEigen::new(found.by_noise.clone());
    let root =
        &eigen.eigenvectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0).sqrt()));
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let limits = model.limits();
    let below = |away: f64| {
        let step = &root * DVector::from_fn(u.len(), |_, _| away * normal(&mut random));
        let point: Vec<f64> = u.iter().zip(&step).map(|(u, step)| u + step).collect();
        let inside = limits.iter().all(|limit| limit.room(&point) >= 0.0);
        let left = inside.then(|| model.residuals_at(&point)).flatten()?;
        Some(((residuals + jacobian * step).norm_squared() - left.norm_squared(), point))
    };
    let points = AWAY.into_iter().cycle().take(POINTS).filter_map(below);
    let (most, point) = points.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (most > BELOW).then_some(point)
}

/// A normal draw (Box and Muller).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (radius, angle) = (1.0 - unit_interval(random), unit_interval(random));
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
}

/// From a minimum to that with the noise that the residuals there show.
fn with_its_noise(
    model: &mut FittedModel,
    mut found: Found,
    progress: &mut dyn FnMut(&str),
) -> Result<Found> {
    for _ in 1..ROUNDS {
        let shown = found.moving.noise.map(|noise| noise.unwrap_or(1.0));
        if shown.iter().all(|noise| (noise - 1.0).abs() < SAME_NOISE) {
            break;
        }
        for (noise, shown) in model.noise.iter_mut().zip(shown) {
            *noise *= shown;
        }
        found = self::found(model, &found.minimum.u, progress)?;
    }
    Ok(found)
}

fn found(model: &FittedModel, u: &[f64], progress: &mut dyn FnMut(&str)) -> Result<Found> {
    let minimum = minimise(model, u, true, progress).ok_or_else(|| cannot_follow(model, u))?;
    refined(model, found_at(model, minimum)?)
}
