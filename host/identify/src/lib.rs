//! Parameters of a rig from recorded transients, with their uncertainties (thesis 7.1).
//!
//! Output error method: the recorded commands drive the model, and the parameters are those with which it reproduces the
//! sensor readings. For each channel c at each sample k that counts
//!
//! ```text
//! r = (measured - model) / sigma_c           in counts of encoder and converters
//! minimise  sum of r^2 + sum of u^2          u: unknown by unknown, 0 at the file's value
//! ```
//!
//! - **u** is ln(value / file's value) for what cannot be negative, else (value - file's value) / what is
//!   plausible ([`parameter`]). Its own term, over the prior's standard deviation, keeps the search near the file where
//!   the data are silent.
//! - **The initial state** of each transient, position and pressures, is unknown within what sensors tell, and so is the side of
//!   the valve's hysteresis on which the last command has left the spool; it is found with the parameters. The drive must be at rest then. Its air is as
//!   warm as the test says, unless the pressures differ from start to start: then its temperatures are unknown, too.
//! - **The encoder** rounds down: the model is position / pulse - 1/2, and sigma that of an even error of one
//!   count, 1 / sqrt(12). While the drive stands that error repeats in every sample, so a sample counts where
//!   the drive has moved on by one to two counts, and one in each rest ([`recording`]). A potentiometer rounds to the
//!   nearest; where an absolute encoder has noise, every sample counts, and sigma is found as that of a converter. The
//!   deviation from its straight line (`encoder.linearity_percent`) is not in the model.
//! - **sigma** of the converters is first what scatters in the rests before the first move, then what the highest
//!   frequencies of the residuals show. What remains at lower ones tells whether the model explains the data
//!   ([`spectrum`]).
//! - **Friction** makes the sum of squares jump where a spool or a load sticks or slips by a hair. The tests of
//!   [`moves`] have no such instants; a search that ends where more than noise remains begins anew beside its start.
//! - **Errors of calibration**, of scales and offsets of the sensors and of the clock, are unknowns of every fit within the
//!   tolerances that the rig file has ([`calibration`]).
//! - **What the data do not show** stays as uncertain as the prior says, and with it whatever depends on it: intervals
//!   carry both (`posterior`). What no sample depends on is not fitted.
//!
//! docs/howto/identification.md has the proof: how often the intervals hold what a virtual rig hides.
//!
//! A record of a drive whose load is heavier than its rig file says:
//!
//! ```
//! use pneudrive_evaluate::{cancel::CancelToken, recorded_run::recorded_run};
//! use pneudrive_identify::{identify, parameter::Parameter, recording::Recording};
//! use pneudrive_sim::{Accuracy, Rig, run};
//!
//! let moves = "test.moves=[[0.0, 0], [0.05, 1200], [0.2, -1200], [0.35, 0]]";
//! let settings = ["controller.loop=open", "operator.dither_mm=0", "test.duration_s=0.45", moves];
//! let file = Rig::builtin("servo-b").expect("a built-in rig").with_settings(&settings)?;
//! let drive = file.with_settings(&["load.mass_kg=1.9"])?;
//! let record = recorded_run(&drive, &run(&drive, Accuracy::of(&drive))?)?;
//!
//! let recordings = [Recording::of("TARGET01.DAT", &record, &file)?];
//! let mass = vec![Parameter::of(&file, "load.mass_kg")?];
//! let found = identify(&file, &recordings, mass, Accuracy::of(&file), &mut |_| {}, CancelToken::NEVER)?;
//! let [least, most] = found.estimates[0].interval;
//! assert!(found.fits && least < 1.9 && 1.9 < most && most - least < 0.05, "{least} to {most} kg");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod approach;
mod assumed;
mod budget;
pub mod calibration;
pub mod causes;
pub mod conductance;
mod derivatives;
pub mod figures;
mod found;
pub mod independence;
pub mod least_squares;
pub mod level;
pub mod limits;
mod model;
pub mod moves;
pub mod parameter;
pub mod plan;
mod posterior;
pub mod recording;
pub mod regression;
pub mod report;
mod rounding;
mod search;
pub mod spectrum;
pub mod tubing;

use anyhow::{Result, bail};
use nalgebra::{DMatrix, DVector};
use pneudrive_sim::{Accuracy, Rig};

