//! A rig with another test, or with other numbers.

use super::problem::{Problem, Problems};
use super::table::find_key;
use crate::component::controller::ControllerKind;
use crate::key::{Choice, Kind};
use crate::keys;
use crate::values::{Rig, Value};

impl Rig {
    /// This rig with the `[test]` of another.
    ///
    /// # Errors
    /// When that test does not fit this rig.
    pub fn with_test_of(&self, other: &Rig) -> Result<Rig, Problems> {
        let control_loop = &keys::controller::LOOP;
        let (theirs, ours) = (other.get(control_loop), self.get(control_loop));
        if other.is_set(control_loop) && theirs != ours {
            return Err(Problems(vec![Problem {
                source: other.name().to_owned(),
                line: None,
                key: control_loop.path.to_owned(),
                message: format!(
                    "its test is for the {} loop, the rig's is {}: the moves would mean something else",
                    theirs.word(),
                    ours.word()
                ),
            }]));
        }
        let mut rig = self.clone();
        for key in keys::test::ALL {
            rig.put(key.path, other.value(key.path).cloned());
            if other.is_set(key) {
                rig.set.insert(key.path);
            } else {
                rig.set.remove(key.path);
            }
            match other.origins.get(key.path) {
                Some(origin) => rig.origins.insert(key.path, origin.clone()),
                None => rig.origins.remove(key.path),
            };
        }
        rig.checked(other.name())
    }

    /// This rig with other numbers under some keys, in the units of their names.
    ///
    /// # Errors
    /// When a number is out of its key's range, or a constraint between keys does not hold.
    ///
    /// # Panics
    /// When there is no such key, or its value is not a number.
    pub fn with_numbers(&self, numbers: &[(&'static str, f64)]) -> Result<Rig, Problems> {
        let mut rig = self.clone();
        for &(path, number) in numbers {
            let Some(Kind::Number { min, max }) = find_key(path).map(|key| key.kind) else {
                panic!("{path} takes no number")
            };
            if !(min..=max).contains(&number) {
                let message = format!("must be between {min} and {max}, is {number}");
                let source = self.name().to_owned();
                return Err(Problems(vec![Problem { source, line: None, key: path.to_owned(), message }]));
            }
            rig.put(path, Some(Value::Number(number)));
        }
        rig.checked(self.name())
    }

    /// This rig with nothing that goes wrong in its test.
    #[must_use]
    pub fn without_events(&self) -> Rig {
        let mut rig = self.clone();
        rig.put(keys::faults::EVENT.path, None);
        rig
    }

    /// The same from its first sample on, its valve driven from sample to sample: for tests of its parts.
    #[must_use]
    pub fn on_bench(&self) -> Rig {
        let mut rig = self.without_events();
        rig.put(keys::controller::MODEL.path, Some(Value::Word(ControllerKind::Sampled.word().to_owned())));
        rig.put(keys::controller::START_S.path, Some(Value::Number(0.0)));
        rig
    }
}
