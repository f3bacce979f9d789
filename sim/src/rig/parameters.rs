//! From a rig's keys to the parameters of the controller, in its integers.

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::id;

use crate::component::controller::{Homing, Law, Loop};
use crate::component::encoder::{self, Model as Encoder, pulse};
use crate::component::operator::Model;
use crate::key::Typed;
use crate::keys;
use crate::values::Rig;

/// A reading closer to an end of the converter than this part of its range is not a pressure.
const OPEN_SENSOR: i32 = 64;

/// An axis has moved that is so far from where it stood, m: 40 counts of the thesis's encoder.
const NO_MOTION_M: f64 = 0.482e-3;

impl Rig {
    /// The controller's parameters for this rig.
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
        let mut values = self.of_law();
        values.extend(self.of_supervisor());
        values.extend(self.of_board());
        values.extend(self.of_moves());
        values.extend(self.gain_profile().into_iter().zip(id::GAIN_PROFILE..).map(|(gain, id)| (id, gain)));
        values
    }

    fn of_law(&self) -> Vec<(u16, i32)> {
        use keys::controller as key;
        let mut values = vec![
            (id::PERIOD_US, self.microseconds(&key::PERIOD_S) as i32),
            (id::DELAY_US, self.microseconds(&key::DELAY_S) as i32),
            (id::OPEN_LOOP, i32::from(self.get(&key::LOOP) == Loop::Open)),
            (id::LAW, number_of(self.get(&key::LAW))),
            (id::PROFILE_SPAN_COUNTS, self.whole(&key::PROFILE_SPAN_COUNTS)),
            (id::PROPORTIONAL_GAIN, self.whole(&key::PROPORTIONAL_GAIN)),
            (id::VELOCITY_GAIN, self.whole(&key::VELOCITY_GAIN)),
            (id::ACCELERATION_GAIN, self.whole(&key::ACCELERATION_GAIN)),
            (id::VELOCITY_FEED_FORWARD, self.whole(&key::VELOCITY_FEED_FORWARD)),
            (id::ACCELERATION_FEED_FORWARD, self.whole(&key::ACCELERATION_FEED_FORWARD)),
            (id::VELOCITY_WINDOW_SAMPLES, self.whole(&key::VELOCITY_WINDOW_SAMPLES)),
            (id::ACCELERATION_WINDOW_SAMPLES, self.whole(&key::ACCELERATION_WINDOW_SAMPLES)),
            (id::VELOCITY_DEAD_BAND, self.whole(&key::VELOCITY_DEAD_BAND)),
            (id::DEAD_BAND_COUNTS, self.whole(&key::DEAD_BAND_COUNTS)),
            (id::SCALE, self.whole(&key::SCALE)),
            (id::NULL_OFFSET_COUNTS, self.whole(&key::NULL_OFFSET_COUNTS)),
            (id::DEAD_ZONE_COUNTS, self.whole(&key::DEAD_ZONE_COUNTS)),
            (id::RELAY_HYSTERESIS_COUNTS, self.whole(&key::RELAY_HYSTERESIS_COUNTS)),
        ];
        if self.get(&key::LEARN_NULL_OFFSET) {
            values.push((id::LEARNING_GAIN, self.whole(&key::LEARNING_GAIN)));
        }
        values.push(match self.get(&key::LAW) {
            Law::OnOff => (id::PRESSURE_FEEDBACK_GAIN, self.pressure_feedback_gain()),
            _ => (id::PRESSURE_DAMPING_GAIN, self.pressure_feedback_gain()),
        });
        values
    }

    fn of_supervisor(&self) -> Vec<(u16, i32)> {
        use keys::safety as key;
        let pulse_m = pulse(self);
        let counts = |metres: f64| (metres / pulse_m).floor() as i32;
        let margin = self.get(&key::POSITION_MARGIN_MM) * 1e-3;
        let step = self.get(&key::MAX_SPEED_M_S) * self.get(&keys::controller::PERIOD_S);
        let [low, high] = self.open_sensors();
        let mut values = vec![
            (id::POSITION_MIN_COUNTS, counts(-margin)),
            (id::POSITION_MAX_COUNTS, counts(self.get(&keys::actuator::STROKE_M) + margin)),
            (id::ENCODER_STEP_COUNTS, (step / pulse_m + encoder::noise_band(self)).ceil() as i32),
            (id::LATE_SAMPLE_US, self.whole(&key::LATE_SAMPLE_US)),
            (id::LATE_OUTPUT_US, self.whole(&key::LATE_OUTPUT_US)),
            (id::HOST_SILENCE_MS, self.scaled(&key::HOST_SILENCE_S, 1e3)),
            (id::HOLD_MS, self.scaled(&key::HOLD_S, 1e3)),
            (id::NO_MOTION_MS, self.scaled(&key::NO_MOTION_S, 1e3)),
            (id::INPUT_DEBOUNCE_MS, self.scaled(&key::INPUT_DEBOUNCE_S, 1e3)),
            (id::INPUT_SETTLING_MS, self.scaled(&key::INPUT_SETTLING_S, 1e3)),
            (id::SENSOR_LOW_RAW, low),
            (id::SENSOR_HIGH_RAW, high),
        ];
        values.extend(self.end_positions(counts));
        values.extend(self.no_motion_counts());
        values
    }

    /// The controller's own distance is for counts of a quadrature encoder; the same length in counts of another one, and
    /// what its noise shifts.
    fn no_motion_counts(&self) -> Option<(u16, i32)> {
        let counts = (NO_MOTION_M / pulse(self)).max(1.0) + encoder::noise_band(self);
        let absolute = self.get(&keys::encoder::MODEL).is_absolute();
        absolute.then_some((id::NO_MOTION_COUNTS, counts.round() as i32))
    }

    /// The software end positions, with `counts` of a length in metres. A setpoint of a closed loop outside the stroke
    /// can only be a slip; an open loop may push against its stops, unless the file says otherwise.
    fn end_positions(&self, counts: impl Fn(f64) -> i32) -> [(u16, i32); 2] {
        use keys::safety as key;
        let [lowest, highest] = match self.get(&keys::controller::LOOP) {
            Loop::Closed => [0, counts(self.get(&keys::actuator::STROKE_M))],
            Loop::Open => [-i32::MAX, i32::MAX],
        };
        let ends =
            [(id::END_MIN_COUNTS, &key::END_MIN_MM, lowest), (id::END_MAX_COUNTS, &key::END_MAX_MM, highest)];
        ends.map(|(id, end, otherwise)| (id, self.get(end).map_or(otherwise, |mm| counts(mm * 1e-3))))
    }

    fn of_board(&self) -> Vec<(u16, i32)> {
        use keys::{sensors, stepper};
        vec![
            (id::ENCODER_INVERTED, i32::from(self.get(&keys::encoder::POLARITY) < 0)),
            (id::ENCODER_PM_PER_COUNT, (encoder::mm_per_count(self) * 1e9).round() as i32),
            (id::ENCODER_MODEL, number_of_encoder(self.get(&keys::encoder::MODEL))),
            (id::ENCODER_ZERO_COUNTS, encoder::zero_counts(self)),
            (id::PRESSURE_SENSORS, i32::from(self.get(&sensors::PRESSURE))),
            (id::SENSOR_BITS, self.whole(&sensors::BITS)),
            (id::PRESSURE_MIN_PA, self.scaled(&sensors::PRESSURE_MIN_PA, 1.0)),
            (id::PRESSURE_MAX_PA, self.scaled(&sensors::PRESSURE_MAX_PA, 1.0)),
            (id::SPOOL_MIN_NM, self.scaled(&sensors::SPOOL_MIN_MM, 1e6)),
            (id::SPOOL_MAX_NM, self.scaled(&sensors::SPOOL_MAX_MM, 1e6)),
            (id::STEPPER, i32::from(self.get(&keys::operator::MODEL) == Model::Stepper)),
            (id::MAX_STEPS, self.whole(&stepper::MAX_STEPS)),
            (id::PULSE_WIDTH_US, self.whole(&stepper::PULSE_WIDTH_US)),
            (id::DIRECTION_SETUP_US, self.whole(&stepper::DIRECTION_SETUP_US)),
        ]
    }

    fn of_moves(&self) -> Vec<(u16, i32)> {
        use keys::controller as key;
        vec![
            (id::TOLERANCE_COUNTS, self.tolerance_counts()),
            (id::MONITORING_US, self.scaled(&key::MONITORING_S, 1e6)),
            (id::DWELL_US, self.scaled(&key::DWELL_S, 1e6)),
            (id::FORCED_EXIT_US, self.scaled(&key::FORCED_EXIT_S, 1e6)),
            (id::ON_ARRIVAL, i32::from(self.get(&key::EXIT_ON_DEAD_BAND))),
            (id::HOMING_SWITCH, i32::from(self.get(&key::HOMING) == Homing::Switch)),
            (id::HOMING_COMMAND_COUNTS, self.whole(&key::HOMING_COMMAND_COUNTS)),
            (id::HOMING_POSITION_COUNTS, self.whole(&key::HOMING_POSITION_COUNTS)),
            (id::HOMING_BACK_OFF_COUNTS, self.whole(&key::HOMING_BACK_OFF_COUNTS)),
            (id::HOMING_STILL_MS, self.scaled(&key::HOMING_STILL_S, 1e3)),
            (id::HOMING_TIMEOUT_MS, self.scaled(&key::HOMING_TIMEOUT_S, 1e3)),
        ]
    }

    fn whole(&self, key: &Typed<i64>) -> i32 {
        i32::try_from(self.get(key)).unwrap_or(i32::MAX)
    }

    fn scaled(&self, key: &Typed<f64>, factor: f64) -> i32 {
        (self.get(key) * factor).round() as i32
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
    /// chambers stay above the exhaust, and below one and a half times the supply. An open wire does not reach the end
    /// of the converter: leakage and offset leave it up to a hundredth of the range away. The ends are those of a rig with
    /// sensors whether it has them or not: without them the controller ignores the ends, and sensors that are put on later
    /// are watched.
    fn open_sensors(&self) -> [i32; 2] {
        let [min, max] =
            [&keys::sensors::PRESSURE_MIN_PA, &keys::sensors::PRESSURE_MAX_PA].map(|end| self.get(end));
        let watched = self.get(&keys::safety::SENSOR_WATCH);
        let margin = (max - min) / f64::from(OPEN_SENSOR);
        let low = watched && self.get(&keys::exhaust::PRESSURE_PA) > min + 2.0 * margin;
        let high = watched && 1.5 * self.get(&keys::supply::PRESSURE_PA) < max - margin;
        let full = (1 << self.get(&keys::sensors::BITS)) - 1;
        let open = full / OPEN_SENSOR;
        [if low { open } else { -1 }, if high { full - open } else { i32::from(i16::MAX) }]
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

/// The encoder as the controller's parameter has it.
fn number_of_encoder(encoder: Encoder) -> i32 {
    match encoder {
        Encoder::Quadrature => 0,
        Encoder::Potentiometer => 1,
        Encoder::Ssi => 2,
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