use calibration::Calibrated;
use causes::{Causes, Traces};
use found::Found;
use level::Incline;
use model::FittedModel;
use parameter::Parameter;
use recording::{CHANNELS, Recording, STARTS};
use search::Termination;
use spectrum::Spectrum;

use pneudrive_evaluate::cancel::CancelToken;

/// A parameter whose standard error is a larger part of that of its prior cannot be seen in the data.
pub(crate) const UNIDENTIFIABLE: f64 = 0.5;

/// No sample depends on a parameter if all of them together change by less than so many standard deviations over its
/// prior.
const NOTHING: f64 = 1.0;

/// Residuals have grown if their variance has by so many standard deviations of it.
const GROWN: f64 = 4.0;

/// A value is far from the file's by so many standard deviations of its prior.
pub const FAR: f64 = 3.0;

/// A limit holds a value that is so near to it, in u.
const AT_LIMIT: f64 = 1e-6;

/// What a parameter was found to be.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The parameter, with the file's value.
    pub parameter: Parameter,
    /// The estimate, in the unit of the key.
    pub value: f64,
    /// Its standard error, in the unit of the key.
    pub standard_error: f64,
    /// Ends of the 95 % interval, in the unit of the key; where the model does not explain the data, moved apart by what a
    /// model error as large as the residuals can do.
    pub interval: [f64; 2],
    /// By how much a model error as large as the residuals can move the estimate, in the unit of the key; 0 where the model
    /// explains the data.
    pub by_misfit: f64,
    /// Part of the squared standard error that the priors make; the rest is noise.
    pub assumed: f64,
    /// The priors that make it, the largest part first, where the priors make the larger part.
    pub rests_on: Vec<Share>,
    /// What would make it better known, where it rests on priors.
    pub conditional: Option<ConditionalEstimate>,
}

/// The part of a prior in a squared standard error.
#[derive(Clone, Debug)]
pub struct Share {
    /// The key.
    pub path: &'static str,
    /// The part.
    pub part: f64,
}

/// What a parameter is once others are known exactly.
#[derive(Clone, Debug)]
pub struct ConditionalEstimate {
    /// The others, and by how much the parameter changes with them, in the units of both keys.
    pub known: Vec<(&'static str, f64)>,
    /// Standard error that is left, in the unit of the key.
    pub standard_error: f64,
    /// Ends of the 95 % interval that is left if the others have the values of the fitted file.
    pub interval: [f64; 2],
}

/// A parameter that the data do not show.
#[derive(Clone, Debug)]
pub struct Unidentifiable {
    /// The parameter, with the file's value.
    pub parameter: Parameter,
    /// The value of the fitted rig: the file's, shifted by the little that the data show.
    pub value: f64,
    /// Its standard error over that of its prior; 1 where no sample depends on it.
    pub over_prior: f64,
    /// The parameters that would make up for it.
    pub confused_with: Vec<Share>,
}

/// The fit of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelFit {
    /// Samples that count.
    pub samples: usize,
    /// Root of the mean squared residual before and after the fit, counts.
    pub before: f64,
    /// After the fit.
    pub after: f64,
    /// Correlation of a residual with the next one.
    pub correlation: f64,
    /// What the highest frequencies of the residuals show of the noise, counts.
    pub noise: f64,
}

impl ChannelFit {
    /// Whether the residuals are larger than before the fit by more than chance.
    #[must_use]
    pub(crate) fn has_grown(&self) -> bool {
        let chance = (2.0 / self.samples as f64).sqrt() * self.noise.powi(2);
        self.after.powi(2) - self.before.powi(2) > GROWN * chance
    }
}

