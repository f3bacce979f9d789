//! Rig files: one drive and one test, in TOML.
//!
//! [`keys`] is the table of all keys. [`Rig::read`] takes a file apart by it and names file, line and
//! key of everything that is wrong; a [`Rig`] that exists is valid: every value in its range, no
//! division by zero, nothing unphysical, nothing that is not built. It hands out values in SI.

mod builtin;
mod check;
mod explain;
pub mod keys;
mod read;
mod spread;

pub use builtin::{BUILTIN, builtin};
pub use explain::explain;
pub use read::{Problem, Problems};
pub use spread::SpreadError;
pub(crate) use spread::unit_interval;

use pneudrive_controller::parameters::id;
use pneudrive_controller::sequencer::MAX_MOVES;
use pneudrive_controller::{Move, Parameters, Sequence};
use std::num::NonZeroU32;

use keys::{Default, KEYS, Key};

/// The laws, in the order of the controller's parameter.
const LAWS: [&str; 4] = ["gain-profile", "proportional", "moore-proportional", "on-off"];

/// The value of a key.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A real number, in the unit of the key's name.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// true or false.
    Switch(bool),
    /// A word or a text.
    Word(String),
    /// Whole numbers.
    Integers(Vec<i64>),
    /// Real numbers.
    Numbers(Vec<f64>),
    /// [time in s, counts].
    Moves(Vec<(f64, i64)>),
}

/// A valid rig: a value for every key that has one.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// In the order of [`KEYS`].
    values: Vec<Option<Value>>,
    /// Which keys the file or the command line has set.
    set: Vec<bool>,
}

impl Rig {
    /// The empty file: servo-drive B as the thesis's Appendix VII has it.
    fn defaults() -> Rig {
        let values = KEYS.iter().map(|key| default_value(&key.default)).collect();
        Rig { values, set: vec![false; KEYS.len()] }
    }

    fn index(path: &str) -> usize {
        KEYS.iter()
            .position(|key| key.path == path)
            .unwrap_or_else(|| panic!("{path} is not in the table of keys"))
    }

    /// The value of a key, if it has one.
    ///
    /// # Panics
    /// When the table has no such key: a slip in the program, not in a file.
    #[must_use]
    pub fn value(&self, path: &str) -> Option<&Value> {
        self.values[Self::index(path)].as_ref()
    }

    /// A real number, in the unit of the key's name.
    ///
    /// # Panics
    /// When the key is no number that always has a value.
    #[must_use]
    pub fn number(&self, path: &str) -> f64 {
        self.optional_number(path).unwrap_or_else(|| panic!("{path} has no number"))
    }

    /// A real number, if the key has one.
    #[must_use]
    pub fn optional_number(&self, path: &str) -> Option<f64> {
        match self.value(path) {
            Some(Value::Number(value)) => Some(*value),
            _ => None,
        }
    }

    /// A whole number.
    ///
    /// # Panics
    /// When the key is no whole number.
    #[must_use]
    pub fn integer(&self, path: &str) -> i64 {
        match self.value(path) {
            Some(Value::Integer(value)) => *value,
            _ => panic!("{path} has no whole number"),
        }
    }

    /// The twelve coefficients of a polynomial, if the key has them.
    #[must_use]
    pub fn polynomial(&self, path: &str) -> Option<[f64; 12]> {
        match self.value(path) {
            Some(Value::Numbers(values)) => values.as_slice().try_into().ok(),
            _ => None,
        }
    }

    /// A word.
    ///
    /// # Panics
    /// When the key has none.
    #[must_use]
    pub fn word(&self, path: &str) -> &str {
        match self.value(path) {
            Some(Value::Word(word)) => word,
            _ => panic!("{path} has no word"),
        }
    }

    /// A switch.
    ///
    /// # Panics
    /// When the key is none.
    #[must_use]
    pub fn switch(&self, path: &str) -> bool {
        match self.value(path) {
            Some(Value::Switch(on)) => *on,
            _ => panic!("{path} is no switch"),
        }
    }

    /// What the rig is called.
    #[must_use]
    pub fn name(&self) -> &str {
        match self.value("name") {
            Some(Value::Word(name)) => name,
            _ => "rig",
        }
    }

