//! The values of a rig: their types, where each comes from, and the [`Rig`] that holds them.

mod findings;
mod rig;
mod time;

pub use findings::Findings;
pub use rig::Rig;
pub(crate) use time::{seconds, whole_microseconds};

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

/// The value of a field of a table in a list.
pub(crate) fn field<'a>(table: &'a Fields, name: &str) -> Option<&'a Value> {
    table.iter().find(|(field, _)| *field == name).map(|(_, value)| value)
}
