//! The results of a fit for other programs.

use serde_json::{Value, json};

use super::FORMAT;
use super::judged::{Intervals, channels_not_testable, rounded_channels};
use crate::calibration::Calibrated;
use crate::causes::Explanation;
use crate::figures::{Figure, Figures};
use crate::parameter::Parameter;
use crate::recording::{CHANNELS, Recording};
use crate::{ChannelFit, ConditionalEstimate, Estimate, Identification, Share, Unidentifiable};

/// The numbers as JSON.
#[must_use]
pub fn to_json(found: &Identification, recordings: &[Recording]) -> Value {
    let channels = CHANNELS.iter().zip(&found.channels);
    let channels = channels.filter_map(|((name, _), fit)| Some(channel(name, fit.as_ref()?)));
    let correlation = found.correlation.row_iter().map(|row| row.iter().copied().collect::<Vec<f64>>());
    json!({
        "format": FORMAT,
        "rig": found.rig.name(),
        "transients": recordings.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(),
        "converged": found.converged,
        "fits": found.fits,
        "judged": found.spectrum.is_testable(),
        "channels_not_judged": channels_not_testable(found),
        "channels_rounded": rounded_channels(found),
        "incline_suggested_deg": found.incline.map(|incline| incline.degrees),
        "at_limits": found.at_limits,
        "far_from_file": found.far_off,
        "runs": found.runs, "evaluations": found.evaluations,
        "parameters": found.estimates.iter().map(|e| estimate(e, found)).collect::<Vec<_>>(),
        "unseen": found.unidentifiable.iter().map(unidentifiable).collect::<Vec<_>>(),
        "calibration": found.calibration.iter().map(calibrated).collect::<Vec<_>>(),
        "causes": found.causes.fitted.iter().map(cause).collect::<Vec<_>>(),
        "search_cut": found.cut, "causes_not_looked_at": found.causes.cut,
        "assumed": found.assumed.iter().map(assumed).collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(),
        "correlation": correlation.collect::<Vec<_>>(),
    })
}

fn estimate(e: &Estimate, found: &Identification) -> Value {
    let intervals = Intervals::of(found);
    json!({
        "key": e.parameter.key.path, "unit": e.parameter.key.unit(), "file": e.parameter.start,
        "estimate": e.value, "standard_error": e.standard_error,
        "interval_95": found.fits.then_some(e.interval),
        "interval_widened": (intervals == Intervals::Widened).then_some(e.interval),
        "interval": e.interval, "interval_is": intervals.word(),
        "part_of_assumptions": e.assumed, "rests_on": shares(&e.rests_on),
        "given": e.conditional.as_ref().map(|one| conditional(one, found.fits)),
    })
}

fn shares(shares: &[Share]) -> Vec<Value> {
    shares.iter().map(|share| json!({ "key": share.path, "part": share.part })).collect()
}

fn conditional(estimate: &ConditionalEstimate, fits: bool) -> Value {
    let known = estimate.known.iter().map(|(path, by)| json!({ "key": path, "changes_by": by }));
    json!({
        "known": known.collect::<Vec<_>>(), "standard_error": estimate.standard_error,
        "interval_95": fits.then_some(estimate.interval), "interval": estimate.interval,
    })
}

fn unidentifiable(one: &Unidentifiable) -> Value {
    json!({
        "key": one.parameter.key.path, "file": one.parameter.start, "kept": one.value,
        "confused_with": shares(&one.confused_with), "taken": one.value,
        "over_prior": one.over_prior,
    })
}

fn assumed(parameter: &Parameter) -> Value {
    json!({ "key": parameter.key.path, "file": parameter.start, "within": parameter.assumed_within() })
}

fn calibrated(error: &Calibrated) -> Value {
    json!({
        "key": error.parameter.key.path, "unit": error.parameter.key.unit(), "name": error.name,
        "file": error.parameter.start, "tolerance": error.tolerance, "estimate": error.value,
        "standard_error": error.standard_error, "seen": error.is_seen(), "beyond_tolerance": error.is_far,
    })
}

fn cause(cause: &Explanation) -> Value {
    json!({
        "effect": cause.effect.name, "settings": cause.setting, "explained": cause.explained,
        "chance": cause.chance, "significant": cause.is_significant(), "as_good_as_best": cause.as_good_as_best,
        "leaves_noise": cause.leaves_noise, "value": cause.value.map(|(value, _)| value),
        "standard_error": cause.value.map(|(_, error)| error),
    })
}

fn channel(name: &str, fit: &ChannelFit) -> Value {
    json!({
        "channel": name, "samples": fit.samples, "rms_before_counts": fit.before,
        "rms_after_counts": fit.after, "noise_counts": fit.noise,
        "correlation_of_neighbours": fit.correlation,
    })
}

/// What records show without a model of the air.
#[must_use]
pub fn read_off(figures: &Figures) -> Value {
    let one = |figure: Option<Figure>| figure.map(with_error);
    json!({
        "stiction_n": figures.stiction.map(one),
        "coulomb_n": figures.coulomb.map(one),
        "viscous_n_s_per_m": one(figures.viscous),
        "mass_kg": one(figures.mass),
        "top_speed_m_s": figures.top_speed,
        "top_acceleration_m_s2": figures.top_acceleration,
        "hysteresis_mm": figures.hysteresis_mm,
    })
}

/// A value with its standard error.
#[must_use]
pub fn with_error(figure: Figure) -> Value {
    json!({ "value": figure.value, "standard_error": figure.error })
}
