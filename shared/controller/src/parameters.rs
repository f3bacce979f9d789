//! The one table of the controller's parameters.
//!
//! It serves `config get/set/export/import`, storage as (id, value) pairs, the header of TARGET
//! files and help. Ids are stored and sent: they never change and are never used again. Values are
//! `i32`, whatever the type they become in [`Config`](crate::Config).

use crate::law::PROFILE_LEN;

/// Ids of the parameters, in the order of the table.
pub mod id {
    #![allow(missing_docs)] // The table below says what each one means.
    pub const PERIOD_US: u16 = 1;
    pub const DELAY_US: u16 = 2;
    pub const OPEN_LOOP: u16 = 3;
    pub const LAW: u16 = 4;
    pub const PROFILE_SPAN_COUNTS: u16 = 5;
    pub const PROPORTIONAL_GAIN: u16 = 6;
    pub const VELOCITY_GAIN: u16 = 7;
    pub const ACCELERATION_GAIN: u16 = 8;
    pub const VELOCITY_WINDOW_SAMPLES: u16 = 9;
    pub const ACCELERATION_WINDOW_SAMPLES: u16 = 10;
    pub const VELOCITY_DEAD_BAND: u16 = 11;
    pub const DEAD_BAND_COUNTS: u16 = 12;
    pub const SCALE: u16 = 13;
    pub const NULL_OFFSET_COUNTS: u16 = 14;
    pub const POSITION_MIN_COUNTS: u16 = 15;
    pub const POSITION_MAX_COUNTS: u16 = 16;
    pub const ENCODER_STEP_COUNTS: u16 = 17;
    pub const LATE_SAMPLE_US: u16 = 18;
    pub const HOST_SILENCE_MS: u16 = 19;
    pub const NULL_CODE: u16 = 20;
    pub const OUTPUT_INVERTED: u16 = 21;
    pub const ENCODER_INVERTED: u16 = 22;
    pub const ENCODER_PM_PER_COUNT: u16 = 23;
    pub const SENSOR_BITS: u16 = 24;
    pub const PRESSURE_MIN_PA: u16 = 25;
    pub const PRESSURE_MAX_PA: u16 = 26;
    pub const SPOOL_MIN_NM: u16 = 27;
    pub const SPOOL_MAX_NM: u16 = 28;
    pub const STEPPER: u16 = 29;
    pub const MAX_STEPS: u16 = 30;
    pub const DEAD_ZONE_COUNTS: u16 = 31;
    pub const RELAY_HYSTERESIS_COUNTS: u16 = 32;
    pub const PRESSURE_FEEDBACK_GAIN: u16 = 33;
    pub const TOLERANCE_COUNTS: u16 = 34;
    pub const MONITORING_US: u16 = 35;
    pub const DWELL_US: u16 = 36;
    pub const FORCED_EXIT_US: u16 = 37;
    pub const ON_ARRIVAL: u16 = 38;
    pub const LEARNING_GAIN: u16 = 39;
    pub const END_MIN_COUNTS: u16 = 40;
    pub const END_MAX_COUNTS: u16 = 41;
    pub const SENSOR_LOW_RAW: u16 = 42;
    pub const SENSOR_HIGH_RAW: u16 = 43;
    pub const SENSOR_SAMPLES: u16 = 44;
    pub const NO_MOTION_MS: u16 = 45;
    pub const HOMING_SWITCH: u16 = 46;
    pub const HOMING_COMMAND_COUNTS: u16 = 47;
    pub const HOMING_POSITION_COUNTS: u16 = 48;
    pub const HOMING_STILL_MS: u16 = 49;
    pub const HOMING_TIMEOUT_MS: u16 = 50;
    pub const PULSE_WIDTH_US: u16 = 51;
    pub const DIRECTION_SETUP_US: u16 = 52;
    pub const NO_MOTION_COUNTS: u16 = 53;
    pub const HOLD_MS: u16 = 54;
    pub const LATE_OUTPUT_US: u16 = 55;
    pub const HOMING_BACK_OFF_COUNTS: u16 = 56;
    pub const VELOCITY_FEED_FORWARD: u16 = 57;
    pub const ACCELERATION_FEED_FORWARD: u16 = 58;
    pub const ENCODER_MODEL: u16 = 59;
    pub const ENCODER_ZERO_COUNTS: u16 = 60;
    pub const PRESSURE_SENSORS: u16 = 61;
    pub const PRESSURE_DAMPING_GAIN: u16 = 62;
    pub const INPUT_DEBOUNCE_MS: u16 = 63;
    pub const INPUT_SETTLING_MS: u16 = 64;
    /// Entry 0; entry i has the id `GAIN_PROFILE + i`.
    pub const GAIN_PROFILE: u16 = 256;
}

