//! The studies, in the order of the thesis.

mod models;
mod operation;
mod published;

use super::{Study, Variant};

/// All studies.
pub const STUDIES: [&Study; 12] = [
    &published::LUT_STEPPER,
    &published::LUT_SOLENOID,
    &published::BURROWS,
    &operation::SOFT_SPRING,
    &operation::IMPULSE,
    &operation::REDUCED_GAIN,
    &operation::NULL_LEARNING,
    &operation::STEP_TIME,
    &operation::POSITIVE_GAIN,
    &models::CONTINUOUS,
    &models::EMPIRICAL_OPERATOR,
    &models::LEAKAGE,
];

/// Servo-drive B with the printed profile, and hysteresis and stiction as they were measured.
const THESIS: Variant = drive("thesis", &[]);

/// Servo-drive B of the thesis with settings.
const fn drive(name: &'static str, settings: &'static [&'static str]) -> Variant {
    Variant { name, rig: "servo-b-thesis", settings }
}

/// The step test with moves of 2.4 s: long enough to see whether the drive comes to rest.
const LONG_STEPS: &str = "test.moves=[[0.0, 8192], [0.3, 16384], [2.7, 8192]]";
const LONG_STEPS_TIME: &str = "test.duration_s=5.1";

/// Whether something grows with a change; None if it differs by less than that, or the runs do not show it.
fn grows(own: Option<f64>, changed: Option<f64>, least: f64) -> Option<bool> {
    let by = changed? - own?;
    (by.abs() > least).then_some(by > 0.0)
}

/// A swing that differs by less is the same, mm: two counts.
const SAME_MM: f64 = 0.025;
