//! Errors of scale and offset of the sensors and of the clock: unknowns of every fit, within what data sheets allow.
//!
//! ```text
//! r(u, e)                     residuals with errors e of encoder, pressure sensors, spool sensor and clock
//! minimise  sum of r^2 + sum of u^2 + sum of ((e - file's) / tolerance)^2
//! C = ([J E]' [J E] + L)^-1   E: derivatives by the errors; L has 1 / tolerance^2 of each
//! ```
//!
//! The block of C that belongs to the parameters is that of the Schur complement, so intervals carry what the data cannot tell
//! from an error of calibration. Where a tolerance is 0 the error is no unknown. An error of more than [`FAR`] tolerances is a
//! cause of a misfit, and reported as one ([`super::causes`]).

use pneudrive_sim::Rig;
use pneudrive_sim::key::Typed;
use pneudrive_sim::keys::{controller, encoder, sensors};

use super::FAR;
use super::derivatives::Column;
use super::model::FittedModel;
use super::parameter::Parameter;

/// An error changes nothing if one of the size of its tolerance changes the data by less, in standard deviations of noise.
const NOTHING: f64 = 1e-3;

/// An error of calibration.
pub(super) struct Item {
    /// The key of the rig file that holds the error.
    pub error: &'static Typed<f64>,
    /// The key of its tolerance.
    tolerance: &'static Typed<f64>,
    /// Difference for a derivative, and the longest step of a search, in the unit of the key.
    difference: f64,
    longest: f64,
    /// The error in words.
    pub name: &'static str,
    /// How to measure it without a fit.
    pub measure: &'static str,
}

const fn item(
    (error, tolerance): (&'static Typed<f64>, &'static Typed<f64>),
    [difference, longest]: [f64; 2],
    (name, measure): (&'static str, &'static str),
) -> Item {
    Item { error, tolerance, difference, longest, name, measure }
}

const GAUGE: &str = "compare the reading with a gauge at two pressures, one of them that of the room";

/// All of them.
pub(super) static ITEMS: [Item; 9] = [
    item(
        (&controller::CLOCK_ERROR_PERCENT, &controller::CLOCK_TOLERANCE_PERCENT),
        [0.003, 1.0],
        (
            "another period of the clock",
            "count the samples of a minute by another clock, or measure the output of the timer",
        ),
    ),
    item(
        (&encoder::SCALE_ERROR_PERCENT, &encoder::SCALE_TOLERANCE_PERCENT),
        [0.003, 1.0],
        ("another scale of the encoder", "compare its travel from end to end with a rule or a gauge"),
    ),
    item(
        (&encoder::OFFSET_ERROR_MM, &encoder::OFFSET_TOLERANCE_MM),
        [0.001, 0.5],
        ("another zero of the encoder", "read it with the piston at the retracted end"),
    ),
    item(
        (&sensors::PRESSURE_1_GAIN_ERROR_PERCENT, &sensors::PRESSURE_GAIN_TOLERANCE_PERCENT),
        [0.003, 1.0],
        ("another scale of pressure sensor 1", GAUGE),
    ),
    item(
        (&sensors::PRESSURE_1_OFFSET_ERROR_PA, &sensors::PRESSURE_OFFSET_TOLERANCE_PA),
        [10.0, 5e3],
        ("another zero of pressure sensor 1", "vent the chamber and read a barometer"),
    ),
    item(
        (&sensors::PRESSURE_2_GAIN_ERROR_PERCENT, &sensors::PRESSURE_GAIN_TOLERANCE_PERCENT),
        [0.003, 1.0],
        ("another scale of pressure sensor 2", GAUGE),
    ),
    item(
        (&sensors::PRESSURE_2_OFFSET_ERROR_PA, &sensors::PRESSURE_OFFSET_TOLERANCE_PA),
        [10.0, 5e3],
        ("another zero of pressure sensor 2", "vent the chamber and read a barometer"),
    ),
    item(
        (&sensors::SPOOL_GAIN_ERROR_PERCENT, &sensors::SPOOL_GAIN_TOLERANCE_PERCENT),
        [0.003, 1.0],
        ("another scale of the spool's sensor", "read it with the spool at both of its stops"),
    ),
    item(
        (&sensors::SPOOL_OFFSET_ERROR_MM, &sensors::SPOOL_OFFSET_TOLERANCE_MM),
        [1e-4, 0.05],
        ("another zero of the spool's sensor", "read it with the amplifier off"),
    ),
];

/// The error with a key.
pub(super) fn item_of(path: &str) -> Option<&'static Item> {
    ITEMS.iter().find(|item| item.error.path == path)
}

