//! What a fit tells of the errors of scales, offsets and clock.

use super::cells::{digits, table};
use crate::calibration::Calibrated;
use crate::posterior::NORMAL_95;
use crate::{FAR, Identification};
use pneudrive_report::Table;

/// The errors that the data tell of, or that intervals rest on.
pub(super) fn calibration(found: &Identification) -> Table {
    let rests = |error: &Calibrated| {
        let shares = found.estimates.iter().flat_map(|estimate| &estimate.rests_on);
        shares.into_iter().any(|share| share.path == error.parameter.key.path)
    };
    let row = |error: &Calibrated| {
        let told = if error.is_seen() { "the data" } else { "the tolerance alone" };
        vec![
            error.parameter.key.path.to_owned(),
            digits(error.parameter.start),
            error.parameter.assumed_within(),
            format!("{} +- {:.1e}", digits(error.value), NORMAL_95 * error.standard_error),
            told.to_owned(),
            error.measure.to_owned(),
        ]
    };
    let told = found.calibration.iter().filter(|error| error.is_seen() || error.is_far || rests(error));
    let columns = ["error", "file", "tolerance", "found, 95 %", "told by", "how to measure it"];
    table("calibration: errors of scales, offsets and clock", &columns, told.map(row).collect())
}

/// The note on those beyond their tolerances; None if there are none.
pub(super) fn beyond_tolerance(found: &Identification) -> Option<String> {
    let far: Vec<String> = found.calibration.iter().filter(|error| error.is_far).map(said).collect();
    (!far.is_empty()).then(|| {
        format!("Beyond {FAR:.0} tolerances of the rig file: {}. Either the calibration of the file is wrong, or something else is that looks like it. Measure it as its table says, and write what you find to the file.", far.join("; "))
    })
}

fn said(error: &Calibrated) -> String {
    let Calibrated { parameter, name, value, standard_error, measure, .. } = error;
    format!(
        "{name} ({} = {} +- {:.1e} {}, tolerance {}; to measure it: {measure})",
        parameter.key.path,
        digits(*value),
        NORMAL_95 * standard_error,
        parameter.key.unit(),
        parameter.assumed_within()
    )
}
