//! The controller's part of a rig file. Its law is the crate `pneudrive-controller`; its parameters are made in
//! [`crate::rig`] from these keys.

use crate::key::{Kind, Preset, keys, words};
use crate::values::{Findings, Rig, whole_microseconds};

const GAIN: i64 = u16::MAX as i64;
const COUNT: i64 = i32::MAX as i64;
const PROFILE: &[i64] = &[8192, 6144, 4096, 2048, 1280, 768, 512, 384, 320, 288, 256];

words! {
    /// Which controller drives the plant.
    pub enum Model {
        /// The one that is flashed, at its samples.
        Sampled = "sampled",
        /// The simulator's own, in floats, at all times.
        Continuous = "continuous",
    }
}

words! {
    /// How the position error becomes a demand.
    pub enum Law {
        /// A gain for each span of error.
        GainProfile = "gain-profile",
        /// One gain.
        Proportional = "proportional",
        /// Moore's: one gain, and a step across the dead zone of the valve.
        MooreProportional = "moore-proportional",
        /// A relay, Burrows' with pressure feedback.
        OnOff = "on-off",
    }
}

words! {
    /// Whether the position is fed back.
    pub enum Loop {
        /// It is: moves are setpoints.
        Closed = "closed",
        /// It is not: moves are valve commands.
        Open = "open",
    }
}

words! {
    /// Where a homing run ends.
    pub enum Homing {
        /// Against a stop.
        Stop = "stop",
        /// At the edge of a switch.
        Switch = "switch",
    }
}

