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

/// Servo-drive B with the gains of Appendix IX: it vibrates.
const APPENDIX_GAINS: Variant = Variant { name: "Appendix IX", rig: "servo-b", settings: &[] };

/// Servo-drive B with gains at which it comes to rest, as in Fig. 7.18.
const TUNED: Variant = Variant { name: "tuned", rig: "servo-b-tuned", settings: &[] };
