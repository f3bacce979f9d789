//! From a rig's keys to the parameters of the controller, in its integers: most by a key of their own, which its line in the
//! controller's table names, the others computed here from several.

pub(super) mod cascade;

use pneudrive_controller::Parameters;
use pneudrive_controller::parameters::{Form, PROFILE_LEN, RigKey, TABLE, id};

use crate::component::controller::{Law, Loop};
use crate::component::encoder::{self, pulse};
use crate::component::operator::OperatorKind;
use crate::key::Key;
use crate::keys;
use crate::values::{Rig, Value};

/// Keys of which parameters are computed that have none of their own.
pub static OF_SEVERAL: [&Key; 16] = [
    &keys::actuator::STROKE_M.key,
    &keys::controller::LEARN_NULL_OFFSET.key,
    &keys::controller::LEARNING_GAIN.key,
    &keys::controller::PRESSURE_FEEDBACK_GAIN.key,
    &keys::encoder::BITS.key,
    &keys::encoder::NOISE_COUNTS.key,
    &keys::encoder::RANGE_MM.key,
    &keys::encoder::ZERO_MM.key,
    &keys::exhaust::PRESSURE_PA.key,
    &keys::operator::MODEL.key,
    &keys::safety::END_MAX_MM.key,
    &keys::safety::END_MIN_MM.key,
    &keys::safety::MAX_SPEED_M_S.key,
    &keys::safety::POSITION_MARGIN_MM.key,
    &keys::safety::SENSOR_WATCH.key,
    &keys::supply::PRESSURE_PA.key,
];

/// A reading closer to an end of the converter than this part of its range is not a pressure.
const OPEN_SENSOR: i32 = 64;

/// An axis this far from where it stood has moved, m: 40 counts of the thesis's encoder.
const NO_MOTION_M: f64 = 0.482e-3;