    /// This rig with the `[test]` of another.
    ///
    /// # Errors
    /// When that test does not fit this rig.
    pub fn with_test_of(&self, other: &Rig) -> Result<Rig, Problems> {
        let mut rig = self.clone();
        let control_loop = Rig::index("controller.loop");
        if other.set[control_loop] && other.values[control_loop] != self.values[control_loop] {
            return Err(Problems(vec![Problem {
                source: other.name().to_owned(),
                line: None,
                key: "controller.loop".to_owned(),
                message: format!(
                    "its test is for the {} loop, the rig's is {}: the moves would mean something else",
                    other.word("controller.loop"),
                    self.word("controller.loop")
                ),
            }]));
        }
        for (index, _) in KEYS.iter().enumerate().filter(|(_, key)| key.table() == "test") {
            rig.values[index] = other.values[index].clone();
            rig.set[index] = other.set[index];
        }
        rig.checked(other.name())
    }

    /// Every key that has a value, in the order of the table.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Key, &Value)> {
        KEYS.iter().zip(&self.values).filter_map(|(key, value)| value.as_ref().map(|value| (key, value)))
    }

    /// Keys that were set but that the chosen models do not use.
    #[must_use]
    pub fn unused(&self) -> Vec<&'static str> {
        KEYS.iter()
            .zip(&self.set)
            .filter(|(key, set)| **set && !key.models.is_empty() && !key.models.contains(&self.model_of(key)))
            .map(|(key, _)| key.path)
            .collect()
    }

    fn model_of(&self, key: &Key) -> &str {
        self.word(&format!("{}.model", key.table()))
    }

    /// A value in whole microseconds, from a key in seconds.
    #[must_use]
    pub fn microseconds(&self, path: &str) -> u64 {
        whole_microseconds(self.number(path)).unwrap_or(0)
    }

    /// The sample period.
    #[must_use]
    pub fn period_us(&self) -> NonZeroU32 {
        let period = u32::try_from(self.microseconds("controller.period_s")).ok();
        period.and_then(NonZeroU32::new).expect("checked to be 100 us at least")
    }

    /// The moves: [time in s, counts].
    #[must_use]
    pub fn moves(&self) -> Vec<(f64, i64)> {
        match (self.value("test.targets"), self.value("test.moves")) {
            (Some(Value::Integers(targets)), _) => {
                let each = self.number("controller.forced_exit_s");
                targets.iter().enumerate().map(|(i, &target)| (i as f64 * each, target)).collect()
            }
            (_, Some(Value::Moves(moves))) => moves.clone(),
            _ => Vec::new(),
        }
    }

    /// The last sample number of the test.
    #[must_use]
    pub fn last_sample(&self) -> u32 {
        let period = u64::from(self.period_us().get());
        u32::try_from(self.microseconds("test.duration_s") / period).unwrap_or(u32::MAX)
    }

    /// The test as the controller takes it.
    #[must_use]
    pub fn sequence(&self) -> Sequence {
        let mut sequence = Sequence::new(self.last_sample());
        for (time_s, target) in self.moves().into_iter().take(MAX_MOVES) {
            let time_us = u32::try_from(whole_microseconds(time_s).unwrap_or(0)).unwrap_or(u32::MAX);
            let target = i32::try_from(target).unwrap_or(i32::MAX);
            sequence
                .push(Move::at_time_us(time_us, self.period_us(), target))
                .expect("checked to be in order and few enough");
        }
        sequence
    }

    /// The controller's parameters that this rig asks for.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        self.try_parameters()
            .unwrap_or_else(|(id, value)| panic!("parameter {id} = {value} of a checked rig"))
    }

    /// The same for a rig that has not been checked, or the id and value that is out of range.
    fn try_parameters(&self) -> Result<Parameters, (u16, i32)> {
        let mut parameters = Parameters::default();
        for (id, value) in self.parameter_values() {
            parameters.set(id, value).map_err(|_| (id, value))?;
        }
        Ok(parameters)
    }

    fn parameter_values(&self) -> Vec<(u16, i32)> {
        let whole = |path: &str| i32::try_from(self.integer(path)).unwrap_or(i32::MAX);
        let scaled = |path: &str, factor: f64| (self.number(path) * factor).round() as i32;
        let choice = |path: &str, word: &str| i32::from(self.word(path) == word);
        let pulse_m = self.number("encoder.mm_per_count") * 1e-3;
        let counts = |metres: f64| (metres / pulse_m).floor() as i32;
        let margin = self.number("safety.position_margin_mm") * 1e-3;
        let step = self.number("safety.max_speed_m_s") * self.number("controller.period_s");
        let mut values = vec![
            (id::PERIOD_US, self.microseconds("controller.period_s") as i32),
            (id::DELAY_US, self.microseconds("controller.delay_s") as i32),
            (id::OPEN_LOOP, choice("controller.loop", "open")),
            (
                id::LAW,
                LAWS.iter().position(|&law| law == self.word("controller.law")).map_or(0, |i| i as i32),
            ),
            (id::PROFILE_SPAN_COUNTS, whole("controller.profile_span_counts")),
            (id::PROPORTIONAL_GAIN, whole("controller.proportional_gain")),
            (id::VELOCITY_GAIN, whole("controller.velocity_gain")),
            (id::ACCELERATION_GAIN, whole("controller.acceleration_gain")),
            (id::VELOCITY_WINDOW_SAMPLES, whole("controller.velocity_window_samples")),
            (id::ACCELERATION_WINDOW_SAMPLES, whole("controller.acceleration_window_samples")),
            (id::VELOCITY_DEAD_BAND, whole("controller.velocity_dead_band")),
            (id::DEAD_BAND_COUNTS, whole("controller.dead_band_counts")),
            (id::SCALE, whole("controller.scale")),
            (id::NULL_OFFSET_COUNTS, whole("controller.null_offset_counts")),
            (id::POSITION_MIN_COUNTS, counts(-margin)),
            (id::POSITION_MAX_COUNTS, counts(self.number("actuator.stroke_m") + margin)),
            (id::ENCODER_STEP_COUNTS, (step / pulse_m).ceil() as i32),
            (id::LATE_SAMPLE_US, whole("safety.late_sample_us")),
            (id::HOST_SILENCE_MS, scaled("safety.host_silence_s", 1e3)),
            (id::ENCODER_INVERTED, i32::from(self.integer("encoder.polarity") < 0)),
            (id::ENCODER_PM_PER_COUNT, scaled("encoder.mm_per_count", 1e9)),
            (id::SENSOR_BITS, whole("sensors.bits")),
            (id::PRESSURE_MIN_PA, scaled("sensors.pressure_min_pa", 1.0)),
            (id::PRESSURE_MAX_PA, scaled("sensors.pressure_max_pa", 1.0)),
            (id::SPOOL_MIN_NM, scaled("sensors.spool_min_mm", 1e6)),
            (id::SPOOL_MAX_NM, scaled("sensors.spool_max_mm", 1e6)),
            (id::STEPPER, choice("operator.model", "stepper")),
            (id::MAX_STEPS, whole("operator.max_steps")),
            (id::DEAD_ZONE_COUNTS, whole("controller.dead_zone_counts")),
            (id::RELAY_HYSTERESIS_COUNTS, whole("controller.relay_hysteresis_counts")),
        ];
        if self.word("controller.law") == "on-off" {
            values.push((id::PRESSURE_FEEDBACK_GAIN, self.pressure_feedback_gain()));
        }
        values.extend(self.gain_profile().into_iter().zip(id::GAIN_PROFILE..).map(|(gain, id)| (id, gain)));
        values
    }

    /// k5 on raw pressures, from counts of error per kPa.
    fn pressure_feedback_gain(&self) -> i32 {
        let range = self.number("sensors.pressure_max_pa") - self.number("sensors.pressure_min_pa");
        let kpa_per_raw = range / 1e3 / f64::from((1 << self.integer("sensors.bits")) - 1);
        let scale = self.integer("controller.scale") as f64;
        (self.number("controller.pressure_feedback_gain") * kpa_per_raw * scale).round() as i32
    }

    /// The gain profile, its last entry repeated to 256.
    fn gain_profile(&self) -> Vec<i32> {
        let given: &[i64] = match self.value("controller.gain_profile") {
            Some(Value::Integers(given)) => given,
            _ => &[],
        };
        let last = given.last().copied().unwrap_or(0);
        let entries = given.iter().copied().chain(std::iter::repeat(last));
        entries.take(256).map(|gain| gain as i32).collect()
    }
}

/// Seconds as whole microseconds, if they are (to a thousandth of one).
pub(crate) fn whole_microseconds(seconds: f64) -> Option<u64> {
    let us = (seconds * 1e6).round();
    (us >= 0.0 && (seconds * 1e6 - us).abs() < 1e-3).then_some(us as u64)
}

fn default_value(default: &Default) -> Option<Value> {
    Some(match default {
        Default::Number(value) => Value::Number(*value),
        Default::Integer(value) => Value::Integer(*value),
        Default::Switch(on) => Value::Switch(*on),
        Default::Choice(word) => Value::Word((*word).to_owned()),
        Default::Integers(values) => Value::Integers(values.to_vec()),
        Default::Moves(moves) => Value::Moves(moves.to_vec()),
        Default::Absent(_) => return None,
    })
}

#[cfg(test)]
mod tests;
