//! Verification against published data (7.3): the studies of the drives that others measured.

use crate::study_exhibit::of_study;
use crate::{Entry, Exhibit};

/// Results for which a study has no number.
const NO_NUMBERS: &[Entry] = &[];

pub(super) const EXHIBITS: [Exhibit; 3] = [
    Exhibit {
        about: "LUT drive with a stepper operated valve",
        lost: "the measured and the simulated responses",
        why: "",
        takes_s: 0.1,
        ..of_study("lut-stepper", "7.3.1", "Fig. 7.20, 7.21", NO_NUMBERS)
    },
    Exhibit {
        about: "LUT drive with a solenoid operated valve",
        lost: "the measured and the simulated responses",
        why: "",
        takes_s: 3.4,
        ..of_study("lut-solenoid", "7.3.2", "Fig. 7.22, 7.23", NO_NUMBERS)
    },
    Exhibit {
        about: "The on-off drive of Burrows",
        lost: "the reported and the simulated position error",
        why: "",
        takes_s: 0.2,
        ..of_study("burrows", "7.3.3", "Fig. 7.24, 7.25", NO_NUMBERS)
    },
];