impl Rig {
    /// The controller's parameters for this rig, by what the controller takes it for.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        self.try_parameters()
            .unwrap_or_else(|(id, value)| panic!("parameter {id} = {value} of a checked rig"))
    }

    /// The same for a rig that has not been checked, or the id and value that is out of range.
    pub(super) fn try_parameters(&self) -> Result<Parameters, (u16, i32)> {
        let mut parameters = Parameters::default();
        for (id, value) in self.nominal().parameter_values() {
            parameters.set(id, value).map_err(|_| (id, value))?;
        }
        Ok(parameters)
    }

    fn parameter_values(&self) -> Vec<(u16, i32)> {
        let mut values: Vec<(u16, i32)> =
            TABLE.iter().filter_map(|line| Some((line.id, self.of_key(line.key?)?))).collect();
        values.extend(self.of_law());
        values.extend(self.of_supervisor());
        values.extend(self.of_board());
        values.extend((id::GAIN_PROFILE..).zip(self.gain_profile()));
        values
    }

    /// The parameter's value of a key that sets it by itself.
    fn of_key(&self, key: RigKey) -> Option<i32> {
        match (key.form, self.value(key.path)?) {
            (Form::Whole, Value::Integer(value)) => Some(i32::try_from(*value).unwrap_or(i32::MAX)),
            (Form::Whole, Value::Number(value)) => Some(value.round() as i32),
            (Form::Scaled(digits), Value::Number(value)) => {
                Some((value * f64::from(10_u32.pow(digits))).round() as i32)
            }
            (Form::Words(words), Value::Word(word)) => place_of(words, word),
            (Form::Words(_), Value::Switch(on)) => Some(i32::from(*on)),
            (Form::Words(words), Value::Integer(value)) => place_of(words, &value.to_string()),
            _ => None,
        }
    }

    fn of_law(&self) -> Vec<(u16, i32)> {
        use keys::controller as key;
        let mut values = vec![(id::TOLERANCE_COUNTS, self.tolerance_counts())];
        if self.get(&key::LEARN_NULL_OFFSET) {
            values.push((id::LEARNING_GAIN, self.get(&key::LEARNING_GAIN) as i32));
        }
        values.push(match self.get(&key::LAW) {
            Law::OnOff => (id::PRESSURE_FEEDBACK_GAIN, self.pressure_feedback_gain()),
            _ => (id::PRESSURE_DAMPING_GAIN, self.pressure_feedback_gain()),
        });
        if self.get(&key::LAW) == Law::Cascade {
            values.extend(cascade::values(self));
        }
        values
    }

    fn of_supervisor(&self) -> Vec<(u16, i32)> {
        use keys::safety as key;
        let pulse_m = pulse(self);
        // What lies beyond what the controller can count is as far as it can.
        let most = i64::from(i32::MAX);
        let counts = |metres| encoder::counts_of(self, metres).clamp(-most, most) as i32;
        let margin = self.get(&key::POSITION_MARGIN_MM) * 1e-3;
        let step = self.get(&key::MAX_SPEED_M_S) * self.get(&keys::controller::PERIOD_S);
        let [low, high] = self.open_sensors();
        let mut values = vec![
            (id::POSITION_MIN_COUNTS, counts(-margin)),
            (id::POSITION_MAX_COUNTS, counts(self.get(&keys::actuator::STROKE_M) + margin)),
            (id::ENCODER_STEP_COUNTS, (step / pulse_m + encoder::noise_band(self)).ceil() as i32),
            (id::SENSOR_LOW_RAW, low),
            (id::SENSOR_HIGH_RAW, high),
        ];
        values.extend(self.soft_limits(counts));
        values.extend(self.no_motion_counts());
        values
    }

    /// The controller's own distance is for counts of a quadrature encoder. For another encoder: the same length in
    /// its counts, and the shift by its noise.
    fn no_motion_counts(&self) -> Option<(u16, i32)> {
        let counts = (NO_MOTION_M / pulse(self)).max(1.0) + encoder::noise_band(self);
        let absolute = self.get(&keys::encoder::MODEL).is_absolute();
        absolute.then_some((id::NO_MOTION_COUNTS, counts.round() as i32))
    }

    /// The soft limits, with `counts` of a length in metres. A setpoint of a closed loop outside the stroke
    /// can only be a slip; an open loop may push against its stops, unless the file says otherwise.
    fn soft_limits(&self, counts: impl Fn(f64) -> i32) -> [(u16, i32); 2] {
        use keys::safety as key;
        let [lowest, highest] = match self.get(&keys::controller::LOOP) {
            Loop::Closed => [0, counts(self.get(&keys::actuator::STROKE_M))],
            Loop::Open => [-i32::MAX, i32::MAX],
        };
        let ends =
            [(id::END_MIN_COUNTS, &key::END_MIN_MM, lowest), (id::END_MAX_COUNTS, &key::END_MAX_MM, highest)];
        ends.map(|(id, end, otherwise)| (id, self.get(end).map_or(otherwise, |mm| counts(mm * 1e-3))))
    }

    fn of_board(&self) -> [(u16, i32); 3] {
        [
            (id::ENCODER_PM_PER_COUNT, (encoder::mm_per_count(self) * 1e9).round() as i32),
            (id::ENCODER_ZERO_COUNTS, encoder::zero_counts(self)),
            (id::STEPPER, i32::from(self.get(&keys::operator::MODEL) == OperatorKind::Stepper)),
        ]
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

    /// The raw pressures of an open and of a shorted sensor, outside the range of the drive's pressures: the chambers
    /// stay above the exhaust, and below one and a half times the supply. An open wire does not reach the end of the
    /// converter: leakage and offset leave it up to a hundredth of the range away. Where that leaves neither end, as of a gauge
    /// whose range is less than one and a half times the supply, the top is one if the supply is below it: a reading there
    /// says nothing of a pressure that may be higher. The ends are those of a rig with
    /// sensors in any case. Without sensors the controller ignores them, and sensors that are mounted later are
    /// supervised.
    fn open_sensors(&self) -> [i32; 2] {
        let [min, max] =
            [&keys::sensors::PRESSURE_MIN_PA, &keys::sensors::PRESSURE_MAX_PA].map(|end| self.get(end));
        let watched = self.get(&keys::safety::SENSOR_WATCH);
        let margin = (max - min) / f64::from(OPEN_SENSOR);
        let low = watched && self.get(&keys::exhaust::PRESSURE_PA) > min + 2.0 * margin;
        let highest = if low { 1.5 } else { 1.0 } * self.get(&keys::supply::PRESSURE_PA);
        let high = watched && highest < max - margin;
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

    /// The gain profile, its last entry repeated to the end.
    fn gain_profile(&self) -> impl Iterator<Item = i32> {
        let given = self.get(&keys::controller::GAIN_PROFILE);
        let last = given.last().copied().unwrap_or(0);
        given.into_iter().chain(std::iter::repeat(last)).take(PROFILE_LEN).map(|gain| gain as i32)
    }
}

/// The place of a word among those that a parameter's values are written as.
fn place_of(words: &[&str], word: &str) -> Option<i32> {
    words.iter().position(|known| *known == word).map(|place| place as i32)
}
