//! Assumptions of a fit: values that are not fitted, but may be wrong nevertheless.
//!
//! They are unknowns of the posterior but not of the search: the estimates hold for the file's values, and the intervals
//! allow for their uncertainty.

use pneudrive_sim::keys;
use std::ops::Range;

use anyhow::{Result, anyhow};
use nalgebra::{DMatrix, DVector};

use super::found::Found;
use super::level::{self, Incline, LEVELLING_ERROR_DEG};
use super::model::FittedModel;
use super::parameter::Parameter;
use super::posterior::{NORMAL_95, Posterior, RESTS, inverse};
use super::spectrum::Transform;
use super::{ConditionalEstimate, Estimate, Share, Unidentifiable};

/// The key, and its standard deviation in its unit.
const ASSUMED: [(&str, f64); 1] = [
    // A drive that somebody has levelled. Its weight acts as friction that is stronger one way: no test tells them apart.
    (keys::load::INCLINE_DEG.key.path, LEVELLING_ERROR_DEG),
];

/// Keys that do what others do, so that a fit of one takes the other for known.
const SAME: [(&str, &str); 1] = [(keys::load::CONSTANT_FORCE_N.key.path, keys::load::INCLINE_DEG.key.path)];

/// The posterior of the parameters of a model, then of what is assumed, then of the initial states.
pub(super) struct Considered {
    /// The posterior.
    pub of: Posterior,
    /// What is assumed.
    pub assumed: Vec<Parameter>,
    /// The incline that would explain how friction differs from the file's.
    pub incline: Option<Incline>,
}

/// What is assumed in a fit of some parameters.
fn assumed(model: &FittedModel) -> Vec<Parameter> {
    let fitted = |path: &str| model.parameters.iter().any(|parameter| parameter.key.path == path);
    let known = |path: &str| fitted(path) || SAME.iter().any(|(a, b)| *b == path && fitted(a));
    let free = ASSUMED.iter().filter(|(path, _)| !known(path));
    free.filter_map(|(path, size)| Some(Parameter::of(&model.rig, path).ok()?.within(*size))).collect()
}

/// The posterior at a minimum.
pub(super) fn posterior(model: &FittedModel, found: &Found) -> Result<Considered> {
    let assumed = assumed(model);
    let priors = priors(model, &assumed);
    let cannot = || {
        anyhow!(
            "the sensitivities of the model to its parameters differ too much in size to be used together"
        )
    };
    let wider = model.with(&assumed);
    let mut u = found.minimum.u.clone();
    u.splice(model.parameters.len()..model.parameters.len(), vec![0.0; assumed.len()]);
    let at = Point { u, residuals: found.minimum.residuals.rows(0, found.rows()).into_owned() };
    let jacobian = jacobian(&wider, &at);
    let transform = Transform::of(&model.blocks(), &at.residuals, &jacobian);
    let inverse = inverse(&jacobian.tr_mul(&jacobian), &priors).ok_or_else(cannot)?;
    let of = Posterior::new(inverse, &transform.weighted(&found.moving), priors);
    Ok(Considered { of, assumed, incline: level::suggested(model, &found.minimum.u) })
}

/// A point, and the residuals of the data there.
struct Point {
    u: Vec<f64>,
    residuals: DVector<f64>,
}

/// Prior standard deviations in the order of the posterior.
fn priors(model: &FittedModel, assumed: &[Parameter]) -> DVector<f64> {
    let fitted = model.parameters.iter().chain(assumed).map(|parameter| parameter.prior);
    let starts = (model.parameters.len()..model.unknowns()).map(|i| model.prior(i));
    let all: Vec<f64> = fitted.chain(starts).collect();
    DVector::from_vec(all)
}

