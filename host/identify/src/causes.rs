//! Possible causes of residuals that exceed the noise: effects that the rig file does not have, or has at a fixed value,
//! one at a time.
//!
//! ```text
//! d    = r(with the effect at its usual size) - r              its effect on the residuals
//! d_   = d - J (J' J)^-1 J' d                                  the part that no parameter can reproduce
//! gain = (d_' r)^2 / d_' d_                                    sum of squares that it would remove, linearised
//! F    = (S_0 - S_1) / (t S_1 / (n - p)),  t = (1 + rho) / (1 - rho)
//! ```
//!
//! A gain that noise hardly makes is a misfit of its own, even where all residuals together pass for noise: what is looked
//! for is one shape. The effects with the largest gains are fitted beside all parameters, which takes the sum of squares from
//! S_0 to S_1. Neighbouring residuals correlate by rho, so that n of them are worth n / t independent ones: F has 1 and (n -
//! p) / t degrees of freedom where the effect explains nothing. Its tail is multiplied by the number of effects that were
//! tried (Bonferroni).

mod effect;
mod fit;
mod list;
mod significance;

use nalgebra::{DMatrix, DVector};

use super::found::Found;
use super::model::FittedModel;
pub use effect::{Change, Choice, Effect};
use fit::{Fit, Origin};
use significance::{chance, noise};

/// Effects that are fitted, the most promising first, and to the end while none leaves noise alone.
const FITTED: usize = 4;

/// An effect of its usual size that leaves less than one standard deviation of noise is not seen.
const UNSEEN: f64 = 1.0;

/// The same of an error of calibration, whose usual size is its tolerance and may be far too small.
const UNSEEN_BEYOND_TOLERANCE: f64 = 0.05;

/// An effect of more than this many times its usual size is implausible.
const LARGEST: f64 = 30.0;

/// An effect explains something if chance would do it less often than this.
const SIGNIFICANT: f64 = 1e-3;

/// How well an effect explains a misfit.
#[derive(Clone, Debug)]
pub struct Explanation {
    /// The effect.
    pub effect: Effect,
    /// Setting by which a rig file has it as it was found.
    pub setting: String,
    /// Value that was found and its standard error, in the unit of the key, if the effect is a number and was fitted to
    /// the end.
    pub value: Option<(f64, f64)>,
    /// Part of the squared misfit that is gone with it; 1 where noise alone is left.
    pub explained: f64,
    /// How often an effect that explains nothing would seem to do as much.
    pub chance: f64,
    /// Whether noise alone is left with it.
    pub leaves_noise: bool,
    /// Whether it explains as much as the best one but for what chance can do.
    pub as_good_as_best: bool,
    /// Sum of squares that it takes away, in units of what chance takes on average.
    ratio: f64,
    /// Independent residuals.
    freedom: f64,
}

impl Explanation {
    /// Whether the effect is unlikely to be due to chance.
    #[must_use]
    pub(crate) fn is_significant(&self) -> bool {
        self.chance < SIGNIFICANT
    }
}

/// An effect on trial: the model that has it at its usual size, and by how much of that it should be.
#[derive(Clone, Copy)]
struct Trial {
    effect: Effect,
    gain: f64,
    part: f64,
}

/// The effects whose traces are in the residuals of a fit.
pub(super) struct Traces {
    /// The largest gain first.
    trials: Vec<Trial>,
    /// How often noise has as clear a trace of any.
    chance: f64,
    /// Whether an error of calibration is farther from the file's than its tolerance makes likely.
    far: bool,
}

/// What would explain a misfit, and what was not looked at.
#[derive(Clone, Debug, Default)]
pub struct Causes {
    /// The effects that were fitted, the best first.
    pub fitted: Vec<Explanation>,
    /// The names of those whose fit did not come to an end, or was not begun, as the search had become too long.
    pub cut: Vec<&'static str>,
    /// Where the fit of the best effect ended, if the model gains as much there without it: a point that its search has not
    /// come to.
    pub(super) not_come_to: Option<Vec<f64>>,
}

impl Causes {
    /// Whether the best effect leaves nothing but noise.
    #[must_use]
    pub fn explain_to_noise(&self) -> bool {
        self.fitted.first().is_some_and(|best| best.leaves_noise && best.is_significant())
    }
}