keys! {
    MODEL: Model = choice("controller.model", "L(22), L(4)", "Sampled: the controller that is flashed. Continuous: the simulator's own, in floats.");
    LAW: Law = choice("controller.law", "L(22), L(8)", "How the position error becomes a demand. The variable dead band gain of 6.3.3 has no equation there; dead_band_counts, or zeros at the head of gain_profile, give a fixed one.");
    LOOP: Loop = choice("controller.loop", "L(3)", "Open: moves are valve commands, nothing is fed back.");
    PERIOD_S: f64 = number("controller.period_s", 0.0013, 1e-4, 0.1, "C(41)", "Sample period; whole microseconds.");
    CLOCK_ERROR_PERCENT: f64 = number("controller.clock_error_percent", 0.0, -10.0, 10.0, "", "How much longer a second of the controller's clock really is; the controller does not know it. Times of test, trace and records are those of its clock.");
    CLOCK_TOLERANCE_PERCENT: f64 = number("controller.clock_tolerance_percent", 0.5, 0.0, 10.0, "", "How far that clock may be off, for identify. 0.5 is an assumption: that of a ceramic resonator. A crystal has 0.005, an RC oscillator 1 and more; 0: exact.");
    START_S: f64 = number("controller.start_s", 0.0, 0.0, 60.0, "C(40)", "Time for which the drive runs with its valve at the null before the first sample, from the initial state of the test; whole microseconds. Times of test, trace and faults count from the first sample.");
    DELAY_S: f64 = number("controller.delay_s", 0.0005, 1e-6, 0.099_999, "C(26)", "From a sample to its output; whole microseconds, less than the period.");
    GAIN_PROFILE: Vec<i64> = other("controller.gain_profile", Kind::Integers { min: 0, max: GAIN, max_entries: 256 }, Preset::Integers(PROFILE), "Kp(0)..Kp(255)", "Gain on the error, an entry for each span of error; the last one repeats to 256 entries.");
    PROFILE_SPAN_COUNTS: i64 = integer("controller.profile_span_counts", 4, 1, 65_535, "L(67)", "Range of error that one entry of the gain profile covers.");
    PROPORTIONAL_GAIN: i64 = integer("controller.proportional_gain", 1, 0, GAIN, "C(21)", "Gain of the laws without a profile.");
    DEAD_ZONE_COUNTS: i64 = integer("controller.dead_zone_counts", 102, 0, 2048, "", "Moore's law adds it in the direction of the error: what takes the spool across its dead zone. 102 for the DAC, 4 steps for the stepper: 0.05 mm, half of the hysteresis C(29).");
    VELOCITY_GAIN: i64 = integer("controller.velocity_gain", 1, 0, GAIN, "C(43)", "Gain on counts per velocity window; the thesis's 1 gives no damping, about 1000 does.");
    ACCELERATION_GAIN: i64 = integer("controller.acceleration_gain", 1, 0, GAIN, "C(44)", "Gain on counts per velocity and acceleration window.");
    VELOCITY_FEED_FORWARD: i64 = integer("controller.velocity_feed_forward", 0, 0, GAIN, "", "Gain on the setpoint's own counts per velocity window while a profile moves it; as much as velocity_gain takes the damping off that motion.");
    ACCELERATION_FEED_FORWARD: i64 = integer("controller.acceleration_feed_forward", 0, 0, GAIN, "", "Gain on the setpoint's own counts per velocity and acceleration window while a profile moves it.");
    VELOCITY_WINDOW_SAMPLES: i64 = integer("controller.velocity_window_samples", 5, 1, 63, "L(52)", "Samples over which the velocity is a difference of counts.");
    ACCELERATION_WINDOW_SAMPLES: i64 = integer("controller.acceleration_window_samples", 3, 1, 63, "L(77)", "Samples over which the acceleration is a difference of velocities.");
    VELOCITY_DEAD_BAND: i64 = integer("controller.velocity_dead_band", 0, 0, COUNT, "C(45)", "Velocities below it, in counts per velocity window, count as standstill; 0: off.");
    SCALE: i64 = integer("controller.scale", 256, 1, COUNT, "L(68)", "The law's sum is divided by it: 256 for the DAC, 65536 for the stepper.");
    DEAD_BAND_COUNTS: i64 = integer("controller.dead_band_counts", 0, 0, COUNT, "C(27)", "Errors below it ask for nothing; 0: off. For the on-off law the dead zone of its relay.");
    RELAY_HYSTERESIS_COUNTS: i64 = integer("controller.relay_hysteresis_counts", 0, 0, COUNT, "", "The relay of the on-off law drops out this much below dead_band_counts, at which it picks up.");
    NULL_OFFSET_COUNTS: i64 = integer("controller.null_offset_counts", 0, -2048, 2048, "8.2.3", "Command at which the valve is at its null; added to the demand.");
    FORCED_EXIT_S: f64 = number("controller.forced_exit_s", 1.42, 1e-3, 1e4, "C(31)", "Time for each of test.targets.");
    EXIT_ON_DEAD_BAND: bool = switch("controller.exit_on_dead_band", false, "L(11)", "Whether a target also ends when it has arrived: tolerance_counts, monitoring_s, dwell_s; with test.targets.");
    TOLERANCE_COUNTS: i64 = integer("controller.tolerance_counts", 8, 0, COUNT, "C(27)", "A move has arrived inside this error; without it that of dead_band_counts, if there is one.");
    MONITORING_S: f64 = number("controller.monitoring_s", 0.0, 0.0, 2000.0, "", "Exact stop: time inside the tolerance after which a move has arrived. 0: fast stop, at the first sample inside.");
    DWELL_S: f64 = number("controller.dwell_s", 0.0, 0.0, 2000.0, "", "From the arrival at a target to the next one.");
    LEARN_NULL_OFFSET: bool = switch("controller.learn_null_offset", false, "8.2.3", "Whether the controller learns the command at which the valve is at its null.");
    LEARNING_GAIN: i64 = integer("controller.learning_gain", 256, 1, GAIN, "8.2.3", "Part of the error at rest that is added to the null offset, divided by the scale; 1 in the thesis, which has no effect within a day.");
    HOMING: Homing = choice("controller.homing", "", "Where a homing run ends: against a stop, or at the edge of a switch.");
    HOMING_COMMAND_COUNTS: i64 = integer("controller.homing_command_counts", -200, -2048, 2048, "", "Valve command of the homing run, not 0; its sign is the direction. -200 for the DAC, -4 for the stepper.");
    HOMING_POSITION_COUNTS: i64 = integer("controller.homing_position_counts", 0, -COUNT, COUNT, "", "The position where the homing run ends.");
    HOMING_BACK_OFF_COUNTS: i64 = integer("controller.homing_back_off_counts", 400, 1, COUNT, "", "A homing run goes so far back from where it has found its stop or switch, and must find it again at the same place.");
    HOMING_STILL_S: f64 = number("controller.homing_still_s", 0.5, 0.001, 3600.0, "", "Standing still for so long is being at the stop.");
    HOMING_TIMEOUT_S: f64 = number("controller.homing_timeout_s", 10.0, 0.001, 3600.0, "", "A longer homing run trips.");
    PRESSURE_FEEDBACK_GAIN: f64 = number("controller.pressure_feedback_gain", 12.4, 0.0, 1e6, "C(68)", "Counts of error that a kPa of quasi-transient pressure difference subtracts: it damps (9.1.2). 12.4 is Burrows' k5 and the default of the on-off law (the thesis does not give its unit); 0 is that of the other laws.");
}

/// What the clock of the controller must hold.
pub(crate) fn check(rig: &Rig, findings: &mut Findings) {
    for key in [&keys::PERIOD_S, &keys::START_S, &keys::DELAY_S] {
        if whole_microseconds(rig.get(key)).is_none() {
            findings.note(key, "must be a whole number of microseconds");
        }
    }
    let why = "a command is driven before the next sample";
    findings.below(rig, &keys::DELAY_S, &keys::PERIOD_S, why);
    if rig.get(&keys::CLOCK_ERROR_PERCENT) != 0.0 && rig.get(&keys::MODEL) == Model::Continuous {
        let message = "must be 0 with controller.model = \"continuous\", which has no clock";
        findings.note(&keys::CLOCK_ERROR_PERCENT, message);
    }
}