/// What was found of an error of calibration.
#[derive(Clone, Debug)]
pub struct Calibrated {
    /// The error, with the file's value.
    pub parameter: Parameter,
    /// The error in words.
    pub name: &'static str,
    /// Tolerance: its standard deviation before there are data, in the unit of the key.
    pub tolerance: f64,
    /// The estimate, in the unit of the key.
    pub value: f64,
    /// Its standard error, in the unit of the key.
    pub standard_error: f64,
    /// Whether it is farther from the file's than [`FAR`] tolerances.
    pub is_far: bool,
    /// How to measure it without a fit.
    pub measure: &'static str,
}

impl Calibrated {
    /// The error that parameter `parameter` of a model is, found at `u` with a standard error in u; None of another one.
    pub(super) fn of(parameter: &Parameter, u: f64, standard_error: f64) -> Option<Calibrated> {
        let Item { name, measure, .. } = item_of(parameter.key.path)?;
        let tolerance = parameter.slope(u);
        let standard_error = standard_error * tolerance;
        let (value, is_far) = (parameter.value(u), u.abs() > FAR);
        Some(Calibrated {
            name,
            measure,
            tolerance,
            value,
            standard_error,
            is_far,
            parameter: parameter.clone(),
        })
    }

    /// Whether the data tell more of it than its tolerance does.
    #[must_use]
    pub fn is_seen(&self) -> bool {
        self.standard_error < super::UNIDENTIFIABLE * self.tolerance
    }
}

/// The errors that a rig may have, each as an unknown.
fn unknown(rig: &Rig) -> Vec<Parameter> {
    let of = |item: &Item| {
        let tolerance = rig.get(item.tolerance);
        (tolerance > 0.0).then(|| {
            Parameter::calibration(rig, item.error.path, tolerance, [item.difference, item.longest])
        })?
    };
    ITEMS.iter().filter_map(of).collect()
}

/// Takes the errors that do something to the data among the unknowns of a model, and returns the point with them at the file's
/// values.
pub(super) fn freed(model: &mut FittedModel, from: Vec<f64>) -> Vec<f64> {
    let place = model.parameters.len();
    let all = unknown(&model.rig);
    if all.is_empty() {
        return from;
    }
    let mut u = from.clone();
    u.splice(place..place, vec![0.0; all.len()]);
    let wider = model.with(&all);
    let Some(residuals) = wider.residuals_at(&u) else { return from };
    let columns = wider.columns(&u, &residuals, place..place + all.len());
    let does = |column: Option<Column>| column.is_some_and(|column| column.rows.norm() > NOTHING);
    let seen: Vec<_> =
        all.into_iter().zip(columns).filter_map(|(error, column)| does(column).then_some(error)).collect();
    let mut u = from;
    u.splice(place..place, vec![0.0; seen.len()]);
    *model = model.with(&seen);
    u
}

impl FittedModel<'_> {
    /// The place of a calibration error among the unknowns.
    pub(super) fn place_of_error(&self, path: &str) -> Option<usize> {
        self.parameters.iter().position(|parameter| parameter.is_calibration && parameter.key.path == path)
    }

    /// Whether a calibration error is farther from the file's than its tolerance makes likely.
    pub(super) fn has_far_error(&self, u: &[f64]) -> bool {
        self.parameters.iter().zip(u).any(|(parameter, u)| parameter.is_calibration && u.abs() > FAR)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_an_unknown_unless_the_file_says_that_there_is_none() {
        let unknown = |text: &str| unknown(&Rig::read("test", text).expect("valid")).len();
        assert_eq!(unknown(""), ITEMS.len());
        assert_eq!(unknown("[sensors]\npressure_gain_tolerance_percent = 0\n"), ITEMS.len() - 2);
    }

    #[test]
    fn an_error_of_its_tolerance_is_one_standard_deviation_from_what_the_file_says() {
        let text = "[encoder]\nscale_error_percent = 0.2\nscale_tolerance_percent = 0.05\n";
        let all = unknown(&Rig::read("test", text).expect("valid"));
        let scale = all.iter().find(|p| p.key.path == "encoder.scale_error_percent").expect("unknown");
        assert!((scale.value(0.0) - 0.2).abs() < 1e-12 && (scale.value(1.0) - 0.25).abs() < 1e-12);
        assert_eq!(scale.prior, 1.0);
        assert!(Calibrated::of(scale, 3.1, 0.1).expect("an error").is_far);
        assert!(!Calibrated::of(scale, 2.9, 0.6).expect("an error").is_seen());
    }
}
