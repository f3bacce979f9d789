//! The reliability of a fit's intervals: whether the model explains the data, and whether that can be judged.

use super::calibrated::beyond_tolerance;
use crate::recording::CHANNELS;
use crate::{FAR, Identification};

/// The kind of a fit's intervals.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Intervals {
    /// Intervals of 95 %.
    Of95,
    /// Widened by the effect of a model error as large as the residuals.
    Widened,
    /// From noise and priors; whether the model fits cannot be judged.
    NotTestable,
}

impl Intervals {
    pub fn of(found: &Identification) -> Intervals {
        match (found.fits, found.spectrum.is_testable()) {
            (true, _) => Intervals::Of95,
            (false, true) => Intervals::Widened,
            (false, false) => Intervals::NotTestable,
        }
    }

    /// The heading of their column.
    pub fn heading(self) -> &'static str {
        match self {
            Intervals::Of95 => "95 % interval",
            Intervals::Widened => "interval, widened by the misfit",
            Intervals::NotTestable => "interval of a fit that cannot be judged",
        }
    }

    /// Its name in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Intervals::Of95 => "95 %",
            Intervals::Widened => "widened by the misfit",
            Intervals::NotTestable => "not judged",
        }
    }
}

/// The channels with too few samples to judge the fit.
pub(super) fn channels_not_testable(found: &Identification) -> Vec<&'static str> {
    found.spectrum.unjudged.iter().map(|&channel| CHANNELS[channel].0).collect()
}

/// The note on them; None if all channels are judged.
pub(super) fn not_testable(found: &Identification) -> Option<String> {
    let channels = channels_not_testable(found).join(", ");
    if !found.spectrum.is_testable() {
        return Some(format!(
            "Too few samples count to show whether the residuals exceed the noise ({channels}): whether the model explains these data cannot be judged, and the intervals may not be 95 % intervals. Fit longer transients, or more of them."
        ));
    }
    (!channels.is_empty()).then(|| {
        format!("Too few samples of {channels} count to show whether the residuals exceed the noise there: the fit is not judged by them.")
    })
}

/// The channels whose rounding the model repeats.
pub(super) fn rounded_channels(found: &Identification) -> Vec<&'static str> {
    let rounded = CHANNELS.iter().zip(found.rounded).filter(|(_, rounded)| *rounded);
    rounded.map(|((name, _), _)| *name).collect()
}

/// The note on them; None if there are none.
pub(super) fn rounded(found: &Identification) -> Option<String> {
    let channels = rounded_channels(found).join(", ");
    (!channels.is_empty()).then(|| {
        format!("The readings of {channels} have less noise than a count, so that their rounding depends on the signal: the model repeats it, and is fitted and judged without it. A model error of less than a fraction of a count is not seen. The intervals count rounding as noise, and are wider than the scatter of the estimates.")
    })
}

/// The note on a search that was cut; None if it was not.
pub(super) fn cut(found: &Identification) -> Option<String> {
    found.cut.then(|| {
        let effects = match found.causes.cut.as_slice() {
            [] => String::new(),
            names => format!(" Not looked at to the end: {}.", names.join(", ")),
        };
        format!("The search for another minimum and for a cause was cut, as it had become too long: there may be a better explanation than the ones that are told.{effects} Fit fewer parameters (--fit), or give what you have measured with --set, and try again.")
    })
}

/// Signs that something other than the parameters is wrong.
pub(super) fn suspicious(found: &Identification) -> Vec<String> {
    let incline = found.incline.map(|incline| {
        let [low, high] = incline.interval;
        format!("Friction differs from the file's as with an incline of {:.0} degrees ({low:.0} to {high:.0}): by {:.1} N, up one way and down the other. These data cannot distinguish the two, and the intervals include it. Measure it with a level; with `--set load.incline_deg={:.0}` the same records can be fitted again.", incline.degrees, incline.force, incline.degrees)
    });
    let held = (!found.at_limits.is_empty()).then(|| {
        format!("At a limit: {}. The limit is the end of the possible range, or Coulomb friction as large as stiction. The data call for a value beyond it, so something else is wrong, and the interval means little.", found.at_limits.join(", "))
    });
    let far = (!found.far_off.is_empty()).then(|| {
        format!("Far from the file's value, by more than {FAR:.0} of the assumed standard deviations: {}. Check that the file belongs to this rig, and what else could have the same effect.", found.far_off.join(", "))
    });
    [incline, beyond_tolerance(found), held, far].into_iter().flatten().collect()
}
