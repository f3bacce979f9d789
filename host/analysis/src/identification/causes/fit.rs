//! An effect that a rig file lacks, fitted beside all parameters.

use super::super::found::{Found, found_at, refined};
use super::super::least_squares::{Minimum, Problem, minimise, minimise_by_secants};
use super::super::level;
use super::super::model::Model;
use super::super::parameter::Parameter;
use super::super::posterior::NORMAL_95;
use super::significance::{chance, noise};
use super::{Change, Effect, Explanation, Trial};

/// Parts of the size that an effect should have by its linear promise, at which its fit may begin.
const PARTS: [f64; 4] = [1.0, 0.5, 0.2, 0.05];

/// An effect fitted beside all parameters.
pub(super) struct Fit<'a> {
    /// The effect.
    pub effect: Effect,
    with: Model<'a>,
    found: Found,
    /// Whether the search has been completed with its own derivatives.
    pub is_finished: bool,
    /// Value and standard error of an incline from friction; transients do not show it.
    by_friction: Option<(f64, f64)>,
}

impl<'a> Fit<'a> {
    /// From the minimum without the effect, with the derivatives there.
    pub fn by_secants(model: &Model<'a>, without: &Found, trial: &Trial) -> Option<Fit<'a>> {
        let (mut best, mut least) = (None, f64::INFINITY);
        for part in PARTS {
            let Some(started) = start(model, without, trial, part * trial.part) else { continue };
            let cost = started.1.residuals.norm_squared();
            if cost < least {
                (best, least) = (Some(started), cost);
            }
            if least < without.minimum.residuals.norm_squared() {
                break;
            }
        }
        let (with, start) = best?;
        let found = found_at(&with, minimise_by_secants(&with, start)).ok()?;
        let by_friction = by_friction(trial.effect, model, &without.minimum.u);
        Some(Fit { effect: trial.effect, with, found, is_finished: false, by_friction })
    }

    /// Goes on to the end: by secants again, from derivatives of its own, and if that leaves more than noise, with
    /// derivatives at each step.
    pub fn finish(&mut self, progress: &mut dyn FnMut(&str)) {
        self.is_finished = true;
        let here = self.found.minimum.clone();
        let jacobian = self.with.jacobian(&here.u, &here.residuals);
        let near = jacobian.map(|jacobian| Minimum { jacobian, converged: false, ..here });
        self.go_to(near.map(|near| minimise_by_secants(&self.with, near)));
        if !self.leaves_noise() || !self.found.minimum.converged {
            self.go_to(minimise(&self.with, &self.found.minimum.u, true, progress));
        }
    }

    fn go_to(&mut self, minimum: Option<Minimum>) {
        if let Some(found) =
            minimum.and_then(|minimum| refined(&self.with, found_at(&self.with, minimum).ok()?).ok())
        {
            self.found = found;
        }
    }

    pub fn cost(&self) -> f64 {
        self.found.minimum.residuals.norm_squared()
    }

    pub fn leaves_noise(&self) -> bool {
        !self.found.spectrum.is_more_than_noise()
    }

    /// The value of the effect, in the unit of its key, if it is a number, and its standard error.
    fn value(&self) -> Option<(f64, f64)> {
        let Change::Number { .. } = self.effect.change else { return None };
        if self.by_friction.is_some() {
            return self.by_friction;
        }
        let place = self.with.parameters.len() - 1;
        let parameter = &self.with.parameters[place];
        let error = self.found.error(&self.with, place) * parameter.slope(0.0);
        Some((parameter.value(self.found.minimum.u[place]), error))
    }

    pub fn explanation(&self, without: &Found, (tried, misfit): (usize, f64)) -> Explanation {
        let gained = without.minimum.residuals.norm_squared() - self.cost();
        let (variance, freedom) = noise(&self.with, &self.found);
        let ratio = gained / variance;
        let left = self.found.spectrum.misfit();
        let explained = if left > 0.0 { 1.0 - (left / misfit).powi(2) } else { gained / misfit.powi(2) };
        let value = self.value();
        Explanation {
            setting: self.effect.setting(&self.with.rig, value.map(|(value, _)| value)),
            effect: self.effect,
            value: value.filter(|_| self.is_finished),
            explained: explained.clamp(0.0, 1.0),
            chance: (chance(ratio, freedom) * tried as f64).min(1.0),
            leaves_noise: self.leaves_noise(),
            as_good_as_best: false,
            ratio,
            freedom,
        }
    }
}

/// The model with a part of the usual size of an effect, and where its search begins: at the minimum without it.
fn start<'a>(model: &Model<'a>, found: &Found, trial: &Trial, part: f64) -> Option<(Model<'a>, Minimum)> {
    let mut with = model.of_rig(trial.effect.rig(model, part)?);
    let Minimum { mut u, jacobian, .. } = found.minimum.clone();
    let Change::Number { path, size, least, .. } = trial.effect.change else {
        let residuals = with.residuals_at(&u)?;
        return Some((with, Minimum { u, residuals, jacobian, converged: false }));
    };
    let place = model.parameters.len();
    with = with.with(&[Parameter::by_difference(&with.rig, path, size, least)?]);
    u.insert(place, 0.0);
    let residuals = with.residuals_at(&u)?;
    let column = with.columns(&u, &residuals, place..place + 1).pop()??;
    // The row of its own term comes where its column does.
    let mut jacobian = jacobian.insert_row(found.rows() + place, 0.0).insert_column(place, 0.0);
    jacobian.view_mut((column.first, place), (column.rows.len(), 1)).copy_from(&column.rows);
    jacobian[(found.rows() + place, place)] = 1.0 / with.prior(place);
    Some((with, Minimum { u, residuals, jacobian, converged: false }))
}

/// What friction tells of the size of an effect, and its standard error, if it is an incline.
fn by_friction(effect: Effect, model: &Model, u: &[f64]) -> Option<(f64, f64)> {
    let Change::Number { path: "load.incline_deg", .. } = effect.change else { return None };
    let incline = level::suggested(model, u)?;
    Some((incline.degrees, 0.5 * (incline.interval[1] - incline.interval[0]) / NORMAL_95))
}
