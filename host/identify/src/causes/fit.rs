//! An effect that a rig file lacks, fitted beside all parameters.

use nalgebra::DVector;
use pneudrive_sim::keys;

use super::super::FAR;
use super::super::approach::approach;
use super::super::found::{Found, found_at, refined};
use super::super::least_squares::{Minimum, Problem, minimise, minimise_by_secants};
use super::super::level::{self, Incline};
use super::super::model::FittedModel;
use super::super::parameter::Parameter;
use super::super::posterior::NORMAL_95;
use super::significance::{chance, noise};
use super::{Change, Effect, Explanation, Trial};

/// Parts of the size that an effect should have by its linear promise, at which its fit may begin.
const PARTS: [f64; 4] = [1.0, 0.5, 0.2, 0.05];

/// Parts of its usual size that an effect is tried in where the fit begins at the file's values.
const SIZES: [f64; 10] = [-16.0, -8.0, -4.0, -2.0, -1.0, 1.0, 2.0, 4.0, 8.0, 16.0];

/// What an effect gains is not its own if the model without it gains so much of it at the same point.
const MAX: f64 = 0.9;

/// From where the fit of an effect begins.
#[derive(Clone, Copy)]
pub(super) struct Origin<'t, 'a> {
    /// The model without the effect.
    pub model: &'t FittedModel<'a>,
    /// The minimum without it.
    pub without: &'t Found,
    /// The effect, and what it promises.
    pub trial: &'t Trial,
}

/// An effect fitted beside all parameters.
pub(super) struct Fit<'t, 'a> {
    origin: Origin<'t, 'a>,
    with: FittedModel<'a>,
    found: Found,
    /// Whether the search has been completed with its own derivatives.
    pub is_finished: bool,
}

impl<'t, 'a> Fit<'t, 'a> {
    /// From the minimum without the effect, with the derivatives there.
    pub fn by_secants(origin: Origin<'t, 'a>) -> Option<Fit<'t, 'a>> {
        let (mut best, mut least) = (None, f64::INFINITY);
        for part in PARTS {
            let Some(started) = origin.start(part * origin.trial.part) else { continue };
            let cost = started.1.residuals.norm_squared();
            if cost < least {
                (best, least) = (Some(started), cost);
            }
            if least < origin.without.minimum.residuals.norm_squared() {
                break;
            }
        }
        let (with, start) = best?;
        let found = found_at(&with, minimise_by_secants(&with, start)).ok()?;
        Some(Fit { origin, with, found, is_finished: false })
    }

    /// From the values of the file and a size with which they come near, as a fit without the effect begins: the minimum
    /// without it may lie in another valley.
    fn from_the_file(origin: Origin<'t, 'a>, progress: &mut dyn FnMut(&str)) -> Option<Fit<'t, 'a>> {
        let (mut with, u) = origin.nearest()?;
        let near = approach(&mut with, u, progress);
        with.fine = true;
        let minimum = minimise(&with, &near, true, progress)?;
        let found = refined(&with, found_at(&with, minimum).ok()?).ok()?;
        Some(Fit { origin, with, found, is_finished: true })
    }

