//! A key of a rig file: its range, default and meaning, and the Rust type of its value.
//!
//! Each component lists its own keys with `keys!`; [`crate::rig`] collects the lists. Units are part of the key's name
//! ([`unit()`]); equations get values in the unit of the name, or SI.

mod parameter;
mod units;

use std::fmt::Display;
use std::marker::PhantomData;
use std::ops::Deref;

pub(crate) use parameter::*;
pub use units::unit;

/// A list of a rig file whose entries are tables.
#[derive(Debug)]
pub struct Tables {
    /// Key of the list.
    pub path: &'static str,
    /// The name of an entry.
    pub entry: &'static str,
    /// The same, with the word that follows.
    pub entry_with: &'static str,
    /// The words of its first field, which chooses among the others, and their meanings.
    pub words: &'static [(&'static str, &'static str)],
    /// Every field of an entry, declared and read like a key of the file. `models` of a field are the words that have it.
    pub fields: &'static [Key],
}

impl Tables {
    /// The name of the field whose word chooses among the others.
    #[must_use]
    pub fn chooser(&self) -> &'static str {
        let path = self.fields[0].path;
        path.rsplit('.').next().unwrap_or(path)
    }
}

impl PartialEq for Tables {
    /// There is one list of a path.
    fn eq(&self, other: &Tables) -> bool {
        self.path == other.path
    }
}

/// The values that a key accepts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A real number within a range, ends included.
    Number {
        /// Smallest.
        min: f64,
        /// Largest.
        max: f64,
    },
    /// A whole number within a range.
    Integer {
        /// Smallest.
        min: i64,
        /// Largest.
        max: i64,
    },
    /// true or false.
    Switch,
    /// One of some words; each with whether it is implemented.
    Choice(&'static [(&'static str, bool)]),
    /// A list of whole numbers within a range.
    Integers {
        /// Smallest.
        min: i64,
        /// Largest.
        max: i64,
        /// Most entries.
        max_entries: usize,
    },
    /// A list of real numbers.
    Numbers {
        /// Fewest entries.
        least: usize,
        /// Most entries.
        most: usize,
    },
    /// A list of rows of real numbers.
    Rows {
        /// The meaning of each number of a row.
        columns: &'static [&'static str],
        /// Most rows.
        max_rows: usize,
    },
    /// A list of [time in s, whole number].
    Moves,
    /// A list of tables.
    Tables(&'static Tables),
    /// Text.
    Text,
    /// No equation has it: only the default is accepted.
    DefaultOnly,
}

/// The value of a key that the file does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Preset {
    /// A real number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// true or false.
    Switch(bool),
    /// A word.
    Choice(&'static str),
    /// Whole numbers.
    Integers(&'static [i64]),
    /// Moves.
    Moves(&'static [(f64, i64)]),
    /// No value; its meaning, for the help text.
    Absent(&'static str),
}

/// One key of a rig file.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// "table.name", as in errors and `--set`; the top level has no table.
    pub path: &'static str,
    /// The accepted values.
    pub kind: Kind,
    /// The value without it.
    pub preset: Preset,
    /// Models that use it; empty: all.
    pub models: &'static [&'static str],
    /// The key that has one of the models; None: `model` of the same table.
    pub chosen_by: Option<&'static Key>,
    /// Name in the thesis, or "".
    pub thesis: &'static str,
    /// Its meaning.
    pub meaning: &'static str,
    /// Whether `--spread` draws it: a physical value that nobody knows exactly.
    pub spread: bool,
    /// Whether it is known only to a factor of two before there are data.
    pub vague: bool,
}

impl Key {
    /// The table, "" for the top level.
    #[must_use]
    pub fn table(&self) -> &'static str {
        self.path.split_once('.').map_or("", |(table, _)| table)
    }

    /// Whether it belongs to a table.
    #[must_use]
    pub fn is_in(&self, table: &str) -> bool {
        self.path.strip_prefix(table).is_some_and(|rest| rest.starts_with('.'))
    }

    /// A setting of this key as `--set` takes it: `test.duration_s=3.1`.
    #[must_use]
    pub fn setting(&self, value: impl Display) -> String {
        format!("{}={value}", self.path)
    }

    /// The name within the table.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.path.split_once('.').map_or(self.path, |(_, name)| name)
    }

    /// The unit, from the name; "" for a plain number.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        unit(self.name()).1
    }
}