impl Traces {
    /// Looks for the traces. One effect is seen where its own shape is looked for long before all residuals together are
    /// more than noise.
    pub fn of(model: &FittedModel, found: &Found) -> Traces {
        let far = model.has_far_error(&found.minimum.u);
        let Some(projection) = Projection::of(&found.minimum.jacobian) else {
            return Traces { trials: Vec::new(), chance: 1.0, far };
        };
        let effects = list::EFFECTS.into_iter().chain(list::calibrations(model));
        let tried = effects.filter_map(|effect| trial(model, found, &projection, effect));
        let mut trials: Vec<Trial> = tried.collect();
        trials.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        let (variance, freedom) = noise(model, found);
        let largest = trials.first().map_or(0.0, |trial| trial.gain);
        let chance = chance(largest / variance, freedom) * trials.len() as f64;
        Traces { trials, chance: chance.min(1.0), far }
    }

    /// Whether there is one that noise hardly has.
    pub(crate) fn are_clear(&self) -> bool {
        self.far || self.chance < SIGNIFICANT
    }

    /// Norm of the residuals with the clearest trace; 0 where noise has as clear ones.
    pub fn misfit(&self) -> f64 {
        let largest = self.trials.first().map_or(0.0, |trial| trial.gain);
        if self.are_clear() { largest.sqrt() } else { 0.0 }
    }
}

/// The effects that explain what a fit leaves beyond noise, the best first. `progress` is told what is being done.
///
/// All but the best are tried out by secants alone: their gains are what was found, and they might gain a little more.
pub(super) fn explain(
    model: &FittedModel,
    found: &Found,
    traces: &Traces,
    progress: &mut dyn FnMut(&str),
) -> Causes {
    let misfit = found.spectrum.misfit().max(traces.misfit());
    if misfit == 0.0 {
        return Causes::default();
    }
    progress("what would explain the residuals: effects that are not in the rig file");
    let mut cut = Vec::new();
    let mut fits: Vec<Fit> = Vec::new();
    for trial in traces.trials.iter().take(FITTED) {
        if model.budget.is_spent() {
            cut.push(trial.effect.name);
        } else {
            fits.extend(Fit::by_secants(Origin { model, without: found, trial }));
        }
    }
    // Effects that the secants do not make better than none stay in the order of their promised gains.
    let without = found.minimum.residuals.norm_squared();
    let order = |a: &Fit, b: &Fit| a.cost().min(without).total_cmp(&b.cost().min(without));
    while !fits.iter().any(Fit::leaves_noise) && !model.budget.is_spent() {
        fits.sort_by(order);
        let Some(best) = fits.iter_mut().find(|fit| !fit.is_finished) else { break };
        best.finish(progress);
    }
    fits.sort_by(order);
    let fitted = told(&mut fits, (traces.trials.len(), misfit), progress);
    if model.budget.is_spent() && !fits.iter().any(Fit::leaves_noise) {
        cut.extend(fits.iter().filter(|fit| !fit.found_converged()).map(|fit| fit.effect().name));
    }
    let not_come_to = fits.first().and_then(Fit::point_without_effect);
    Causes { fitted, cut, not_come_to }
}

/// What is to be said of fits in the order of their gains. Those as good as the best are finished before.
fn told(fits: &mut [Fit<'_, '_>], tried: (usize, f64), progress: &mut dyn FnMut(&str)) -> Vec<Explanation> {
    let mut explanations: Vec<Explanation> = Vec::new();
    for fit in fits {
        let mut told = fit.explanation(tried);
        let best = explanations.first().map_or(told.ratio, |best| best.ratio);
        told.as_good_as_best = chance(best - told.ratio, told.freedom) > SIGNIFICANT;
        if told.as_good_as_best && told.is_significant() && !fit.is_finished && !fit.is_cut() {
            fit.finish(progress);
            told = Explanation { as_good_as_best: true, ..fit.explanation(tried) };
        }
        explanations.push(told);
    }
    explanations
}

/// What is left of residuals once the parameters have done what they can.
struct Projection<'a> {
    jacobian: &'a DMatrix<f64>,
    inverse: DMatrix<f64>,
}

