//! The list of all keys: those of the components, in the order in which `rig explain` shows them.

use crate::key::{Key, Preset, keys};
use crate::values::{Rig, Value};

keys! {
    NAME: Option<String> = other("name", Kind::Text, Preset::Absent("the name of the file"), "", "What the rig is called in reports and TARGET files.");
}

/// The lists of the components: of each, or of its models.
#[rustfmt::skip]
static LISTS: &[&[&[&Key]]] = &[
    BEFORE_VALVE, crate::component::valve::KEYS[0], crate::component::valve::KEYS[1], crate::component::valve::KEYS[2],
    BEFORE_FRICTION, crate::component::friction::KEYS, BEHIND_FRICTION,
];

#[rustfmt::skip]
static BEFORE_VALVE: &[&[&Key]] = &[
    keys::ALL,
    crate::keys::gas::ALL, crate::keys::supply::ALL, crate::keys::receiver::ALL, crate::keys::regulator::ALL, crate::keys::exhaust::ALL,
    crate::keys::controller::ALL, crate::keys::encoder::ALL, crate::keys::sensors::ALL,
    crate::keys::operator::ALL, crate::keys::solenoid::ALL, crate::keys::hysteresis::ALL, crate::keys::dither::ALL, crate::keys::amplifier::ALL,
    crate::keys::empirical::ALL, crate::keys::stepper::ALL, crate::keys::on_off::ALL,
];

#[rustfmt::skip]
static BEFORE_FRICTION: &[&[&Key]] = &[
    crate::keys::tubing::ALL,
    crate::keys::actuator::ALL, crate::keys::leakage::ALL, crate::keys::walls::ALL, crate::keys::vent::ALL, crate::keys::return_spring::ALL, crate::keys::cushion::ALL,
    crate::keys::load::ALL,
];

#[rustfmt::skip]
static BEHIND_FRICTION: &[&[&Key]] = &[
    crate::keys::stop::ALL,
    crate::keys::faults::ALL, crate::keys::gain_bug::ALL,
    crate::keys::safety::ALL,
    crate::keys::test::ALL,
];

/// Every key of a rig file.
pub fn all_keys() -> impl Iterator<Item = &'static Key> {
    LISTS.iter().copied().flatten().copied().flatten().copied()
}

/// The key with a path.
#[must_use]
pub fn find_key(path: &str) -> Option<&'static Key> {
    all_keys().find(|key| key.path == path)
}

/// The key that has the model which a key belongs to, if there are several.
#[must_use]
pub fn chooser(key: &Key) -> Option<&'static Key> {
    key.chosen_by.or_else(|| find_key(&format!("{}.model", key.table())))
}

/// The value that holds without a key, if one does.
pub(crate) fn preset_value(preset: &Preset) -> Option<Value> {
    Some(match preset {
        Preset::Number(value) => Value::Number(*value),
        Preset::Integer(value) => Value::Integer(*value),
        Preset::Switch(on) => Value::Switch(*on),
        Preset::Choice(word) => Value::Word((*word).to_owned()),
        Preset::Integers(values) => Value::Integers(values.to_vec()),
        Preset::Moves(moves) => Value::Moves(moves.to_vec()),
        Preset::Absent(_) => return None,
    })
}

/// The empty file: servo-drive B as the thesis's Appendix VII has it.
pub(crate) fn presets() -> Rig {
    let value = |key: &'static Key| preset_value(&key.preset).map(|value| (key.path, value));
    Rig { values: all_keys().filter_map(value).collect(), ..Rig::default() }
}

impl Rig {
    /// The name of the rig.
    #[must_use]
    pub fn name(&self) -> &str {
        match self.value(keys::NAME.path) {
            Some(Value::Word(name)) => name,
            _ => "rig",
        }
    }

    /// Every key that has a value, in the order of the list.
    pub fn entries(&self) -> impl Iterator<Item = (&'static Key, &Value)> {
        all_keys().filter_map(|key| self.values.get(key.path).map(|value| (key, value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::key::Kind;

    #[test]
    fn paths_are_unique_and_explained() {
        let keys: Vec<&Key> = all_keys().collect();
        for (i, key) in keys.iter().enumerate() {
            assert!(keys[..i].iter().all(|other| other.path != key.path), "{}", key.path);
            assert!(key.meaning.ends_with('.'), "{}", key.path);
        }
    }

    #[test]
    fn the_keys_of_a_table_stand_together() {
        let mut tables: Vec<&str> = all_keys().map(Key::table).collect();
        tables.dedup();
        let once: std::collections::BTreeSet<&str> = tables.iter().copied().collect();
        assert_eq!(tables.len(), once.len(), "{tables:?}");
    }

    #[test]
    fn the_models_of_a_key_are_words_of_the_key_that_chooses_among_them() {
        for key in all_keys().filter(|key| !key.models.is_empty()) {
            let Some(Kind::Choice(words)) = chooser(key).map(|chooser| chooser.kind) else {
                panic!("{} has models, and no key chooses among them", key.path)
            };
            let known = |model: &&str| words.iter().any(|(word, _)| word == model);
            assert!(key.models.iter().all(known), "{}: {:?}", key.path, key.models);
        }
    }

    #[test]
    fn presets_lie_in_their_ranges() {
        for key in all_keys() {
            match (key.kind, key.preset) {
                (Kind::Number { min, max }, Preset::Number(value)) => {
                    assert!((min..=max).contains(&value), "{}", key.path);
                }
                (Kind::Integer { min, max }, Preset::Integer(value)) => {
                    assert!((min..=max).contains(&value), "{}", key.path);
                }
                (Kind::Choice(options), Preset::Choice(word)) => {
                    assert!(options.iter().any(|&(name, built)| name == word && built), "{}", key.path);
                }
                _ => {}
            }
        }
    }
}
