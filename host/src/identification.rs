//! Parameters of a rig from recorded transients, with their uncertainties (thesis 7.1).
//!
//! Output error: the recorded commands drive the model, and the parameters are those with which it repeats
//! what the sensors read. For each channel c at each sample k that counts
//!
//! ```text
//! r = (measured - model) / sigma_c           in counts of encoder and converters
//! minimise  sum of r^2 + sum of u^2          u: unknown by unknown, 0 at the file's value
//! ```
//!
//! - **u** is ln(value / file's value) for what cannot be negative, else (value - file's value) / what is
//!   plausible ([`parameter`]). Its own term keeps the search near the file where the data are silent; an
//!   estimate with the standard error s is drawn by no more than u s^2 towards the file.
//! - **The initial state** of each transient, position and pressures, is unknown within what sensors tell; it is
//!   found with the parameters. The drive must be at rest then, its air as warm as the test says.
//! - **The encoder** rounds down: the model is position / pulse - 1/2, and sigma that of an even error of one
//!   count, 1 / sqrt(12). While the drive stands that error repeats in every sample, so a sample counts where
//!   the drive has moved on by one to two counts, and one in each rest ([`recording`]).
//! - **sigma** of the converters is what scatters in the rests before the first move; at the end, that of the
//!   residuals. Where these are larger than the rests allow, the model does not explain the data, and that is said
//!   ([`ChannelFit::fits`]).
//! - **Friction** makes the sum of squares jump where a spool or a load sticks or slips by a hair. The tests of
//!   [`moves`] have no such instants; a search that ends where more than noise remains begins anew beside its start.
//! - **Unseen parameters** keep the file's value: those whose standard error in u exceeds [`UNSEEN`], the
//!   worst first, each with those that it is confused with ([`uncertainty`]).
//!
//! docs/identification.md has the proof: how often the intervals hold what a virtual rig hides.

pub mod figures;
pub mod least_squares;
mod model;
pub mod moves;
pub mod parameter;
pub mod recording;
pub mod recovery;
pub mod regression;
pub mod report;
pub mod tubing;
pub mod uncertainty;

use anyhow::{Result, anyhow, bail};
use nalgebra::DMatrix;
use pneudrive_sim::{Accuracy, Rig};

use least_squares::{Minimum, Problem, minimise};
use model::Model;
use parameter::Parameter;
use recording::{CHANNELS, Recording, STARTS};
use uncertainty::{Confusion, Uncertainty};

/// Shares of each transient that the fit takes one after the other.
pub const STAGES: [f64; 3] = [0.35, 0.65, 1.0];

/// A parameter whose standard error in u is larger cannot be seen in the data: +-50 % of the file's value,
/// or half of what is plausible.
pub const UNSEEN: f64 = 0.5;

/// A search whose residuals' mean square is below this, in squares of the noise, has found the minimum.
const NEAR: f64 = 4.0;

/// Times that a search begins anew.
const RESTARTS: usize = 3;

/// How far from a point another search begins, in u of one parameter.
const SCAN: [f64; 8] = [-0.2, -0.12, -0.07, -0.03, 0.03, 0.07, 0.12, 0.2];

/// Residuals are noise if their variance is that of the rests but for so many standard deviations.
const FITS: f64 = 6.0;

/// What a parameter was found to be.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The parameter, with the file's value.
    pub parameter: Parameter,
    /// In the unit of the key.
    pub value: f64,
    /// In the unit of the key.
    pub standard_error: f64,
    /// Ends of the 95 % interval, in the unit of the key.
    pub interval: [f64; 2],
}

/// A parameter that the data do not show.
#[derive(Clone, Debug)]
pub struct Unseen {
    /// It keeps the file's value.
    pub parameter: Parameter,
    /// Its standard error in u, infinite where nothing depends on it.
    pub standard_error: f64,
    /// The parameters that would make up for it.
    pub confused_with: Vec<Confusion>,
}

/// What a channel says of the fit.
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
    /// What rests have shown of the noise, counts.
    pub noise: f64,
    /// How many independent readings in rests that rests on; 0 where rounding is all there is.
    pub rest: f64,
}

impl ChannelFit {
    /// Whether what remains is noise.
    #[must_use]
    pub fn fits(&self) -> bool {
        let of_rest = if self.rest > 0.0 { 1.0 / self.rest } else { 0.0 };
        let scatter = (2.0 * (of_rest + 1.0 / self.samples as f64)).sqrt();
        (self.after / self.noise).powi(2) < 1.0 + FITS * scatter
    }
}

/// A finished fit.
#[derive(Clone, Debug)]
pub struct Identification {
    /// The parameters that the data show, in the order asked for.
    pub estimates: Vec<Estimate>,
    /// Those that they do not.
    pub unseen: Vec<Unseen>,
    /// Correlation of the estimates' errors.
    pub correlation: DMatrix<f64>,
    /// In the order of [`CHANNELS`]; None for one without samples.
    pub channels: [Option<ChannelFit>; CHANNELS.len()],
    /// Whether the last search ended at a minimum.
    pub converged: bool,
    /// Whether what remains is noise: else the model does not explain the data, or another minimum does better.
    pub fits: bool,
    /// Runs of a transient that the fit took.
    pub runs: usize,
    /// Whether residuals are correlated, so that the standard errors are those of Newey and West.
    pub robust: bool,
    /// How far each recording's initial state is off the measured one, counts.
    pub starts: Vec<[f64; STARTS]>,
    /// The rig with the estimates.
    pub rig: Rig,
}

