//! Keys that set a parameter of the controller by themselves: all that is known of one stands in its line of the controller's
//! table.

use pneudrive_controller::choice::{Adapt, EncoderKind, HomingKind, Law, Loop};
use pneudrive_controller::parameters::{Parameter, line};

use super::{Choice, Kind, Preset, Typed};

pub(crate) const fn whole_parameter(id: u16) -> Typed<i64> {
    let Parameter { min, max, default, .. } = line(id);
    of_line(id, Kind::Integer { min: min as i64, max: max as i64 }, Preset::Integer(default as i64))
}

/// In a unit that is 10^`digits` times that of the parameter.
pub(crate) const fn scaled_parameter(id: u16, digits: u32) -> Typed<f64> {
    let Parameter { min, max, default, .. } = line(id);
    let unit = 10_u64.pow(digits) as f64;
    let kind = Kind::Number { min: min as f64 / unit, max: max as f64 / unit };
    of_line(id, kind, Preset::Number(default as f64 / unit))
}

pub(crate) const fn switch_parameter(id: u16) -> Typed<bool> {
    of_line(id, Kind::Switch, Preset::Switch(line(id).default != 0))
}

pub(crate) const fn words_parameter<C: Choice>(id: u16) -> Typed<C> {
    of_line(id, Kind::Choice(C::WORDS), Preset::Choice(C::WORDS[line(id).default as usize].0))
}

pub(crate) const fn of_line<T>(id: u16, kind: Kind, preset: Preset) -> Typed<T> {
    let Parameter { key, thesis, meaning, .. } = line(id);
    match key {
        Some(key) => Typed::new(key.path, kind, preset, thesis, meaning),
        None => panic!("a parameter without a key"),
    }
}

/// Declares the key of a line: under the constant that the line gives it, or that of the parameter.
macro_rules! parameter_key {
    ($constant:ident ($key:ident $name:literal $($form:tt)+) $($more:tt)*) => {
        $crate::key::parameter_key!(@ $key $constant [$($form)+] $($more)*);
    };
    ($constant:ident ($($form:tt)+) $($more:tt)*) => {
        $crate::key::parameter_key!(@ $constant $constant [$($form)+] $($more)*);
    };
    (@ $key:ident $constant:ident [Whole] $($more:tt)*) => {
        pub static $key: Typed<i64> = whole_parameter(id::$constant)$($more)*;
    };
    (@ $key:ident $constant:ident [Scaled($digits:literal)] $($more:tt)*) => {
        pub static $key: Typed<f64> = scaled_parameter(id::$constant, $digits)$($more)*;
    };
    (@ $key:ident $constant:ident [Switch] $($more:tt)*) => {
        pub static $key: Typed<bool> = switch_parameter(id::$constant)$($more)*;
    };
    (@ $key:ident $constant:ident [Words($words:ident)] $($more:tt)*) => {
        pub static $key: Typed<$words> = words_parameter(id::$constant)$($more)*;
    };
}

/// The key of a line.
macro_rules! declared_key {
    ($constant:ident ($key:ident $name:literal $($form:tt)+)) => {
        &$key.key
    };
    ($constant:ident ($($form:tt)+)) => {
        &$constant.key
    };
}

pub(crate) use {declared_key, parameter_key};

/// The controller's words are those of keys.
macro_rules! choices {
    ($($words:ident)+) => {$(
        impl Choice for $words {
            const WORDS: &'static [(&'static str, bool)] = &built::<{ $words::WORDS.len() }>($words::WORDS);

            fn of_word(word: &str) -> Option<Self> {
                $words::ALL.iter().copied().find(|choice| choice.word() == word)
            }

            fn word(self) -> &'static str {
                $words::word(self)
            }
        }

        impl $crate::values::FromValue for $words {
            fn from_value(value: Option<&$crate::values::Value>) -> Option<Self> {
                match value {
                    Some($crate::values::Value::Word(word)) => Choice::of_word(word),
                    _ => None,
                }
            }
        }
    )+};
}

choices! { Adapt Law Loop HomingKind EncoderKind }

const fn built<const N: usize>(words: &[&'static str]) -> [(&'static str, bool); N] {
    let mut built = [("", true); N];
    let mut place = 0;
    while place < N {
        built[place].0 = words[place];
        place += 1;
    }
    built
}