/// A finished fit.
#[derive(Clone, Debug)]
pub struct Identification {
    /// The parameters that the data show, in the requested order.
    pub estimates: Vec<Estimate>,
    /// The parameters that the data do not show.
    pub unidentifiable: Vec<Unidentifiable>,
    /// What is assumed of keys that are not fitted.
    pub assumed: Vec<Parameter>,
    /// The incline that would explain how friction differs from the file's.
    pub incline: Option<Incline>,
    /// Keys of values that a limit holds: the end of a key's range, or Coulomb friction that is not above stiction.
    pub at_limits: Vec<&'static str>,
    /// Keys of values that are farther from the file's than assumed, by more than [`FAR`] standard deviations of that.
    pub far_off: Vec<&'static str>,
    /// Correlation of the estimates' errors.
    pub correlation: DMatrix<f64>,
    /// In the order of [`CHANNELS`]; None for one without samples.
    pub channels: [Option<ChannelFit>; CHANNELS.len()],
    /// What remains, by frequency.
    pub spectrum: Spectrum,
    /// Of which channels the model knows the rounding itself: they have less noise than hides it.
    pub rounded: [bool; CHANNELS.len()],
    /// Whether the last search ended at a minimum.
    pub converged: bool,
    /// The errors of calibration that the data may have.
    pub calibration: Vec<Calibrated>,
    /// What would explain the residuals, where these are more than noise.
    pub causes: Causes,
    /// Whether the search for another minimum or a cause was ended early because it had spent its budget.
    pub cut: bool,
    /// Whether the search converged and what remains is noise: else the model does not explain the data, another minimum
    /// does better, or the samples are too few to tell ([`Spectrum::is_testable`]).
    pub fits: bool,
    /// Runs of a transient that the fit took.
    pub runs: usize,
    /// Evaluations of the model's equations in these runs.
    pub evaluations: u64,
    /// How far each recording's initial state is off the measured one, counts, the temperatures of its air off the
    /// file's, K, and the side of its hysteresis.
    pub starts: Vec<[f64; STARTS]>,
    /// The rig with the estimates.
    pub rig: Rig,
}

/// Fits `parameters` of a rig to recordings. `progress` is given what is being done.
///
/// # Errors
/// When there is nothing to fit, the model cannot follow the recordings at the file's values, or nobody waits for it any
/// more ([`Cancelled`](pneudrive_evaluate::cancel::Cancelled)).
pub fn identify(
    rig: &Rig,
    recordings: &[Recording],
    parameters: Vec<Parameter>,
    accuracy: Accuracy,
    progress: &mut dyn FnMut(&str),
    cancel: CancelToken<'_>,
) -> Result<Identification> {
    let mut model = FittedModel::new(rig, recordings, parameters, accuracy);
    model.cancel = cancel;
    let found = fitted(model, progress);
    cancel.check()?;
    found
}

fn fitted(mut model: FittedModel<'_>, progress: &mut dyn FnMut(&str)) -> Result<Identification> {
    if model.parameters.is_empty() || model.recordings.is_empty() {
        bail!("a fit needs a parameter and a transient");
    }
    independence::check(model.recordings, progress)?;
    let start = vec![0.0; model.unknowns()];
    let residuals = model.residuals_at(&start).ok_or_else(|| search::cannot_follow(&model, &start))?;
    model.budget.begin();
    let before = model.channel_fits(&residuals).map(|fit| fit.map(|fit| fit.after));
    let silent = model.leave_out_what_nothing_depends_on(&residuals);
    if model.parameters.is_empty() {
        bail!("none of the parameters can be seen in the transients; the drive must move in them");
    }
    let start = vec![0.0; model.unknowns()];
    let Termination { found, causes, of_first } = search::search(&mut model, start, progress)?;
    let posterior = assumed::posterior(&model, &found)?;
    let traces = Traces::of(&model, &found);
    let told = finished(&model, &found, &posterior, silent, (before, &traces));
    let causes = match causes {
        Some(causes) => causes,
        None if told.fits => Causes::default(),
        None if model.budget.is_spent() && !of_first.fitted.is_empty() => of_first,
        None => causes::explain(&model, &found, &traces, progress),
    };
    let cut = !told.fits && (model.budget.is_spent() || !causes.cut.is_empty());
    Ok(Identification { causes, cut, runs: model.runs(), evaluations: model.budget.spent(), ..told })
}