/// A key whose value is a `T`.
#[derive(Clone, Copy, Debug)]
pub struct Typed<T> {
    /// The description of the key.
    pub key: Key,
    value: PhantomData<fn() -> T>,
}

impl<T> Deref for Typed<T> {
    type Target = Key;

    fn deref(&self) -> &Key {
        &self.key
    }
}

impl<T> Typed<T> {
    const fn new(
        path: &'static str,
        kind: Kind,
        preset: Preset,
        thesis: &'static str,
        meaning: &'static str,
    ) -> Self {
        let key = Key {
            path,
            kind,
            preset,
            models: &[],
            chosen_by: None,
            thesis,
            meaning,
            spread: false,
            vague: false,
        };
        Typed { key, value: PhantomData }
    }

    /// The key of some of its table's models only.
    #[must_use]
    pub(crate) const fn of(self, models: &'static [&'static str]) -> Self {
        Typed { key: Key { models, ..self.key }, ..self }
    }

    /// The key of some of the models that another key than `model` of the table chooses.
    #[must_use]
    pub(crate) const fn chosen_by<C: Choice>(
        self,
        chooser: &'static Typed<C>,
        models: &'static [&'static str],
    ) -> Self {
        Typed { key: Key { models, chosen_by: Some(&chooser.key), ..self.key }, ..self }
    }

    /// A value that is known only to a factor of two: friction, leakage and the like.
    #[must_use]
    pub(crate) const fn vague(self) -> Self {
        Typed { key: Key { vague: true, ..self.key }, ..self }
    }

    /// A physical value that nobody knows exactly.
    #[must_use]
    pub(crate) const fn spread(self) -> Self {
        Typed { key: Key { spread: true, ..self.key }, ..self }
    }

    /// A key of the thesis that no equation here has.
    #[must_use]
    pub(crate) const fn default_only(self) -> Self {
        Typed { key: Key { kind: Kind::DefaultOnly, ..self.key }, ..self }
    }
}

pub(crate) const fn number(
    path: &'static str,
    preset: f64,
    min: f64,
    max: f64,
    thesis: &'static str,
    meaning: &'static str,
) -> Typed<f64> {
    Typed::new(path, Kind::Number { min, max }, Preset::Number(preset), thesis, meaning)
}

/// A number that may be absent, and the meaning of that.
pub(crate) const fn optional_number(
    path: &'static str,
    min: f64,
    max: f64,
    absent: &'static str,
    thesis: &'static str,
    meaning: &'static str,
) -> Typed<Option<f64>> {
    Typed::new(path, Kind::Number { min, max }, Preset::Absent(absent), thesis, meaning)
}

pub(crate) const fn integer(
    path: &'static str,
    preset: i64,
    min: i64,
    max: i64,
    thesis: &'static str,
    meaning: &'static str,
) -> Typed<i64> {
    Typed::new(path, Kind::Integer { min, max }, Preset::Integer(preset), thesis, meaning)
}

pub(crate) const fn switch(
    path: &'static str,
    preset: bool,
    thesis: &'static str,
    meaning: &'static str,
) -> Typed<bool> {
    Typed::new(path, Kind::Switch, Preset::Switch(preset), thesis, meaning)
}

/// One of the words of `C`, the first one without the key.
pub(crate) const fn choice<C: Choice>(
    path: &'static str,
    thesis: &'static str,
    meaning: &'static str,
) -> Typed<C> {
    Typed::new(path, Kind::Choice(C::WORDS), Preset::Choice(C::WORDS[0].0), thesis, meaning)
}