/// One line of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// What it is stored and sent under; an array has consecutive ids from here on.
    pub id: u16,
    /// Name as users type it.
    pub name: &'static str,
    /// Entries: 1, or the length of an array.
    pub len: u16,
    /// Unit, or "" for a plain number.
    pub unit: &'static str,
    /// Smallest allowed value.
    pub min: i32,
    /// Largest allowed value.
    pub max: i32,
    /// Value of a new controller (thesis Appendix VII where it has one).
    pub default: i32,
    /// What it does.
    pub meaning: &'static str,
    /// Name in the thesis, or "".
    pub thesis: &'static str,
}

/// A scalar line, in the order the table is read in.
macro_rules! scalar {
    ($id:ident, $name:literal, $unit:literal, $min:expr, $max:expr, $default:expr, $thesis:literal, $meaning:literal) => {
        Parameter {
            id: id::$id,
            name: $name,
            len: 1,
            unit: $unit,
            min: $min,
            max: $max,
            default: $default,
            meaning: $meaning,
            thesis: $thesis,
        }
    };
}

const COUNT_MAX: i32 = i32::MAX;
const GAIN_MAX: i32 = u16::MAX as i32;
const WINDOW_MAX: i32 = crate::estimator::MAX_WINDOW_SAMPLES as i32;
const COMMAND_MAX: i32 = crate::drive::MAX_COUNTS as i32;
const RAW_MAX: i32 = i16::MAX as i32;
const TIME_MAX: i32 = i32::MAX;
const SECOND_MS: i32 = 1000;
const HOUR_MS: i32 = 3_600_000;
const CODE_MAX: i32 = crate::drive::MAX_CODE as i32;

