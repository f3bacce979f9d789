//! The studies, in the order of the thesis.

mod drives;
mod growth;
mod models;
mod operation;
mod published;

use super::Study;

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
