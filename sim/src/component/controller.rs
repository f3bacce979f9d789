//! The controller's part of a rig file. Its law is the crate `pneudrive-controller`, whose table of parameters has most of
//! its keys; [`crate::rig`] makes the parameters of them.

pub use pneudrive_controller::choice::{Adapt, HomingKind, Law, Loop};
use pneudrive_controller::parameter_table;
use pneudrive_controller::parameters::{DEFAULT_PROFILE, Parameter, id, line};

use crate::key::{Kind, Preset, Typed, keys, of_line, words};
use crate::values::{Findings, Rig, whole_microseconds};

words! {
    /// Which controller drives the plant.
    pub enum ControllerKind {
        /// The one that is flashed, at its samples.
        Sampled = "sampled",
        /// The simulator's own, in floats, at all times.
        Continuous = "continuous",
    }
}

/// Declares what is not a parameter by itself, behind the lines of the controller's table.
macro_rules! keys_of_controller {
    (controller $parameters:tt $($other:tt)+) => {
        keys! {
            $parameters
            MODEL: ControllerKind = choice("controller.model", "L(22), L(4)", "Sampled: the controller that is flashed. Continuous: the simulator's own, in floats.");
            CLOCK_ERROR_PERCENT: f64 = number("controller.clock_error_percent", 0.0, -10.0, 10.0, "", "How much longer a second of the controller's clock really is; the controller does not know it. Times of test, trace and records are those of its clock.");
            CLOCK_TOLERANCE_PERCENT: f64 = number("controller.clock_tolerance_percent", 0.5, 0.0, 10.0, "", "How far that clock may be off, for identify. 0.5 is an assumption: that of a ceramic resonator. A crystal has 0.005, an RC oscillator 1 and more; 0: exact.");
            START_S: f64 = number("controller.start_s", 0.0, 0.0, 60.0, "C(40)", "Time for which the drive runs with its valve at the null before the first sample, from the initial state of the test; whole microseconds. Times of test, trace and faults count from the first sample.");
            GAIN_PROFILE: Vec<i64> = gain_profile().chosen_by(&LAW, &[Law::GainProfile.word()]);
            LEARN_NULL_OFFSET: bool = switch("controller.learn_null_offset", false, "8.2.3", "Whether the controller learns the command at which the valve is at its null.");
            LEARNING_GAIN: i64 = integer("controller.learning_gain", 256, 1, line(id::LEARNING_GAIN).max as i64, "8.2.3", "Part of the error at rest that is added to the null offset, divided by the scale; 1 in the thesis, which has no effect within a day.");
            CASCADE_DEAD_TIME_FACTOR: f64 = number("controller.cascade_dead_time_factor", 1.0, 0.5, 3.0, "", "How much longer than by the rig file the law cascade takes the dead time of its force loop to be. All its poles are parts of its inverse.").chosen_by(&LAW, &[Law::Cascade.word()]);
            CASCADE_FLOW_SHARE: f64 = number("controller.cascade_flow_share", 0.4, 0.05, 0.8, "", "What the trajectories of the law cascade ask of the drive: this part of the force and of the rate of the force that there are, and 1.25 times as large a part of the speed.").chosen_by(&LAW, &[Law::Cascade.word()]);
            CASCADE_OBSERVER_FACTOR: f64 = number("controller.cascade_observer_factor", 1.0, 0.2, 2.0, "", "How much faster than usual the observers of the law cascade are; less than 1 smooths more.").chosen_by(&LAW, &[Law::Cascade.word()]);
            PRESSURE_FEEDBACK_GAIN: f64 = number("controller.pressure_feedback_gain", 12.4, 0.0, 1e6, "C(68)", "Counts of error that a kPa of quasi-transient pressure difference subtracts: it damps (9.1.2). 12.4 is Burrows' k5 and the default of the on-off law (the thesis does not give its unit); 0 is that of the other laws.");
        }
    };
}

parameter_table!(keys_of_controller);

/// The gains that the file gives, from the smallest errors on.
const fn gain_profile() -> Typed<Vec<i64>> {
    let Parameter { min, max, len, .. } = line(id::GAIN_PROFILE);
    let kind = Kind::Integers { min: min as i64, max: max as i64, max_entries: len as usize };
    of_line(id::GAIN_PROFILE, kind, Preset::Integers(&PROFILE))
}

/// Those of Appendix IX; the rest is as the last one.
const PROFILE: [i64; DEFAULT_PROFILE.len()] = {
    let mut profile = [0; DEFAULT_PROFILE.len()];
    let mut entry = 0;
    while entry < profile.len() {
        profile[entry] = DEFAULT_PROFILE[entry] as i64;
        entry += 1;
    }
    profile
};

/// The constraints on the clock of the controller.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    for key in [&keys::PERIOD_S, &keys::START_S, &keys::DELAY_S] {
        if whole_microseconds(rig.get(key)).is_none() {
            findings.note(key, "must be a whole number of microseconds");
        }
    }
    let why = "a command is driven before the next sample";
    findings.below(rig, &keys::DELAY_S, &keys::PERIOD_S, why);
    if rig.get(&keys::CLOCK_ERROR_PERCENT) != 0.0 && rig.get(&keys::MODEL) == ControllerKind::Continuous {
        let message = "must be 0 with controller.model = \"continuous\", which has no clock";
        findings.note(&keys::CLOCK_ERROR_PERCENT, message);
    }
}