/// The derivatives of the data at a point; none of samples that have none. A handful of these, each beside a jump, would
/// feign that the data show combinations of unknowns that change nothing.
fn jacobian(model: &FittedModel, at: &Point) -> DMatrix<f64> {
    let mut jacobian = DMatrix::zeros(at.residuals.len(), at.u.len());
    let columns = model.columns(&at.u, &at.residuals, 0..at.u.len());
    for (i, column) in columns.iter().enumerate() {
        if let Some(column) = column {
            jacobian.view_mut((column.first, i), (column.rows.len(), 1)).copy_from(&column.rows);
        }
    }
    for &row in columns.iter().flatten().flat_map(|column| &column.bent) {
        jacobian.row_mut(row).fill(0.0);
    }
    jacobian
}

impl Considered {
    /// Indices of the parameters and of the assumed values.
    fn named(&self, model: &FittedModel) -> Range<usize> {
        0..model.parameters.len() + self.assumed.len()
    }

    fn parameter<'a>(&'a self, model: &'a FittedModel, i: usize) -> &'a Parameter {
        let n = model.parameters.len();
        if i < n { &model.parameters[i] } else { &self.assumed[i - n] }
    }

    fn shares(&self, model: &FittedModel, i: usize) -> Vec<Share> {
        let parts = self.of.rests_on(i, self.named(model)).into_iter();
        parts.map(|(j, part)| Share { path: self.parameter(model, j).key.path, part }).collect()
    }

    /// What is to be said of parameter `i` of a fit that ended at `u` and left residuals of the norm `misfit` beyond
    /// noise.
    pub fn estimate(&self, model: &FittedModel, u: &[f64], i: usize, misfit: f64) -> Estimate {
        let parameter = &model.parameters[i];
        let error = self.of.standard_error(i);
        let assumed = self.of.part_of_priors(i);
        let rests = assumed > RESTS;
        let moved = self.of.max_shift(i, misfit);
        let half_width = NORMAL_95 * error + moved;
        Estimate {
            value: parameter.value(u[i]),
            standard_error: error * parameter.slope(u[i]),
            interval: self
                .on_the_level(parameter, [u[i] - half_width, u[i] + half_width].map(|u| parameter.value(u))),
            assumed,
            rests_on: if rests { self.shares(model, i) } else { Vec::new() },
            conditional: if rests && misfit == 0.0 { self.conditional(model, u, i) } else { None },
            by_misfit: moved * parameter.slope(u[i]),
            parameter: parameter.clone(),
        }
    }

    /// An interval of friction, so wide that it holds what it is if an incline makes what is suspected of it.
    fn on_the_level(&self, parameter: &Parameter, [low, high]: [f64; 2]) -> [f64; 2] {
        let force = self.incline.and_then(|incline| incline.takes_from(parameter.key.path));
        let Some([less, more]) = force else { return [low, high] };
        [(low - more.max(0.0)).max(0.0), high - less.min(0.0)]
    }

    /// What parameter `i` is once others are known.
    fn conditional(&self, model: &FittedModel, u: &[f64], i: usize) -> Option<ConditionalEstimate> {
        let known = self.of.known(i, self.named(model))?;
        let (parameter, half_width) = (&model.parameters[i], NORMAL_95 * known.standard_error);
        let slope = parameter.slope(u[i]);
        let by = known.unknowns.iter().zip(&known.slopes).map(|(&j, by)| {
            let other = self.parameter(model, j);
            let at = if j < model.parameters.len() { u[j] } else { 0.0 };
            (other.key.path, by * slope / other.slope(at))
        });
        Some(ConditionalEstimate {
            known: by.collect(),
            standard_error: known.standard_error * slope,
            interval: [parameter.value(u[i] - half_width), parameter.value(u[i] + half_width)],
        })
    }

    /// What is to be said of a parameter that is not seen.
    pub fn unidentifiable(&self, model: &FittedModel, u: &[f64], i: usize) -> Unidentifiable {
        let parameter = model.parameters[i].clone();
        let mut confused_with = self.shares(model, i);
        confused_with.retain(|share| share.path != parameter.key.path);
        Unidentifiable {
            value: parameter.value(u[i]),
            over_prior: self.of.over_prior(i),
            confused_with,
            parameter,
        }
    }
}
