//! What a fit's intervals are worth: whether the model explains the data, and whether that can be told.

use crate::identification::recording::CHANNELS;
use crate::identification::{FAR, Identification};

/// What the intervals of a fit are.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Intervals {
    /// Of 95 %.
    Of95,
    /// Wider by what a model error as large as the residuals can do.
    Widened,
    /// Of noise and priors; nothing tells whether the model fits.
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

    /// For a program.
    pub fn word(self) -> &'static str {
        match self {
            Intervals::Of95 => "95 %",
            Intervals::Widened => "widened by the misfit",
            Intervals::NotTestable => "not judged",
        }
    }
}

/// The channels with too few samples to tell noise from more.
pub(super) fn channels_not_testable(found: &Identification) -> Vec<&'static str> {
    found.spectrum.unjudged.iter().map(|&channel| CHANNELS[channel].0).collect()
}

/// What is to be said of them; None where all channels are judged.
pub(super) fn not_testable(found: &Identification) -> Option<String> {
    let channels = channels_not_testable(found).join(", ");
    if !found.spectrum.is_testable() {
        return Some(format!(
            "Too few samples count to tell whether more than noise remains ({channels}): whether the model explains these data cannot be judged, and no interval is known to be one of 95 %. Fit longer transients, or more of them."
        ));
    }
    (!channels.is_empty()).then(|| {
        format!("Too few samples of {channels} count to tell whether more than noise remains there: that the model fits is not judged by them.")
    })
}

/// The channels of which the model knows the rounding.
pub(super) fn rounded_channels(found: &Identification) -> Vec<&'static str> {
    let rounded = CHANNELS.iter().zip(found.rounded).filter(|(_, rounded)| *rounded);
    rounded.map(|((name, _), _)| *name).collect()
}

/// What is to be said of them; None where there are none.
pub(super) fn rounded(found: &Identification) -> Option<String> {
    let channels = rounded_channels(found).join(", ");
    (!channels.is_empty()).then(|| {
        format!("The readings of {channels} have less noise than a count, so that their rounding follows their course: the model repeats it, and is fitted and judged without it. An error of the model of less than a part of a count is not seen. Intervals count rounding as noise, and are wider than the estimates scatter.")
    })
}

/// What looks as if something else than the parameters were wrong.
pub(super) fn suspicious(found: &Identification) -> Vec<String> {
    let incline = found.incline.map(|incline| {
        let [low, high] = incline.interval;
        format!("Friction is off the file's as an incline of {:.0} degrees would do ({low:.0} to {high:.0}): by {:.1} N, up one way and down the other. These data do not tell the two apart, and the intervals carry it. Measure it with a level; with `--set load.incline_deg={:.0}` the same records are fitted again.", incline.degrees, incline.force, incline.degrees)
    });
    let held = (!found.at_limits.is_empty()).then(|| {
        format!("A limit holds {}: the end of what is possible, or Coulomb friction as large as stiction. The data ask for more, so something else is wrong, and the interval means little.", found.at_limits.join(", "))
    });
    let far = (!found.far_off.is_empty()).then(|| {
        format!("More than {FAR:.0} standard deviations of what is assumed lie between the file's value and that of {}: look whether the file is of this rig, and what else could do the same.", found.far_off.join(", "))
    });
    [incline, held, far].into_iter().flatten().collect()
}
