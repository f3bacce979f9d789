//! Rig files: one drive and one test, in TOML.
//!
//! [`keys`] is the table of all keys. [`Rig::read`] takes a file apart by it and names file, line and
//! key of everything that is wrong; a [`Rig`] that exists is valid: every value in its range, no
//! division by zero, nothing unphysical, nothing that is not built. It hands out values in SI.

mod builtin;
mod check;
mod controller;
mod events;
mod explain;
pub mod keys;
mod problem;
mod read;
mod schedule;
mod spread;
pub mod thesis;

pub use builtin::{BUILTIN, builtin};
pub use check::MOST_DISCHARGE;
pub use events::Fields;
pub use explain::explain;
pub use problem::{Problem, Problems, line_at};
pub use read::{nearest, value_of_setting};
pub use spread::{SpreadError, unit_interval};

use keys::{Default, KEYS, Key, Kind};

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
    /// Tables of named values.
    Events(Vec<Fields>),
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

    /// This rig with other numbers under some keys, in the units of their names.
    ///
    /// # Errors
    /// When a number is out of its key's range, or what must hold between keys does not.
    ///
    /// # Panics
    /// When the table has no such key, or the key takes no number.
    pub fn with_numbers(&self, numbers: &[(&'static str, f64)]) -> Result<Rig, Problems> {
        let mut rig = self.clone();
        for &(path, number) in numbers {
            let index = Rig::index(path);
            let Kind::Number { min, max } = KEYS[index].kind else { panic!("{path} takes no number") };
            if !(min..=max).contains(&number) {
                let message = format!("must be between {min} and {max}, is {number}");
                let source = self.name().to_owned();
                return Err(Problems(vec![Problem { source, line: None, key: path.to_owned(), message }]));
            }
            rig.values[index] = Some(Value::Number(number));
        }
        rig.checked(self.name())
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
