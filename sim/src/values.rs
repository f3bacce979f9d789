//! The values of a rig: one drive and one test.
//!
//! [`crate::rig`] makes a [`Rig`], and the components read it. A rig that exists is valid.

use std::collections::{BTreeMap, BTreeSet};

use crate::key::{Key, Typed};

/// The fields of an event of [`crate::component::faults`], with their values.
pub type Fields = Vec<(&'static str, Value)>;

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
    /// Rows of real numbers.
    Rows(Vec<Vec<f64>>),
    /// [time in s, counts].
    Moves(Vec<(f64, i64)>),
    /// Tables of named values.
    Events(Vec<Fields>),
}

/// A type of a key's value.
pub trait FromValue: Sized {
    /// The value in this type; None if it is of another type.
    fn from_value(value: Option<&Value>) -> Option<Self>;
}

macro_rules! from_value {
    ($($type:ty: $variant:ident($value:ident) => $read:expr;)+) => {$(
        impl FromValue for $type {
            fn from_value(value: Option<&Value>) -> Option<Self> {
                match value {
                    Some(Value::$variant($value)) => Some($read),
                    _ => None,
                }
            }
        }

        impl FromValue for Option<$type> {
            fn from_value(value: Option<&Value>) -> Option<Self> {
                Some(<$type>::from_value(value))
            }
        }
    )+};
}

from_value! {
    f64: Number(value) => *value;
    i64: Integer(value) => *value;
    bool: Switch(value) => *value;
    String: Word(value) => value.clone();
    Vec<i64>: Integers(values) => values.clone();
    Vec<f64>: Numbers(values) => values.clone();
    Vec<Vec<f64>>: Rows(rows) => rows.clone();
    Vec<(f64, i64)>: Moves(moves) => moves.clone();
    Vec<Fields>: Events(events) => events.clone();
}

/// The origin of a key's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The file does not have the key; the value is that of servo-drive B.
    Default,
    /// The file has it, from a data sheet or a measurement.
    Given,
    /// Computed from other figures.
    Computed,
    /// The usual value for parts of this kind.
    Typical,
    /// A guess: the value lies somewhere in its range.
    Unknown,
}

impl Source {
    /// The word for it.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Source::Default => "default",
            Source::Given => "given",
            Source::Computed => "computed",
            Source::Typical => "typical",
            Source::Unknown => "unknown",
        }
    }
}

/// The origin of a key's value, with its range and source.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin {
    /// How it came about.
    pub source: Source,
    /// The range of the value, in the unit of the key, if the file states it.
    pub range: Option<[f64; 2]>,
    /// The formula, the publication or the test that finds it; empty if the file states none.
    pub from: String,
}

impl Origin {
    fn bare(source: Source) -> Origin {
        Origin { source, range: None, from: String::new() }
    }
}

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

/// The value of a field of a table in a list.
pub(crate) fn field<'a>(table: &'a Fields, name: &str) -> Option<&'a Value> {
    table.iter().find(|(field, _)| *field == name).map(|(_, value)| value)
}

/// The instant of a whole number of microseconds, s: rounded once.
pub(crate) fn seconds(microseconds: u64) -> f64 {
    // A signed number becomes a float in one instruction; no time is too large for it.
    microseconds as i64 as f64 / 1e6
}

/// Seconds as whole microseconds, if they are (to a thousandth of one).
pub(crate) fn whole_microseconds(seconds: f64) -> Option<u64> {
    let us = (seconds * 1e6).round();
    (us >= 0.0 && (seconds * 1e6 - us).abs() < 1e-3).then_some(us as u64)
}

/// The problems of a rig's values, each at a key.
#[derive(Debug, Default)]
pub struct Findings(pub Vec<(&'static str, String)>);

impl Findings {
    /// Notes an error at a key.
    pub fn note(&mut self, key: &Key, message: impl Into<String>) {
        self.0.push((key.path, message.into()));
    }

    /// `lower` must not be above `upper`.
    pub fn not_above(&mut self, rig: &Rig, lower: &Typed<f64>, upper: &Typed<f64>, why: &str) {
        let (low, high) = (rig.get(lower), rig.get(upper));
        if low > high {
            self.note(lower, format!("must not be above {} = {high}, is {low}: {why}", upper.path));
        }
    }

    /// `lower` must be below `upper`.
    pub fn below(&mut self, rig: &Rig, lower: &Typed<f64>, upper: &Typed<f64>, why: &str) {
        let (low, high) = (rig.get(lower), rig.get(upper));
        if low >= high {
            self.note(lower, format!("must be below {} = {high}, is {low}: {why}", upper.path));
        }
    }
}
