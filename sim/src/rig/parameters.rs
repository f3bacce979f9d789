//! From a rig's keys to the parameters of the controller, in its integers.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;

use crate::component::controller::{Homing, Law, Loop};
use crate::component::encoder::pulse;
use crate::component::operator::Model;
use crate::key::Typed;
use crate::keys;
use crate::values::Rig;

impl Rig {
    /// The controller's parameters that this rig asks for.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        self.try_parameters()
            .unwrap_or_else(|(id, value)| panic!("parameter {id} = {value} of a checked rig"))
    }

    /// The same for a rig that has not been checked, or the id and value that is out of range.
    pub(super) fn try_parameters(&self) -> Result<Parameters, (u16, i32)> {
        let mut parameters = Parameters::default();
        for (id, value) in self.parameter_values() {
            parameters.set(id, value).map_err(|_| (id, value))?;
        }
        Ok(parameters)
    }

    fn parameter_values(&self) -> Vec<(u16, i32)> {
        let whole = |key: &Typed<i64>| i32::try_from(self.get(key)).unwrap_or(i32::MAX);
        let scaled = |key: &Typed<f64>, factor: f64| (self.get(key) * factor).round() as i32;
        let pulse_m = pulse(self);
        let counts = |metres: f64| (metres / pulse_m).floor() as i32;
        let margin = self.get(&keys::safety::POSITION_MARGIN_MM) * 1e-3;
        let step = self.get(&keys::safety::MAX_SPEED_M_S) * self.get(&keys::controller::PERIOD_S);
        let mut values = vec![
            (id::PERIOD_US, self.microseconds(&keys::controller::PERIOD_S) as i32),
            (id::DELAY_US, self.microseconds(&keys::controller::DELAY_S) as i32),
            (id::OPEN_LOOP, i32::from(self.get(&keys::controller::LOOP) == Loop::Open)),
            (id::LAW, number_of(self.get(&keys::controller::LAW))),
            (id::PROFILE_SPAN_COUNTS, whole(&keys::controller::PROFILE_SPAN_COUNTS)),
            (id::PROPORTIONAL_GAIN, whole(&keys::controller::PROPORTIONAL_GAIN)),
            (id::VELOCITY_GAIN, whole(&keys::controller::VELOCITY_GAIN)),
            (id::ACCELERATION_GAIN, whole(&keys::controller::ACCELERATION_GAIN)),
            (id::VELOCITY_WINDOW_SAMPLES, whole(&keys::controller::VELOCITY_WINDOW_SAMPLES)),
            (id::ACCELERATION_WINDOW_SAMPLES, whole(&keys::controller::ACCELERATION_WINDOW_SAMPLES)),
            (id::VELOCITY_DEAD_BAND, whole(&keys::controller::VELOCITY_DEAD_BAND)),
            (id::DEAD_BAND_COUNTS, whole(&keys::controller::DEAD_BAND_COUNTS)),
            (id::SCALE, whole(&keys::controller::SCALE)),
            (id::NULL_OFFSET_COUNTS, whole(&keys::controller::NULL_OFFSET_COUNTS)),
            (id::POSITION_MIN_COUNTS, counts(-margin)),
            (id::POSITION_MAX_COUNTS, counts(self.get(&keys::actuator::STROKE_M) + margin)),
            (id::ENCODER_STEP_COUNTS, (step / pulse_m).ceil() as i32),
            (id::LATE_SAMPLE_US, whole(&keys::safety::LATE_SAMPLE_US)),
            (id::HOST_SILENCE_MS, scaled(&keys::safety::HOST_SILENCE_S, 1e3)),
            (id::HOLD_MS, scaled(&keys::safety::HOLD_S, 1e3)),
            (id::ENCODER_INVERTED, i32::from(self.get(&keys::encoder::POLARITY) < 0)),
            (id::ENCODER_PM_PER_COUNT, scaled(&keys::encoder::MM_PER_COUNT, 1e9)),
            (id::SENSOR_BITS, whole(&keys::sensors::BITS)),
            (id::PRESSURE_MIN_PA, scaled(&keys::sensors::PRESSURE_MIN_PA, 1.0)),
            (id::PRESSURE_MAX_PA, scaled(&keys::sensors::PRESSURE_MAX_PA, 1.0)),
            (id::SPOOL_MIN_NM, scaled(&keys::sensors::SPOOL_MIN_MM, 1e6)),
            (id::SPOOL_MAX_NM, scaled(&keys::sensors::SPOOL_MAX_MM, 1e6)),
            (id::STEPPER, i32::from(self.get(&keys::operator::MODEL) == Model::Stepper)),
            (id::MAX_STEPS, whole(&keys::stepper::MAX_STEPS)),
            (id::DEAD_ZONE_COUNTS, whole(&keys::controller::DEAD_ZONE_COUNTS)),
            (id::RELAY_HYSTERESIS_COUNTS, whole(&keys::controller::RELAY_HYSTERESIS_COUNTS)),
            (id::TOLERANCE_COUNTS, self.tolerance_counts()),
            (id::MONITORING_US, scaled(&keys::controller::MONITORING_S, 1e6)),
            (id::DWELL_US, scaled(&keys::controller::DWELL_S, 1e6)),
            (id::FORCED_EXIT_US, scaled(&keys::controller::FORCED_EXIT_S, 1e6)),
            (id::ON_ARRIVAL, i32::from(self.get(&keys::controller::EXIT_ON_DEAD_BAND))),
            (id::HOMING_SWITCH, i32::from(self.get(&keys::controller::HOMING) == Homing::Switch)),
            (id::HOMING_COMMAND_COUNTS, whole(&keys::controller::HOMING_COMMAND_COUNTS)),
            (id::HOMING_POSITION_COUNTS, whole(&keys::controller::HOMING_POSITION_COUNTS)),
            (id::HOMING_STILL_MS, scaled(&keys::controller::HOMING_STILL_S, 1e3)),
            (id::HOMING_TIMEOUT_MS, scaled(&keys::controller::HOMING_TIMEOUT_S, 1e3)),
            (id::PULSE_WIDTH_US, whole(&keys::stepper::PULSE_WIDTH_US)),
            (id::DIRECTION_SETUP_US, whole(&keys::stepper::DIRECTION_SETUP_US)),
            (id::NO_MOTION_MS, scaled(&keys::safety::NO_MOTION_S, 1e3)),
        ];
        let [low, high] = self.open_sensors();
        values.extend([(id::SENSOR_LOW_RAW, low), (id::SENSOR_HIGH_RAW, high)]);
        for (id, key) in
            [(id::END_MIN_COUNTS, &keys::safety::END_MIN_MM), (id::END_MAX_COUNTS, &keys::safety::END_MAX_MM)]
        {
            values.extend(self.get(key).map(|mm| (id, counts(mm * 1e-3))));
        }
        if self.get(&keys::controller::LEARN_NULL_OFFSET) {
            values.push((id::LEARNING_GAIN, whole(&keys::controller::LEARNING_GAIN)));
        }
        if self.get(&keys::controller::LAW) == Law::OnOff {
            values.push((id::PRESSURE_FEEDBACK_GAIN, self.pressure_feedback_gain()));
        }
        values.extend(self.gain_profile().into_iter().zip(id::GAIN_PROFILE..).map(|(gain, id)| (id, gain)));
        values
    }

    /// An error inside the tolerance is less than the dead band, as the thesis compares it (8.2.3), where
    /// there is one and the file says nothing else.
    fn tolerance_counts(&self) -> i32 {
        let dead_band = self.get(&keys::controller::DEAD_BAND_COUNTS);
        let given = self.is_set(&keys::controller::TOLERANCE_COUNTS);
        let tolerance = if dead_band > 0 && !given {
            dead_band - 1
        } else {
            self.get(&keys::controller::TOLERANCE_COUNTS)
        };
        i32::try_from(tolerance).unwrap_or(i32::MAX)
    }

    /// The raw pressures of an open and of a shorted sensor, where no pressure of the drive is read so: the
    /// chambers stay above the exhaust, and below one and a half times the supply.
    fn open_sensors(&self) -> [i32; 2] {
        let [min, max] =
            [&keys::sensors::PRESSURE_MIN_PA, &keys::sensors::PRESSURE_MAX_PA].map(|end| self.get(end));
        let watched = self.get(&keys::safety::SENSOR_WATCH);
        let low = watched && self.get(&keys::exhaust::PRESSURE_PA) > min + 0.01 * (max - min);
        let high = watched && 1.5 * self.get(&keys::supply::PRESSURE_PA) < max;
        let full = (1 << self.get(&keys::sensors::BITS)) - 1;
        [if low { 0 } else { -1 }, if high { full } else { i32::from(i16::MAX) }]
    }

    /// k5 on raw pressures, from counts of error per kPa.
    fn pressure_feedback_gain(&self) -> i32 {
        let range = self.get(&keys::sensors::PRESSURE_MAX_PA) - self.get(&keys::sensors::PRESSURE_MIN_PA);
        let kpa_per_raw = range / 1e3 / f64::from((1 << self.get(&keys::sensors::BITS)) - 1);
        let scale = self.get(&keys::controller::SCALE) as f64;
        (self.get(&keys::controller::PRESSURE_FEEDBACK_GAIN) * kpa_per_raw * scale).round() as i32
    }

    /// The gain profile, its last entry repeated to 256.
    fn gain_profile(&self) -> Vec<i32> {
        let given = self.get(&keys::controller::GAIN_PROFILE);
        let last = given.last().copied().unwrap_or(0);
        let entries = given.iter().copied().chain(std::iter::repeat(last));
        entries.take(256).map(|gain| gain as i32).collect()
    }
}

/// The law as the controller's parameter has it.
fn number_of(law: Law) -> i32 {
    match law {
        Law::GainProfile => 0,
        Law::Proportional => 1,
        Law::MooreProportional => 2,
        Law::OnOff => 3,
    }
}
