//! One drive and one test: a value for every key that has one.
//!
//! [`crate::rigfile`] reads a [`Rig`], [`crate::rig`] checks it, and the components take their values from it. A rig that
//! exists is valid.

use std::collections::{BTreeMap, BTreeSet};

use super::time::whole_microseconds;
use super::{FromValue, Origin, Source, Value};
use crate::key::{Key, Typed};

/// A valid rig: a value for every key that has one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rig {
    pub(crate) values: BTreeMap<&'static str, Value>,
    /// Keys that the file or the command line has set.
    pub(crate) set: BTreeSet<&'static str>,
    /// The origins of values, as the file states them.
    pub(crate) origins: BTreeMap<&'static str, Origin>,
    /// What the controller takes for the values of some keys, where the plant has others ([`Rig::with_plant`]).
    pub(crate) nominal: BTreeMap<&'static str, Option<Value>>,
}

impl Rig {
    /// The value of a key, in the unit of its name.
    ///
    /// # Panics
    /// When the rig has no value of the key's type: a slip in the list of keys, not in a file.
    #[must_use]
    pub fn get<T: FromValue>(&self, key: &Typed<T>) -> T {
        T::from_value(self.values.get(key.path)).unwrap_or_else(|| panic!("{} has no such value", key.path))
    }

    /// The value of the key with a path that is known at run time only, if it has one.
    #[must_use]
    pub fn value(&self, path: &str) -> Option<&Value> {
        self.values.get(path)
    }

    /// The same, if it is a number.
    #[must_use]
    pub fn number_at(&self, path: &str) -> Option<f64> {
        f64::from_value(self.value(path))
    }

    /// The same, if it is a word.
    #[must_use]
    pub fn word_at(&self, path: &str) -> Option<&str> {
        match self.value(path) {
            Some(Value::Word(word)) => Some(word),
            _ => None,
        }
    }

    /// The same, if it is a switch.
    #[must_use]
    pub fn switch_at(&self, path: &str) -> Option<bool> {
        bool::from_value(self.value(path))
    }

    /// Whether the file or the command line has set a key.
    #[must_use]
    pub fn is_set(&self, key: &Key) -> bool {
        self.set.contains(key.path)
    }

    /// Where the value of a key comes from.
    #[must_use]
    pub fn origin(&self, key: &Key) -> Origin {
        match self.origins.get(key.path) {
            Some(origin) => origin.clone(),
            None if self.is_set(key) => Origin::bare(Source::Given),
            None => Origin::bare(Source::Default),
        }
    }

    pub(crate) fn put(&mut self, path: &'static str, value: Option<Value>) {
        match value {
            Some(value) => self.values.insert(path, value),
            None => self.values.remove(path),
        };
    }

    /// A value in whole microseconds, of a key in seconds.
    #[must_use]
    pub fn microseconds(&self, key: &Typed<f64>) -> u64 {
        whole_microseconds(self.get(key)).unwrap_or(0)
    }
}