/// Scalars in the order of their ids (id - 1 is the place), then the gain profile.
#[rustfmt::skip]
pub static TABLE: [Parameter; 65] = [
    scalar!(PERIOD_US, "period_us", "us", 100, 100_000, 1300, "C(41)", "Sample period."),
    scalar!(DELAY_US, "delay_us", "us", 1, 99_999, 500, "C(26)", "From the sample to its output; less than the period."),
    scalar!(OPEN_LOOP, "open_loop", "", 0, 1, 0, "L(3)", "0: the law closes the loop. 1: moves are valve commands."),
    scalar!(LAW, "law", "", 0, 3, 0, "L(8), L(22)", "0: gain profile. 1: proportional. 2: Moore's proportional. 3: on-off."),
    scalar!(PROFILE_SPAN_COUNTS, "profile_span_counts", "counts", 1, 65_535, 4, "L(67)", "Range of error that one entry of the gain profile covers."),
    scalar!(PROPORTIONAL_GAIN, "proportional_gain", "", 0, GAIN_MAX, 1, "C(21)", "Gain of the laws without a profile."),
    scalar!(VELOCITY_GAIN, "velocity_gain", "", 0, GAIN_MAX, 1, "C(43)", "Gain on counts per velocity window."),
    scalar!(ACCELERATION_GAIN, "acceleration_gain", "", 0, GAIN_MAX, 1, "C(44)", "Gain on counts per velocity and acceleration window."),
    scalar!(VELOCITY_WINDOW_SAMPLES, "velocity_window_samples", "samples", 1, WINDOW_MAX, 5, "L(52)", "Samples over which the velocity is a difference of counts."),
    scalar!(ACCELERATION_WINDOW_SAMPLES, "acceleration_window_samples", "samples", 1, WINDOW_MAX, 3, "L(77)", "Samples over which the acceleration is a difference of velocities."),
    scalar!(VELOCITY_DEAD_BAND, "velocity_dead_band", "counts/window", 0, COUNT_MAX, 0, "C(45)", "Velocities below it count as standstill; 0: off."),
    scalar!(DEAD_BAND_COUNTS, "dead_band_counts", "counts", 0, COUNT_MAX, 0, "C(27)", "Errors below it ask for nothing; 0: off."),
    scalar!(SCALE, "scale", "", 1, COUNT_MAX, 256, "L(68)", "The law's sum is divided by it to give valve counts: 256 solenoid, 65536 stepper."),
    scalar!(NULL_OFFSET_COUNTS, "null_offset_counts", "counts", -COMMAND_MAX, COMMAND_MAX, 0, "8.2.3", "Added to the demand of a closed loop: the command at which the valve is at its null."),
    scalar!(POSITION_MIN_COUNTS, "position_min_counts", "counts", -COUNT_MAX, COUNT_MAX, -249, "", "Below it the supervisor trips."),
    scalar!(POSITION_MAX_COUNTS, "position_max_counts", "counts", -COUNT_MAX, COUNT_MAX, 25_145, "", "Above it the supervisor trips."),
    scalar!(ENCODER_STEP_COUNTS, "encoder_step_counts", "counts", 1, COUNT_MAX, 540, "", "A longer step in one sample trips the supervisor."),
    scalar!(LATE_SAMPLE_US, "late_sample_us", "us", 1, 100_000, 100, "", "A sample later than this trips the supervisor."),
    scalar!(HOST_SILENCE_MS, "host_silence_ms", "ms", 0, HOUR_MS, 500, "", "Silence of the host that trips a running move or homing run; 0: off."),
    scalar!(NULL_CODE, "null_code", "", 0, CODE_MAX, 2048, "", "Code of the converter at which the valve is at its null."),
    scalar!(OUTPUT_INVERTED, "output_inverted", "", 0, 1, 0, "", "1: a larger code retracts."),
    scalar!(ENCODER_INVERTED, "encoder_inverted", "", 0, 1, 0, "", "1: the encoder counts down when the rod extends."),
    scalar!(ENCODER_PM_PER_COUNT, "encoder_pm_per_count", "pm", 1, i32::MAX, 12_050_000, "C(42)", "Stroke per encoder count."),
    scalar!(SENSOR_BITS, "sensor_bits", "bits", 8, 15, 12, "", "Width of the converter of the pressure and spool sensors."),
    scalar!(PRESSURE_MIN_PA, "pressure_min_pa", "Pa", 0, i32::MAX, 0, "", "Absolute pressure at raw 0."),
    scalar!(PRESSURE_MAX_PA, "pressure_max_pa", "Pa", 1, i32::MAX, 1_000_000, "", "Absolute pressure at full scale."),
    scalar!(SPOOL_MIN_NM, "spool_min_nm", "nm", i32::MIN, i32::MAX, -1_250_000, "", "Spool displacement at raw 0."),
    scalar!(SPOOL_MAX_NM, "spool_max_nm", "nm", i32::MIN, i32::MAX, 1_250_000, "", "Spool displacement at full scale."),
    scalar!(STEPPER, "stepper", "", 0, 1, 0, "L(22)", "0: a DAC drives the valve. 1: a stepper does."),
    scalar!(MAX_STEPS, "max_steps", "steps", 1, COMMAND_MAX, 40, "L(20)", "Furthest location of a stepper from mid-travel."),
    scalar!(DEAD_ZONE_COUNTS, "dead_zone_counts", "counts", 0, COMMAND_MAX, 102, "", "Moore's law adds it in the direction of the error: what takes the spool across its dead zone (0.05 mm)."),
    scalar!(RELAY_HYSTERESIS_COUNTS, "relay_hysteresis_counts", "counts", 0, COUNT_MAX, 0, "", "The relay of the on-off law drops out this much below dead_band_counts, at which it picks up."),
    scalar!(PRESSURE_FEEDBACK_GAIN, "pressure_feedback_gain", "", 0, GAIN_MAX, 775, "C(68)", "Gain of the on-off law on the raw quasi-transient pressure difference."),
    scalar!(TOLERANCE_COUNTS, "tolerance_counts", "counts", 0, COUNT_MAX, 8, "", "A move has arrived inside this error."),
    scalar!(MONITORING_US, "monitoring_us", "us", 0, TIME_MAX, 0, "", "Exact stop: time inside the tolerance after which a move has arrived. 0: fast stop, at the first sample inside."),
    scalar!(DWELL_US, "dwell_us", "us", 0, TIME_MAX, 0, "", "From the arrival of a move to the next one, with on_arrival."),
    scalar!(FORCED_EXIT_US, "forced_exit_us", "us", 1, TIME_MAX, 1_420_000, "C(31)", "A move ends after this time, arrived or not, with on_arrival."),
    scalar!(ON_ARRIVAL, "on_arrival", "", 0, 1, 0, "L(11)", "0: moves begin at their times. 1: each also waits for the end of the one before."),
    scalar!(LEARNING_GAIN, "learning_gain", "", 0, GAIN_MAX, 0, "8.2.3", "How much of the error at rest goes into the null offset; 0: nothing is learned, 1: the thesis."),
    scalar!(END_MIN_COUNTS, "end_min_counts", "counts", -COUNT_MAX, COUNT_MAX, 0, "", "Software end position: a closed loop refuses lower setpoints, an open loop pushes no further."),
    scalar!(END_MAX_COUNTS, "end_max_counts", "counts", -COUNT_MAX, COUNT_MAX, 24_896, "", "The other software end position."),
    scalar!(SENSOR_LOW_RAW, "sensor_low_raw", "", -1, RAW_MAX, 63, "", "A pressure at or below it is that of an open sensor and trips; -1: off."),
    scalar!(SENSOR_HIGH_RAW, "sensor_high_raw", "", 1, RAW_MAX, 4032, "", "A pressure at or above it is that of a shorted sensor and trips; 32767: off."),
    scalar!(SENSOR_SAMPLES, "sensor_samples", "samples", 1, 10_000, 4, "", "Samples on end that a pressure must stay there to trip."),
    scalar!(NO_MOTION_MS, "no_motion_ms", "ms", 0, HOUR_MS, 500, "", "A closed loop that opens half of the valve or more and moves nothing for so long trips; with less of the valve it takes longer; 0: off."),
    scalar!(HOMING_SWITCH, "homing_switch", "", 0, 1, 0, "", "A homing run ends 0: at a stop, 1: at the edge of a switch."),
    scalar!(HOMING_COMMAND_COUNTS, "homing_command_counts", "counts", -COMMAND_MAX, COMMAND_MAX, -200, "", "Valve command towards the stop or the switch; not 0."),
    scalar!(HOMING_POSITION_COUNTS, "homing_position_counts", "counts", -COUNT_MAX, COUNT_MAX, 0, "", "The position there."),
    scalar!(HOMING_STILL_MS, "homing_still_ms", "ms", 1, HOUR_MS, 500, "", "Standing still for so long is being at the stop."),
    scalar!(HOMING_TIMEOUT_MS, "homing_timeout_ms", "ms", 1, HOUR_MS, 10_000, "", "A longer homing run trips."),
    scalar!(PULSE_WIDTH_US, "pulse_width_us", "us", 1, 1000, 10, "", "Length of a stepper's pulse."),
    scalar!(DIRECTION_SETUP_US, "direction_setup_us", "us", 1, 1000, 10, "", "A stepper's direction stands so long before the pulse."),
    scalar!(NO_MOTION_COUNTS, "no_motion_counts", "counts", 0, COUNT_MAX, 40, "", "So far from where it stood an axis has moved, for no_motion_ms and homing_still_ms: a stop gives way a little, and dither shakes."),
    scalar!(HOLD_MS, "hold_ms", "ms", 0, HOUR_MS, 60_000, "", "An enabled drive that stands, armed or holding its last setpoint, is disarmed this long after its host has gone."),
    scalar!(LATE_OUTPUT_US, "late_output_us", "us", 1, 100_000, 100, "", "An output that comes later than this behind its time is not driven and trips the supervisor."),
    scalar!(HOMING_BACK_OFF_COUNTS, "homing_back_off_counts", "counts", 1, COUNT_MAX, 400, "", "A homing run goes so far back from where it has found its stop or switch, and must find it again at the same place."),
    scalar!(VELOCITY_FEED_FORWARD, "velocity_feed_forward", "", 0, GAIN_MAX, 0, "", "Gain on the setpoint's own counts per velocity window while a profile moves it; 0: off."),
    scalar!(ACCELERATION_FEED_FORWARD, "acceleration_feed_forward", "", 0, GAIN_MAX, 0, "", "Gain on the setpoint's own counts per velocity and acceleration window while a profile moves it; 0: off."),
    scalar!(ENCODER_MODEL, "encoder_model", "", 0, 2, 0, "", "0: quadrature. 1: potentiometer. 2: SSI. The last two need no homing."),
    scalar!(ENCODER_ZERO_COUNTS, "encoder_zero_counts", "counts", -COUNT_MAX, COUNT_MAX, 0, "", "The position at count 0 of an absolute encoder."),
    scalar!(PRESSURE_SENSORS, "pressure_sensors", "", 0, 1, 1, "", "1: both pressures are measured. 0: none is; their inputs trip nothing and are recorded as 0."),
    scalar!(PRESSURE_DAMPING_GAIN, "pressure_damping_gain", "", 0, GAIN_MAX, 0, "9.1.2", "Gain of the laws but the on-off one on the raw quasi-transient pressure difference; 0: off."),
    scalar!(INPUT_DEBOUNCE_MS, "input_debounce_ms", "ms", 1, SECOND_MS, 10, "", "Digital inputs count once all of them have been the same for so long."),
    scalar!(INPUT_SETTLING_MS, "input_settling_ms", "ms", 1, SECOND_MS, 20, "", "A start begins its record once start and number have stayed for so long behind it."),
    Parameter {
        id: id::GAIN_PROFILE, name: "gain_profile", len: PROFILE_LEN as u16, unit: "", min: 0, max: GAIN_MAX,
        default: 256, thesis: "Kp(0)..Kp(255)",
        meaning: "Gain on the error; entry i holds from i to i + 1 spans, the last one beyond.",
    },
];

