//! A rig with another test, or with other numbers.

use std::borrow::Cow;

use super::problem::{Problem, Problems};
use super::table::find_key;
use crate::component::controller::ControllerKind;
use crate::key::{Choice, Kind};
use crate::keys;
use crate::values::{Rig, Value};

/// The tables of the controller's own settings, and of what it is told.
const OWN: [&str; 3] = ["controller.", "safety.", "test."];

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

    /// This rig with other numbers under some keys of its plant, in the units of their names ([`Rig::with_plant`]).
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
            rig.keep(path);
        }
        rig.keep_nominal_of(self);
        rig.checked(self.name())
    }

    /// The controller takes this rig for what it took `other` for, but for its own settings.
    pub(crate) fn keep_nominal_of(&mut self, other: &Rig) {
        let of_plant = |path: &str| OWN.iter().all(|own| !path.starts_with(own));
        let paths = self.values.keys().chain(other.values.keys()).copied();
        let differ = paths.filter(|path| of_plant(path) && self.value(path) != other.value(path));
        let differ: Vec<&'static str> = differ.collect();
        self.nominal.clone_from(&other.nominal);
        for path in differ {
            self.nominal.entry(path).or_insert_with(|| other.value(path).cloned());
        }
    }

    /// The rig that the controller takes this one for.
    pub(crate) fn nominal(&self) -> Cow<'_, Rig> {
        if self.nominal.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut rig = self.clone();
        for (path, value) in std::mem::take(&mut rig.nominal) {
            rig.put(path, value);
        }
        Cow::Owned(rig)
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