    /// Goes on to the end: by secants again, from derivatives of its own; if that leaves more than noise, from the values of
    /// the file; and with derivatives at each step if none of these ends at a minimum.
    pub fn finish(&mut self, progress: &mut dyn FnMut(&str)) {
        progress(&format!("with {}", self.effect().name));
        self.is_finished = true;
        let here = self.found.minimum.clone();
        let jacobian = self.with.jacobian(&here.u, &here.residuals);
        let near = jacobian.map(|jacobian| Minimum { jacobian, converged: false, ..here });
        self.go_to(near.map(|near| minimise_by_secants(&self.with, near)));
        if !self.leaves_noise() && !self.is_cut() {
            progress(&format!("with {}, from the values of the file", self.effect().name));
            let anew = Fit::from_the_file(self.origin, progress);
            if let Some(anew) = anew.filter(|anew| anew.cost() < self.cost()) {
                *self = anew;
            }
        }
        if !self.found.minimum.converged {
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

    pub fn effect(&self) -> Effect {
        self.origin.trial.effect
    }

    /// Whether the search must end where it is.
    pub fn is_cut(&self) -> bool {
        self.with.budget.is_spent()
    }

    /// Whether it ended at a minimum.
    pub fn found_converged(&self) -> bool {
        self.found.minimum.converged
    }

    pub fn cost(&self) -> f64 {
        self.found.minimum.residuals.norm_squared()
    }

    pub fn leaves_noise(&self) -> bool {
        !self.found.spectrum.is_more_than_noise()
    }

    /// Where it ended, if the model without the effect gains most of it there, too, by likely errors of calibration.
    pub fn point_without_effect(&self) -> Option<Vec<f64>> {
        let Origin { model, without, .. } = self.origin;
        let mut u = self.found.minimum.u.clone();
        if let Change::Number { .. } = self.effect().change {
            u.remove(model.parameters.len());
        }
        let before = without.minimum.residuals.norm_squared();
        let gained = before - model.residuals_at(&u)?.norm_squared();
        let is_likely = self.leaves_noise() && !model.has_far_error(&u);
        (is_likely && gained > MAX * (before - self.cost())).then_some(u)
    }

    /// The value of the effect, in the unit of its key, if it is a number, and its standard error.
    fn value(&self) -> Option<(f64, f64)> {
        if let Some(incline) = self.incline() {
            return Some((incline.degrees, 0.5 * (incline.interval[1] - incline.interval[0]) / NORMAL_95));
        }
        let place = match self.effect().change {
            Change::Number { .. } => self.with.parameters.len() - 1,
            Change::Calibration(path) => self.with.place_of_error(path)?,
            _ => return None,
        };
        let parameter = &self.with.parameters[place];
        let mut slopes = DVector::zeros(self.found.minimum.u.len());
        slopes[place] = parameter.slope(0.0);
        let error = self.found.error(&self.with, &slopes);
        Some((parameter.value(self.found.minimum.u[place]), error))
    }

    /// What friction tells of the size of an incline; transients do not show it.
    fn incline(&self) -> Option<Incline> {
        match self.effect().change {
            Change::Number { path, .. } if path == keys::load::INCLINE_DEG.path => {
                level::fitted(&self.with, &self.found)
            }
            _ => None,
        }
    }

    pub fn explanation(&self, (tried, misfit): (usize, f64)) -> Explanation {
        let gained = self.origin.without.minimum.residuals.norm_squared() - self.cost();
        let (variance, freedom) = noise(&self.with, &self.found);
        let ratio = gained / variance;
        let left = self.found.spectrum.misfit();
        let explained = if left > 0.0 { 1.0 - (left / misfit).powi(2) } else { gained / misfit.powi(2) };
        let value = self.value();
        Explanation {
            setting: self.effect().setting(&self.with.rig, value.map(|(value, _)| value)),
            effect: self.effect(),
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

impl<'a> Origin<'_, 'a> {
    /// The model with a part of the usual size of the effect, and where its search begins: at the minimum without it.
    fn start(&self, part: f64) -> Option<(FittedModel<'a>, Minimum)> {
        let Origin { model, without: found, trial } = *self;
        let mut with = model.of_rig(trial.effect.rig(model, part)?);
        if let Change::Calibration(path) = trial.effect.change {
            return self.start_of_error(model.place_of_error(path)?, part);
        }
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
        // The row of its prior term has the same index as its column.
        let mut jacobian = jacobian.insert_row(found.rows() + place, 0.0).insert_column(place, 0.0);
        jacobian.view_mut((column.first, place), (column.rows.len(), 1)).copy_from(&column.rows);
        jacobian[(found.rows() + place, place)] = 1.0 / with.prior(place);
        Some((with, Minimum { u, residuals, jacobian, converged: false }))
    }

    /// The same with an error of calibration that is freed from its tolerance.
    fn start_of_error(&self, place: usize, part: f64) -> Option<(FittedModel<'a>, Minimum)> {
        let mut with = self.model.clone();
        with.parameters[place] = with.parameters[place].freed();
        let Minimum { mut u, mut jacobian, .. } = self.without.minimum.clone();
        let [low, high] = with.parameters[place].limits();
        u[place] = (u[place] + part).clamp(low, high);
        jacobian[(self.without.rows() + place, place)] = 1.0 / with.prior(place);
        let residuals = with.residuals_at(&u)?;
        Some((with, Minimum { u, residuals, jacobian, converged: false }))
    }

    /// The model with the size of the effect that comes nearest at the values of the file, or at those of the minimum
    /// without it but for what that moved far from the file; and that point.
    fn nearest(&self) -> Option<(FittedModel<'a>, Vec<f64>)> {
        let Origin { model, without, trial } = *self;
        if let Change::Calibration(_) = trial.effect.change {
            return None;
        }
        let u = &without.minimum.u;
        let is_far = |i: usize| u[i].abs() > FAR * model.prior(i);
        let mended = (0..u.len()).map(|i| if is_far(i) { 0.0 } else { u[i] }).collect();
        let points = [vec![0.0; u.len()], mended];
        let parts: &[f64] = if let Change::Number { .. } = trial.effect.change { &SIZES } else { &[1.0] };
        let mut best = (None, f64::INFINITY);
        for part in parts.iter().chain([&trial.part]) {
            let Some(rig) = trial.effect.rig(model, *part) else { continue };
            let with = model.of_rig(rig);
            for point in &points {
                let left = with.mean_square(point);
                if left < best.1 {
                    best = (Some((with.clone(), point.clone())), left);
                }
            }
        }
        let (with, mut u) = best.0?;
        let Change::Number { path, size, least, .. } = trial.effect.change else { return Some((with, u)) };
        u.insert(model.parameters.len(), 0.0);
        Some((with.with(&[Parameter::by_difference(&with.rig, path, size, least)?]), u))
    }
}
