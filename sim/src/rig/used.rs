//! When a key has an effect: with the models that it belongs to, and under the conditions of the table below. A key that
//! is written where it has none is refused ([`crate::rig`]), as nobody would notice otherwise that it does nothing.

use std::collections::BTreeSet;
use std::ptr;

use super::table::{all_keys, chooser, find_key, preset_value};
use crate::component::controller::Law;
use crate::component::valve::model::{WITH_AREAS, WITH_CONNECTORS, WITH_TUBES};
use crate::key::Key;
use crate::keys;
use crate::values::{Findings, Rig, Value};

/// A condition on another key, which must have an effect itself.
enum When {
    /// It has one of these words; of a switch `true` or `false`.
    Is(&'static Key, &'static [&'static str]),
    /// It has another word than these.
    IsNot(&'static Key, &'static [&'static str]),
    /// It is not 0.
    NotZero(&'static Key),
    /// It is given.
    Given(&'static Key),
    /// One of these holds.
    Any(&'static [When]),
}

use When::{Any, Given, Is, IsNot, NotZero};

const SAMPLED: When = Is(&keys::controller::MODEL.key, &["sampled"]);
const CLOSED: When = Is(&keys::controller::LOOP.key, &["closed"]);
/// Laws that sum up what they feed back, those of them with one gain on the error, and those that feed forward.
const SUM: When = IsNot(&keys::controller::LAW.key, &[Law::Cascade.word()]);
const ONE_GAIN: When = IsNot(&keys::controller::LAW.key, &[Law::GainProfile.word(), Law::Cascade.word()]);
const FEED_FORWARD: When = IsNot(&keys::controller::LAW.key, &[Law::OnOff.word(), Law::Cascade.word()]);
const NO_RELAY: When = IsNot(&keys::controller::LAW.key, &[Law::OnOff.word()]);
const PRESSURES: When = Is(&keys::sensors::PRESSURE.key, &["true"]);
const MEASURED_FORCE: When = Is(&keys::flow_force::FLOW_FORCE.key, &["experimental"]);
const CONSTANT_DISCHARGE: When = Is(&keys::discharge::DISCHARGE_MODEL.key, &["constant"]);
const CONNECTORS: When = Is(&keys::valve::MODEL.key, WITH_CONNECTORS);
const LIMITED: When =
    Any(&[Is(&keys::test::PROFILE.key, &["trapezoid", "s-curve"]), Given(&keys::test::MOVE.key)]);

/// Keys, and the conditions under which they have an effect, besides their models.
#[rustfmt::skip]
static TABLE: &[(&[&Key], &[When])] = &[
    (&[&keys::controller::LAW.key], &[CLOSED]),
    (&[&keys::controller::VELOCITY_GAIN.key, &keys::controller::ACCELERATION_GAIN.key, &keys::controller::SCALE.key,
       &keys::controller::DEAD_BAND_COUNTS.key, &keys::controller::PRESSURE_FEEDBACK_GAIN.key], &[SUM]),
    (&[&keys::controller::VELOCITY_DEAD_BAND.key], &[NotZero(&keys::controller::VELOCITY_GAIN.key)]),
    (&[&keys::controller::DELAY_S.key, &keys::operator::MAX_COMMAND_COUNTS.key], &[SAMPLED]),
    (&[&keys::controller::PROPORTIONAL_GAIN.key], &[ONE_GAIN]),
    (&[&keys::controller::INTEGRAL_BAND_COUNTS.key], &[NotZero(&keys::controller::INTEGRAL_GAIN.key)]),
    (&[&keys::controller::RELAY_HYSTERESIS_COUNTS.key], &[NotZero(&keys::controller::DEAD_BAND_COUNTS.key)]),
    (&[&keys::controller::NULL_OFFSET_COUNTS.key], &[NO_RELAY]),
    (&[&keys::controller::VELOCITY_FEED_FORWARD.key, &keys::controller::ACCELERATION_FEED_FORWARD.key],
     &[SAMPLED, FEED_FORWARD]),
    (&[&keys::controller::LEARN_NULL_OFFSET.key], &[SAMPLED, NO_RELAY]),
    (&[&keys::controller::LEARNING_GAIN.key], &[Is(&keys::controller::LEARN_NULL_OFFSET.key, &["true"])]),
    (&[&keys::sensors::PRESSURE_LAG_S.key, &keys::sensors::PRESSURE_1_GAIN_ERROR_PERCENT.key,
       &keys::sensors::PRESSURE_1_OFFSET_ERROR_PA.key, &keys::sensors::PRESSURE_2_GAIN_ERROR_PERCENT.key,
       &keys::sensors::PRESSURE_2_OFFSET_ERROR_PA.key], &[PRESSURES]),
    (&[&keys::sensors::SPOOL_MIN_MM.key, &keys::sensors::SPOOL_MAX_MM.key,
       &keys::sensors::SPOOL_GAIN_ERROR_PERCENT.key, &keys::sensors::SPOOL_OFFSET_ERROR_MM.key],
     &[IsNot(&keys::operator::MODEL.key, &["stepper"])]),
    (&[&keys::dither::DITHER_HZ.key, &keys::dither::DITHER_PHASE_DEG.key], &[NotZero(&keys::dither::DITHER_MM.key)]),
    (&[&keys::flow_force::FLOW_FORCE.key], &[Is(&keys::operator::MODEL.key, &["solenoid"])]),
    (&[&keys::flow_force::FLOW_FORCE_INLET.key, &keys::flow_force::FLOW_FORCE_OUTLET.key,
       &keys::valve::SPOOL_ROD_DIAMETER_MM.key], &[MEASURED_FORCE]),
    (&[&keys::discharge::DISCHARGE_MODEL.key], &[Is(&keys::valve::MODEL.key, WITH_AREAS)]),
    (&[&keys::valve::DISCHARGE_EXHAUST.key], &[CONSTANT_DISCHARGE]),
    (&[&keys::valve::DISCHARGE_SUPPLY.key], &[Any(&[CONSTANT_DISCHARGE, CONNECTORS, NotZero(&keys::tubing::LAG_S.key)])]),
    (&[&keys::valve::TURBULENCE.key], &[Is(&keys::valve::UPSTREAM_MACH.key, &["true"])]),
    (&[&keys::tubing::MODEL.key, &keys::tubing::DROP_SLOPE.key, &keys::tubing::REFERENCE_FLOW_KG_S.key,
       &keys::tubing::LENGTH_M.key, &keys::tubing::FRICTION_FACTOR.key], &[Is(&keys::valve::MODEL.key, WITH_TUBES)]),
    (&[&keys::tubing::DIAMETER_MM.key], &[Any(&[Is(&keys::tubing::MODEL.key, &["analytical"]), CONNECTORS])]),
    (&[&keys::tubing::LAG_S.key], &[Any(&[Is(&keys::tubing::MODEL.key, &["empirical", "analytical"]), CONNECTORS])]),
    (&[&keys::tubing::FLOW_CONTROL.key], &[Is(&keys::tubing::MODEL.key, &["none"])]),
    (&[&keys::tubing::FLOW_CONTROL_1_CONDUCTANCE.key], &[IsNot(&keys::vent::VENTED.key, &["chamber-1"])]),
    (&[&keys::tubing::FLOW_CONTROL_2_CONDUCTANCE.key], &[IsNot(&keys::vent::VENTED.key, &["chamber-2"])]),
    (&[&keys::leakage::LEAKAGE_COEFFICIENT.key], &[Is(&keys::leakage::LEAKAGE.key, &["laminar"])]),
    (&[&keys::leakage::PASSAGE_RESISTANCE.key, &keys::leakage::PASSAGE_CLEARANCE_M.key],
     &[Is(&keys::leakage::LEAKAGE.key, &["adiabatic"])]),
    (&[&keys::actuator::RESIDUAL_VOLUME_1_M3.key, &keys::test::PRESSURE_1_PA.key, &keys::test::TEMPERATURE_1_K.key],
     &[IsNot(&keys::vent::VENTED.key, &["chamber-1"])]),
    (&[&keys::actuator::RESIDUAL_VOLUME_2_M3.key, &keys::test::PRESSURE_2_PA.key, &keys::test::TEMPERATURE_2_K.key],
     &[IsNot(&keys::vent::VENTED.key, &["chamber-2"])]),
    (&[&keys::cushion::CUSHION_1_LENGTH_M.key], &[IsNot(&keys::vent::VENTED.key, &["chamber-1"])]),
    (&[&keys::cushion::CUSHION_2_LENGTH_M.key], &[IsNot(&keys::vent::VENTED.key, &["chamber-2"])]),
    (&[&keys::cushion::CUSHION_1_CONDUCTANCE.key],
     &[IsNot(&keys::vent::VENTED.key, &["chamber-1"]), NotZero(&keys::cushion::CUSHION_1_LENGTH_M.key)]),
    (&[&keys::cushion::CUSHION_2_CONDUCTANCE.key],
     &[IsNot(&keys::vent::VENTED.key, &["chamber-2"]), NotZero(&keys::cushion::CUSHION_2_LENGTH_M.key)]),
    (&[&keys::walls::WALL_TEMPERATURE_K.key], &[NotZero(&keys::walls::HEAT_TRANSFER_W_PER_M2_K.key)]),
    (&[&keys::test::RECEIVER_PRESSURE_PA.key], &[IsNot(&keys::supply::MODEL.key, &["ideal"])]),
    (&[&keys::test::MOVES_MM.key, &keys::test::TARGETS_MM.key], &[CLOSED]),
    (&[&keys::test::VELOCITY_MM_S.key, &keys::test::ACCELERATION_MM_S2.key], &[LIMITED]),
    (&[&keys::test::JERK_MM_S3.key],
     &[Any(&[Is(&keys::test::PROFILE.key, &["s-curve"]), Given(&keys::test::MOVE.key)])]),
];

impl When {
    /// What keeps it from holding in a rig: "controller.loop = \"open\""; None where it holds.
    fn broken(&self, rig: &Rig) -> Option<String> {
        let value = |key: &Key| rig.value(key.path);
        let (key, holds) = match self {
            Is(key, words) => (key, value(key).is_some_and(|value| is_among(value, words))),
            IsNot(key, words) => (key, value(key).is_some_and(|value| !is_among(value, words))),
            NotZero(key) => (key, !matches!(value(key), Some(Value::Number(0.0) | Value::Integer(0)))),
            Given(key) => (key, value(key).is_some()),
            Any(some) => {
                let broken: Option<Vec<String>> = some.iter().map(|one| one.broken(rig)).collect();
                return broken.map(|all| all.join(" and "));
            }
        };
        rig.idle(key).or_else(|| (!holds).then(|| in_words(rig, key)))
    }
}

fn is_among(value: &Value, words: &[&str]) -> bool {
    match value {
        Value::Word(word) => words.contains(&word.as_str()),
        Value::Switch(on) => words.contains(&if *on { "true" } else { "false" }),
        _ => false,
    }
}

/// "tubing.model = \"none\"", "no test.targets".
fn in_words(rig: &Rig, key: &Key) -> String {
    match rig.value(key.path) {
        Some(value) => format!("{} = {value}", key.path),
        None => format!("no {}", key.path),
    }
}

impl Rig {
    /// Whether a key has an effect in this rig.
    #[must_use]
    pub fn uses(&self, key: &Key) -> bool {
        self.idle(key).is_none()
    }

    /// Why a key has no effect in this rig: what it stands beside, such as `valve.model = "iso-6358"`. None where it has one.
    #[must_use]
    pub fn idle(&self, key: &Key) -> Option<String> {
        if !key.models.is_empty() {
            let chooser = chooser(key)?;
            if let Some(why) = self.idle(chooser) {
                return Some(why);
            }
            if !self.word_at(chooser.path).is_some_and(|word| key.models.contains(&word)) {
                return Some(in_words(self, chooser));
            }
        }
        // The path of a key, also of a copy of it, is one text at one place.
        let of_key = TABLE.iter().filter(|(keys, _)| keys.iter().any(|one| ptr::eq(one.path, key.path)));
        of_key.flat_map(|(_, all)| all.iter()).find_map(|when| when.broken(self))
    }

    /// Keys that were set and that have no effect.
    #[must_use]
    pub fn unused(&self) -> Vec<&'static str> {
        let unused = |key: &&Key| self.is_set(key) && !self.uses(key);
        all_keys().filter(unused).map(|key| key.path).collect()
    }

    /// Those of them whose values are not what the rig has without them anyway.
    #[must_use]
    pub fn written_in_vain(&self) -> BTreeSet<&'static str> {
        let unused = self.unused();
        if unused.is_empty() {
            return BTreeSet::new();
        }
        let without = self.without(&unused);
        unused.into_iter().filter(|path| without.value(path) != self.value(path)).collect()
    }

    /// Notes those of some keys that were written in vain.
    pub(super) fn note_idle(&self, keys: &BTreeSet<&'static str>, findings: &mut Findings) {
        if keys.is_empty() {
            return;
        }
        for path in self.written_in_vain().intersection(keys) {
            let why = find_key(path).and_then(|key| self.idle(key));
            findings.0.push((path, format!("has no effect with {}: leave it out", why.unwrap_or_default())));
        }
    }

    /// The rig without some of its keys.
    fn without(&self, paths: &[&str]) -> Rig {
        let mut other = self.clone();
        for key in paths.iter().filter_map(|path| find_key(path)) {
            other.set.remove(key.path);
            other.put(key.path, preset_value(&key.preset));
        }
        other.suit_others();
        other
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::key::Kind;

    fn conditions(when: &When) -> Vec<&When> {
        match when {
            Any(some) => some.iter().flat_map(conditions).collect(),
            one => vec![one],
        }
    }

    #[test]
    fn the_words_of_conditions_are_words_of_their_keys() {
        for when in TABLE.iter().flat_map(|(_, all)| all.iter()).flat_map(conditions) {
            if let Is(key, words) | IsNot(key, words) = when {
                let known = |word: &&str| match key.kind {
                    Kind::Choice(all) => all.iter().any(|(other, _)| other == word),
                    Kind::Switch => ["true", "false"].contains(word),
                    _ => false,
                };
                assert!(!words.is_empty() && words.iter().all(known), "{}: {words:?}", key.path);
            }
        }
    }

    #[test]
    fn a_row_of_the_table_holds_for_every_key_in_it_and_for_a_copy() {
        for key in TABLE.iter().flat_map(|(keys, _)| keys.iter()) {
            let copy = **key;
            let listed = find_key(key.path).expect("a key of the list");
            assert!(ptr::eq(listed.path, key.path) && ptr::eq(copy.path, key.path), "{}", key.path);
        }
    }

    #[test]
    fn a_key_stands_in_one_row_of_the_table() {
        let all: Vec<&str> = TABLE.iter().flat_map(|(keys, _)| keys.iter().map(|key| key.path)).collect();
        let once: BTreeSet<&str> = all.iter().copied().collect();
        assert_eq!(all.len(), once.len());
    }
}