/// Fits `parameters` of a rig to recordings. `progress` is told what is being done.
///
/// # Errors
/// When there is nothing to fit, or the model cannot follow the recordings at the file's values.
pub fn identify(
    rig: &Rig,
    recordings: &[Recording],
    parameters: Vec<Parameter>,
    accuracy: Accuracy,
    progress: &mut dyn FnMut(&str),
) -> Result<Identification> {
    if parameters.is_empty() || recordings.is_empty() {
        bail!("a fit needs a parameter and a transient");
    }
    let mut model = Model::new(rig, recordings, parameters, accuracy);
    let start = vec![0.0; model.unknowns()];
    let residuals = model.residuals(&start).ok_or_else(|| cannot_follow(&model, &start))?;
    let before = model.channel_fits(&residuals).map(|fit| fit.map(|fit| fit.after));
    let mut u = search(&mut model, start, progress);
    let mut unseen = Vec::new();
    loop {
        let minimum = settled(&mut model, u, &unseen, progress)?;
        let uncertainty = Uncertainty::of(&model, &minimum);
        let Some(worst) = uncertainty.worst(UNSEEN) else {
            return Ok(finished(&model, &minimum, &uncertainty, unseen, before));
        };
        let found = uncertainty.unseen(&model.parameters, worst);
        progress(&format!("{} cannot be seen", found.parameter.key.path));
        u = minimum.u;
        u.remove(worst);
        model.parameters.remove(worst);
        unseen.push(found);
        if model.parameters.is_empty() {
            bail!("none of the parameters can be seen in the transients; the drive must move in them");
        }
    }
}

/// From `start` to near a minimum that leaves noise; from other points where it is another one.
fn search(model: &mut Model, start: Vec<f64>, progress: &mut dyn FnMut(&str)) -> Vec<f64> {
    let mut best = approach(model, start.clone(), progress);
    let mut from = start;
    for _ in 0..RESTARTS {
        if best.1 < NEAR {
            break;
        }
        progress("that is no fit: the search begins at another point");
        let other = approach(model, scanned(model, from), progress);
        if other.1 < best.1 {
            best = other;
        }
        from = best.0.clone();
    }
    best.0
}

/// From a point to near a minimum, stage by stage, and the mean square that it leaves.
fn approach(model: &mut Model, mut u: Vec<f64>, progress: &mut dyn FnMut(&str)) -> (Vec<f64>, f64) {
    model.fine = false;
    for share in STAGES {
        model.share = share;
        progress(&format!("the first {:.0} % of each transient", 100.0 * share));
        u = minimise(model, &u, false, progress).map_or(u, |minimum| minimum.u);
    }
    let left = model.mean_square(&u);
    (u, left)
}

/// The best of the points that lie beside one along a parameter.
fn scanned(model: &Model, from: Vec<f64>) -> Vec<f64> {
    let mut best = (model.mean_square(&from), from.clone());
    for i in 0..model.parameters.len() {
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

fn cannot_follow(model: &Model, u: &[f64]) -> anyhow::Error {
    let reason = model.obstacle(u).unwrap_or_else(|| anyhow!("it has no derivatives there"));
    reason.context(format!("the model of {} cannot follow the commands of the transients", model.rig.name()))
}

/// To the minimum, then with the noise that the residuals there show.
fn settled(
    model: &mut Model,
    u: Vec<f64>,
    unseen: &[Unseen],
    progress: &mut dyn FnMut(&str),
) -> Result<Minimum> {
    model.fine = true;
    let minimum = minimise(model, &u, true, progress).ok_or_else(|| {
        let kept: Vec<&str> = unseen.iter().map(|unseen| unseen.parameter.key.path).collect();
        cannot_follow(model, &u).context(format!(
            "the fit cannot go on with the file's value of {}, which cannot be seen",
            kept.join(", ")
        ))
    })?;
    let found = model.channel_fits(&minimum.residuals);
    for (noise, fit) in model.noise.iter_mut().zip(found) {
        *noise = fit.map_or(*noise, |fit| fit.after);
    }
    Ok(minimise(model, &minimum.u, true, progress).unwrap_or(minimum))
}

fn finished(
    model: &Model,
    minimum: &Minimum,
    uncertainty: &Uncertainty,
    unseen: Vec<Unseen>,
    before: [Option<f64>; CHANNELS.len()],
) -> Identification {
    let estimates = model.parameters.iter().zip(&minimum.u).enumerate().map(|(i, (parameter, &u))| {
        let error = uncertainty.standard_error(i);
        let reach = uncertainty::NORMAL_95 * error;
        Estimate {
            value: parameter.value(u),
            standard_error: error * parameter.slope(u),
            interval: [parameter.value(u - reach), parameter.value(u + reach)],
            parameter: parameter.clone(),
        }
    });
    let after = model.channel_fits(&minimum.residuals);
    let channels: [Option<ChannelFit>; CHANNELS.len()] =
        std::array::from_fn(|c| Some(ChannelFit { before: before[c]?, ..after[c]? }));
    Identification {
        estimates: estimates.collect(),
        unseen,
        correlation: uncertainty.correlation(),
        channels,
        converged: minimum.converged,
        fits: channels.iter().flatten().all(ChannelFit::fits),
        runs: model.runs(),
        robust: uncertainty.robust,
        starts: (0..model.recordings.len()).map(|i| model.start_at(&minimum.u, i)).collect(),
        rig: model.rig_at(&minimum.u).unwrap_or_else(|_| model.rig.clone()),
    }
}