impl Projection<'_> {
    fn of(jacobian: &DMatrix<f64>) -> Option<Projection<'_>> {
        Some(Projection { jacobian, inverse: jacobian.tr_mul(jacobian).cholesky()?.inverse() })
    }

    fn left_of(&self, residuals: &DVector<f64>) -> DVector<f64> {
        residuals - self.jacobian * (&self.inverse * self.jacobian.tr_mul(residuals))
    }
}

/// What an effect promises; None where the rig cannot have it, has it already, or the data do not show it.
fn trial(model: &FittedModel, found: &Found, projection: &Projection<'_>, effect: Effect) -> Option<Trial> {
    let residuals = &found.judged.residuals;
    let left = projection.left_of(&change(model, found, effect)?);
    let is_calibration = matches!(effect.change, Change::Calibration(_));
    if left.norm() < if is_calibration { UNSEEN_BEYOND_TOLERANCE } else { UNSEEN } {
        return None;
    }
    let (gain, part) = match effect.change {
        Change::Number { .. } | Change::Calibration(_) => {
            let part = -left.dot(residuals) / left.norm_squared();
            (left.dot(residuals).powi(2) / left.norm_squared(), part)
        }
        _ => (residuals.norm_squared() - (residuals + &left).norm_squared(), 1.0),
    };
    let plausible = is_calibration || part.abs() < LARGEST;
    let possible = gain > 0.0 && plausible && effect.rig(model, part).is_some();
    possible.then_some(Trial { effect, gain, part })
}

/// What an effect of its usual size does to the residuals. That of an error of calibration, which is among the unknowns, is
/// known: it is its column without the term of its tolerance.
fn change(model: &FittedModel, found: &Found, effect: Effect) -> Option<DVector<f64>> {
    let Change::Calibration(path) = effect.change else {
        let with = model.of_rig(effect.rig(model, 1.0)?);
        return Some(with.residuals_at(&found.minimum.u)? - &found.minimum.residuals);
    };
    let mut change = found.minimum.jacobian.column(model.place_of_error(path)?).into_owned();
    change.rows_mut(found.rows(), found.minimum.u.len()).fill(0.0);
    Some(change)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pneudrive_sim::Rig;
    use pneudrive_sim::rig::find_key;

    #[test]
    fn every_effect_is_of_a_key_and_of_a_size_in_its_range() {
        let rig = Rig::builtin("servo-b").expect("built in");
        for effect in list::EFFECTS {
            let (Change::Number { path, .. }
            | Change::Calibration(path)
            | Change::Switch(path)
            | Change::Word(Choice { path, .. })) = effect.change;
            assert!(find_key(path).is_some(), "{path}");
            let model = FittedModel::new(&rig, &[], Vec::new(), pneudrive_sim::Accuracy::default());
            assert!(effect.rig(&model, 1.0).is_some(), "{}", effect.name);
        }
    }

    /// The names of the effects that are tried on servo-drive B with some settings.
    fn tried(settings: &[&str]) -> Vec<&'static str> {
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        let rig = Rig::builtin("servo-b").expect("built in").with_settings(&settings).expect("valid");
        let model = FittedModel::new(&rig, &[], Vec::new(), pneudrive_sim::Accuracy::default());
        let possible = list::EFFECTS.iter().filter(|effect| effect.rig(&model, 1.0).is_some());
        possible.map(|effect| effect.name).collect()
    }

    #[test]
    fn an_effect_does_not_replace_another_model_that_the_rig_file_has_of_it() {
        for (leakage, is_tried) in [("none", true), ("laminar", true), ("adiabatic", false)] {
            let tried = tried(&[&format!("actuator.leakage={leakage}")]);
            assert_eq!(tried.contains(&"leakage past the piston"), is_tried, "{leakage}");
        }
        for (force, is_tried) in [("none", true), ("experimental", false)] {
            let tried = tried(&[&format!("valve.flow_force={force}")]);
            assert_eq!(tried.contains(&"the force of the flow on the spool"), is_tried, "{force}");
        }
    }

    #[test]
    fn what_the_parameters_can_do_is_left_out() {
        let jacobian = DMatrix::from_row_slice(3, 1, &[1.0, 1.0, 0.0]);
        let projection = Projection::of(&jacobian).expect("regular");
        let left = projection.left_of(&DVector::from_row_slice(&[3.0, 1.0, 2.0]));
        assert!((left - DVector::from_row_slice(&[1.0, -1.0, 2.0])).norm() < 1e-12);
    }
}