/// A key of another kind.
pub(crate) const fn other<T>(
    path: &'static str,
    kind: Kind,
    preset: Preset,
    thesis: &'static str,
    meaning: &'static str,
) -> Typed<T> {
    Typed::new(path, kind, preset, thesis, meaning)
}

/// A list of numbers that may be absent, and the meaning of that.
pub(crate) const fn optional_numbers(
    path: &'static str,
    count: usize,
    absent: &'static str,
    thesis: &'static str,
    meaning: &'static str,
) -> Typed<Option<Vec<f64>>> {
    Typed::new(path, Kind::Numbers { least: count, most: count }, Preset::Absent(absent), thesis, meaning)
}

/// Rows of numbers that may be absent, and the meaning of that.
pub(crate) const fn optional_rows(
    path: &'static str,
    columns: &'static [&'static str],
    max_rows: usize,
    absent: &'static str,
    thesis: &'static str,
    meaning: &'static str,
) -> Typed<Option<Vec<Vec<f64>>>> {
    Typed::new(path, Kind::Rows { columns, max_rows }, Preset::Absent(absent), thesis, meaning)
}

/// Words that a key takes, as a Rust type.
pub trait Choice: Copy + PartialEq + Sized + 'static {
    /// Each word, with whether it is implemented; the first one is the default.
    const WORDS: &'static [(&'static str, bool)];

    /// The meaning of a word; None for one that is not implemented.
    fn of_word(word: &str) -> Option<Self>;

    /// The word.
    fn word(self) -> &'static str;
}

/// Declares a type for the words of a key, and the words that are not implemented.
macro_rules! words {
    (
        $(#[$about:meta])*
        $visibility:vis enum $name:ident {
            $($(#[$meaning:meta])* $variant:ident = $word:literal,)+
        } $(not built $($unbuilt:literal)+)?
    ) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $visibility enum $name {
            $($(#[$meaning])* $variant,)+
        }

        impl $crate::key::Choice for $name {
            const WORDS: &'static [(&'static str, bool)] =
                &[$(($word, true),)+ $($(($unbuilt, false),)+)?];

            fn of_word(word: &str) -> Option<Self> {
                match word {
                    $($word => Some($name::$variant),)+
                    _ => None,
                }
            }

            fn word(self) -> &'static str {
                match self {
                    $($name::$variant => $word,)+
                }
            }
        }

        impl $crate::values::FromValue for $name {
            fn from_value(value: Option<&$crate::values::Value>) -> Option<Self> {
                match value {
                    Some($crate::values::Value::Word(word)) => $crate::key::Choice::of_word(word),
                    _ => None,
                }
            }
        }
    };
}

/// Declares the keys of a component, and the list of them that [`crate::rig`] collects. Those of the controller's table come
/// as its lines.
macro_rules! keys {
    ($($name:ident: $type:ty = $key:expr;)*) => { $crate::key::keys! { {} $($name: $type = $key;)* } };
    (
        { $($id:literal $constant:ident $own:literal $unit:literal $range:tt $parameter:tt $thesis:literal $meaning:literal
            $(only $($law:ident)+)?;)* }
        $($name:ident: $type:ty = $key:expr;)*
    ) => {
        /// Keys of a rig file, in the order of `rig explain`.
        #[allow(missing_docs, clippy::wildcard_imports)]
        #[rustfmt::skip]
        pub mod keys {
            #[allow(unused_imports)]
            use super::*;
            #[allow(unused_imports)]
            use $crate::key::*;

            #[allow(unused_imports)]
            use pneudrive_controller::parameters::id;

            $(pub static $name: Typed<$type> = $key;)*
            $($crate::key::parameter_key!($constant $parameter $(.chosen_by(&LAW, &[$(Law::$law.word()),+]))?);)*

            /// All of them.
            pub static ALL: &[&Key] = &[
                $(&$name.key,)*
                $($crate::key::declared_key!($constant $parameter),)*
            ];
        }
    };
}

pub(crate) use {keys, words};