/// Appendix IX: the first entries of the default gain profile; the rest is 256.
const DEFAULT_PROFILE: [u16; 11] = [8192, 6144, 4096, 2048, 1280, 768, 512, 384, 320, 288, 256];

const SCALARS: usize = TABLE.len() - 1;

/// Why a value was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetError {
    /// There is no parameter of this id.
    UnknownId,
    /// The value is outside the range in the table.
    OutOfRange,
}

/// The line of the table that an id belongs to.
#[must_use]
pub fn lookup(id: u16) -> Option<&'static Parameter> {
    match place(id) {
        Place::Scalar(index) => TABLE.get(index).filter(|parameter| parameter.id == id),
        Place::Profile(index) => TABLE.last().filter(|profile| index < usize::from(profile.len)),
    }
}

/// The line of the table with a name.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Parameter> {
    TABLE.iter().find(|p| p.name == name)
}

/// The values of all parameters; each within its range, not yet checked against each other
/// ([`Config::new`](crate::Config::new) does that).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameters {
    scalars: [i32; SCALARS],
    pub(crate) gain_profile: [u16; PROFILE_LEN],
}

impl Default for Parameters {
    fn default() -> Self {
        let mut scalars = [0; SCALARS];
        for (value, parameter) in scalars.iter_mut().zip(&TABLE) {
            *value = parameter.default;
        }
        let mut gain_profile = [256; PROFILE_LEN];
        for (gain, default) in gain_profile.iter_mut().zip(DEFAULT_PROFILE) {
            *gain = default;
        }
        Parameters { scalars, gain_profile }
    }
}