impl FittedModel<'_> {
    /// The keys of parameters of a kind.
    fn parameters_where(&self, is: impl Fn(usize) -> bool) -> Vec<&'static str> {
        (0..self.parameters.len()).filter(|&i| is(i)).map(|i| self.parameters[i].key.path).collect()
    }

    /// Whether a limit holds a parameter at a point.
    fn is_at_limit(&self, u: &[f64], parameter: usize) -> bool {
        self.limits().iter().any(|limit| limit.has(parameter) && limit.room(u) < AT_LIMIT)
    }

    /// Removes the parameters that no sample depends on.
    fn leave_out_what_nothing_depends_on(&mut self, at: &DVector<f64>) -> Vec<Unidentifiable> {
        let columns = self.columns(&vec![0.0; self.unknowns()], at, 0..self.parameters.len());
        let shows = |i: usize| columns[i].as_ref().is_none_or(|c| self.prior(i) * c.rows.norm() > NOTHING);
        let shown: Vec<bool> = (0..self.parameters.len()).map(shows).collect();
        let parameters = std::mem::take(&mut self.parameters).into_iter().zip(shown);
        let (seen, silent): (Vec<_>, Vec<_>) = parameters.partition(|(_, shown)| *shown);
        self.parameters = seen.into_iter().map(|(parameter, _)| parameter).collect();
        let unidentifiable = silent.into_iter().map(|(parameter, _)| Unidentifiable {
            value: parameter.start,
            over_prior: 1.0,
            confused_with: Vec::new(),
            parameter,
        });
        unidentifiable.collect()
    }
}

fn finished(
    model: &FittedModel,
    found: &Found,
    posterior: &assumed::Considered,
    silent: Vec<Unidentifiable>,
    (before, traces): ([Option<f64>; CHANNELS.len()], &Traces),
) -> Identification {
    let u = &found.minimum.u;
    let of_the_rig = (0..model.parameters.len()).filter(|&i| !model.parameters[i].is_calibration);
    let (unidentifiable, seen): (Vec<usize>, Vec<usize>) =
        of_the_rig.partition(|&i| posterior.of.over_prior(i) > UNIDENTIFIABLE);
    let calibrated = |i: usize| Calibrated::of(&model.parameters[i], u[i], posterior.of.standard_error(i));
    let after = model.channel_fits(&found.minimum.residuals);
    let channels: [Option<ChannelFit>; CHANNELS.len()] =
        std::array::from_fn(|c| Some(ChannelFit { before: before[c]?, ..after[c]? }));
    let grown = channels.iter().flatten().any(ChannelFit::has_grown);
    let correlation = posterior.of.correlation(model.parameters.len());
    let unidentifiable = unidentifiable.into_iter().map(|i| posterior.unidentifiable(model, u, i));
    let misfit = found.spectrum.misfit().max(traces.misfit());
    let fits = found.minimum.converged && found.spectrum.is_noise() && !traces.are_clear() && !grown;
    Identification {
        unidentifiable: unidentifiable.chain(silent).collect(),
        correlation: DMatrix::from_fn(seen.len(), seen.len(), |i, j| correlation[(seen[i], seen[j])]),
        estimates: seen.into_iter().map(|i| posterior.estimate(model, u, i, misfit)).collect(),
        assumed: posterior.assumed.clone(),
        // Friction that cannot compensate an incline would suggest a wrong one.
        incline: posterior.incline.filter(|_| fits),
        at_limits: model.parameters_where(|i| model.is_at_limit(u, i)),
        far_off: model
            .parameters_where(|i| u[i].abs() > FAR * model.prior(i) && !model.parameters[i].is_calibration),
        channels,
        calibration: (0..model.parameters.len()).filter_map(calibrated).collect(),
        causes: Causes::default(),
        cut: false,
        converged: found.minimum.converged,
        fits,
        spectrum: found.spectrum.clone(),
        rounded: found.judged.rounded,
        runs: model.runs(),
        evaluations: model.budget.spent(),
        starts: (0..model.recordings.len()).map(|i| model.start_at(u, i)).collect(),
        rig: model.rig_at(u).unwrap_or_else(|_| model.rig.clone()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn residuals_have_grown_where_chance_does_not_make_them_so_large() {
        let fit = |before, after| ChannelFit { samples: 800, before, after, correlation: 0.0, noise: 1.0 };
        assert!(!fit(1.0, 1.0).has_grown() && !fit(5.0, 1.0).has_grown() && !fit(1.0, 1.05).has_grown());
        assert!(fit(1.0, 1.2).has_grown());
    }
}