/// Where the value of an id stands.
enum Place {
    Scalar(usize),
    Profile(usize),
}

fn place(id: u16) -> Place {
    match id.checked_sub(id::GAIN_PROFILE) {
        Some(entry) => Place::Profile(usize::from(entry)),
        None => Place::Scalar(usize::from(id).wrapping_sub(1)),
    }
}

impl Parameters {
    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, id: u16) -> Option<i32> {
        match place(id) {
            Place::Scalar(index) => self.scalars.get(index).copied(),
            Place::Profile(index) => self.gain_profile.get(index).map(|&gain| i32::from(gain)),
        }
    }

    /// Changes a parameter.
    ///
    /// # Errors
    /// For an unknown id, and for a value outside the range in the table; nothing is changed then.
    pub fn set(&mut self, id: u16, value: i32) -> Result<(), SetError> {
        let parameter = lookup(id).ok_or(SetError::UnknownId)?;
        if value < parameter.min || value > parameter.max {
            return Err(SetError::OutOfRange);
        }
        match place(id) {
            Place::Scalar(index) => {
                *self.scalars.get_mut(index).ok_or(SetError::UnknownId)? = value;
            }
            Place::Profile(index) => {
                let gain = u16::try_from(value).map_err(|_| SetError::OutOfRange)?;
                *self.gain_profile.get_mut(index).ok_or(SetError::UnknownId)? = gain;
            }
        }
        Ok(())
    }

    /// The position at count 0 of the encoder, if that is absolute.
    #[must_use]
    pub fn absolute_zero(&self) -> Option<i32> {
        (self.scalar(id::ENCODER_MODEL) != 0).then(|| self.scalar(id::ENCODER_ZERO_COUNTS))
    }

    /// The value of a scalar the table holds: 0 for an id that it does not.
    pub(crate) fn scalar(&self, id: u16) -> i32 {
        self.get(id).unwrap_or(0)
    }

    /// All (id, value) pairs in the order of the table: the form in which they are stored.
    pub fn iter(&self) -> impl Iterator<Item = (u16, i32)> + '_ {
        TABLE.iter().flat_map(|p| p.id..p.id + p.len).map(|id| (id, self.scalar(id)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_of_a_scalar_is_its_id_less_one() {
        for (index, parameter) in TABLE[..SCALARS].iter().enumerate() {
            assert_eq!(usize::from(parameter.id), index + 1, "{}", parameter.name);
            assert_eq!(parameter.len, 1);
        }
        assert_eq!(TABLE[SCALARS].id, id::GAIN_PROFILE);
    }

    #[test]
    fn names_are_unique_and_defaults_lie_in_their_ranges() {
        for (index, parameter) in TABLE.iter().enumerate() {
            assert!(TABLE[..index].iter().all(|other| other.name != parameter.name), "{}", parameter.name);
            assert!((parameter.min..=parameter.max).contains(&parameter.default), "{}", parameter.name);
            assert!(parameter.meaning.ends_with('.'), "{}", parameter.name);
        }
    }

    #[test]
    fn a_name_leads_to_its_line_and_no_name_to_none() {
        for parameter in &TABLE {
            assert_eq!(by_name(parameter.name).map(|found| found.id), Some(parameter.id));
        }
        assert!(by_name("velocity").is_none());
    }

    #[test]
    fn every_parameter_takes_the_ends_of_its_range_and_nothing_beyond() {
        for parameter in &TABLE {
            for id in [parameter.id, parameter.id + parameter.len - 1] {
                let mut values = Parameters::default();
                for value in [parameter.min, parameter.max] {
                    assert_eq!(values.set(id, value), Ok(()), "{}", parameter.name);
                    assert_eq!(values.get(id), Some(value), "{}", parameter.name);
                }
                for beyond in
                    [parameter.min.checked_sub(1), parameter.max.checked_add(1)].into_iter().flatten()
                {
                    assert_eq!(values.set(id, beyond), Err(SetError::OutOfRange), "{}", parameter.name);
                }
                assert_eq!(values.get(id), Some(parameter.max), "a refused value changes nothing");
            }
        }
    }

    #[test]
    fn ids_that_are_not_in_the_table_are_unknown() {
        for id in [0, SCALARS as u16 + 1, 255, 512, u16::MAX] {
            assert_eq!(lookup(id), None);
            assert_eq!(Parameters::default().get(id), None);
            assert_eq!(Parameters::default().set(id, 1), Err(SetError::UnknownId));
        }
    }

    #[test]
    fn the_default_profile_is_that_of_appendix_ix() {
        let values = Parameters::default();
        let first: [i32; 11] = core::array::from_fn(|i| values.scalar(id::GAIN_PROFILE + i as u16));
        assert_eq!(first, [8192, 6144, 4096, 2048, 1280, 768, 512, 384, 320, 288, 256]);
        assert_eq!(values.get(id::GAIN_PROFILE + 255), Some(256));
    }

    #[test]
    fn pairs_come_in_the_order_of_the_table_and_make_the_same_values_again() {
        let mut changed = Parameters::default();
        changed.set(id::VELOCITY_GAIN, 1000).expect("in range");
        changed.set(id::GAIN_PROFILE + 7, 99).expect("in range");
        let mut copy = Parameters::default();
        for (id, value) in changed.iter() {
            copy.set(id, value).expect("a value it had");
        }
        assert_eq!(copy, changed);
        assert_eq!(changed.iter().count(), SCALARS + PROFILE_LEN);
    }
}
