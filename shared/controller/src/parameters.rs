//! The one table of the controller's parameters.
//!
//! Its [lines](crate::parameter_table) make the ids, ranges and defaults that a board needs, and names, units, keys and help
//! that only a PC does: what a board does not read is not in its image. Keys of rig files, names on the device, JSON and help
//! come from it. Values are `i32`, whatever type they become in [`Config`](crate::Config).

#[macro_use]
mod table;

use crate::choice::{Adapt, EncoderKind, HomingKind, Law, Loop};

/// What is kept of what the law has learned.
pub const KEPT: [u16; 9] = [
    id::KEPT_MASS,
    id::KEPT_FRICTION,
    id::KEPT_FORCE,
    id::KEPT_VISCOUS,
    id::KEPT_PACE,
    id::KEPT_LOOSENESS,
    id::KEPT_ARMINGS,
    id::KEPT_AT_BOUND,
    id::KEPT_CHANGED,
];

/// Whether arming makes a parameter of what the last run has learned.
#[must_use]
pub fn is_learned(id: u16) -> bool {
    id == id::NULL_OFFSET_COUNTS || KEPT.contains(&id)
}

/// Entries of the gain profile (thesis 6.3.3).
pub const PROFILE_LEN: usize = 256;

/// How a rig file writes a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// As it is.
    Whole,
    /// In a unit that is 10 to this power times as large, given by the key's name.
    Scaled(u32),
    /// As a word; its place is the value.
    Words(&'static [&'static str]),
}

/// The key of a rig file that sets a parameter by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RigKey {
    /// "table.name".
    pub path: &'static str,
    /// How it writes the value.
    pub form: Form,
}

/// One line of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// What it is stored and sent under; an array has consecutive ids from here on.
    pub id: u16,
    /// Name as users type it.
    pub name: &'static str,
    /// Entries: 1, or the length of an array.
    pub len: u16,
    /// Unit, or "" for a plain number.
    pub unit: &'static str,
    /// Smallest allowed value.
    pub min: i32,
    /// Largest allowed value.
    pub max: i32,
    /// Value of a new controller (thesis Appendix VII where it has one).
    pub default: i32,
    /// Its key in a rig file, unless that computes it from several.
    pub key: Option<RigKey>,
    /// What it does.
    pub meaning: &'static str,
    /// Name in the thesis, or "".
    pub thesis: &'static str,
}

/// The key that a line tells.
macro_rules! key {
    ($table:ident $name:literal ()) => { None };
    (components $name:literal ($path:literal $($form:tt)+)) => { Some(RigKey { path: $path, form: form!($($form)+) }) };
    ($table:ident $name:literal ($key:ident $own:literal $($form:tt)+)) => { key!($table $own ($($form)+)) };
    ($table:ident $name:literal ($($form:tt)+)) => {
        Some(RigKey { path: concat!(stringify!($table), ".", $name), form: form!($($form)+) })
    };
}

macro_rules! form {
    (Whole) => {
        Form::Whole
    };
    (Scaled($digits:literal)) => {
        Form::Scaled($digits)
    };
    (Switch) => {
        Form::Words(&["false", "true"])
    };
    (Polarity) => {
        Form::Words(&["1", "-1"])
    };
    (Words($words:ident)) => {
        Form::Words($words::WORDS)
    };
}

/// Makes the ids and the lines.
macro_rules! table {
    ($($section:ident {
        $($id:literal $constant:ident $name:literal $unit:literal [$min:expr, $max:expr, $default:expr] $key:tt $thesis:literal
            $meaning:literal $(only $($law:ident)+)?;)+
    })+) => {
        /// Ids of the parameters.
        pub mod id {
            $($(#[doc = $meaning] pub const $constant: u16 = $id;)+)+
            /// Entry 0; entry i has the id `GAIN_PROFILE + i`.
            pub const GAIN_PROFILE: u16 = 256;
        }

        /// Scalars, in the order of their sections.
        const LINES: &[Parameter] = &[$($(Parameter {
            id: id::$constant,
            name: $name,
            len: 1,
            unit: $unit,
            min: $min,
            max: $max,
            default: $default,
            key: key!($section $name $key),
            meaning: $meaning,
            thesis: $thesis,
        },)+)+];
    };
}

const COUNT_MAX: i32 = i32::MAX;
const GAIN_MAX: i32 = u16::MAX as i32;
const WINDOW_MAX: i32 = crate::estimator::MAX_WINDOW_SAMPLES as i32;
const COMMAND_MAX: i32 = crate::drive::MAX_COUNTS as i32;
const RAW_MAX: i32 = i16::MAX as i32;
const TIME_MAX: i32 = 2_000_000_000;
const SECOND_MS: i32 = 1000;
const HOUR_MS: i32 = 3_600_000;
const CODE_MAX: i32 = crate::drive::MAX_CODE as i32;
/// 1 of a pressure or a force of the law "cascade".
const UNIT: i32 = 1 << 24;
const LENGTH_MAX: i32 = 1 << 24;
const FLOW_MAX: i32 = 1 << 28;
const ACCELERATION_MAX: i32 = 1 << 28;
const DECAY: i32 = 1 << 30;
/// What is lowered to i32::MAX was out of range.
const PULL_MAX: i32 = i32::MAX - 1;
const SPOOL_MAX: i32 = (COMMAND_MAX) << 16;
const LAW_MAX: i32 = Law::ALL.len() as i32 - 1;
const ENCODER_MAX: i32 = EncoderKind::ALL.len() as i32 - 1;

parameter_table!(table);

/// The only list.
const GAIN_PROFILE: Parameter = Parameter {
    id: id::GAIN_PROFILE,
    name: "gain_profile",
    len: PROFILE_LEN as u16,
    unit: "",
    min: 0,
    max: GAIN_MAX,
    default: 256,
    key: Some(RigKey { path: "controller.gain_profile", form: Form::Whole }),
    thesis: "Kp(0)..Kp(255)",
    meaning: "Gain on the error, an entry for each span of error; the last one repeats to 256 entries.",
};

const SCALARS: usize = LINES.len();

/// All parameters, scalars in the order of their ids (id - 1 is the place), then the gain profile.
pub static TABLE: [Parameter; SCALARS + 1] = {
    let mut table = [GAIN_PROFILE; SCALARS + 1];
    let mut line = 0;
    while line < SCALARS {
        table[LINES[line].id as usize - 1] = LINES[line];
        line += 1;
    }
    table
};

/// What a board needs of a line.
#[derive(Clone, Copy)]
struct Range {
    min: i32,
    max: i32,
    default: i32,
}

/// In the order of the table.
static RANGES: [Range; SCALARS + 1] = {
    let mut ranges = [Range { min: 0, max: 0, default: 0 }; SCALARS + 1];
    let mut place = 0;
    while place <= SCALARS {
        let Parameter { min, max, default, .. } = TABLE[place];
        ranges[place] = Range { min, max, default };
        place += 1;
    }
    ranges
};

/// Appendix IX: the first entries of the default gain profile; the rest is 256.
pub const DEFAULT_PROFILE: [u16; 11] = [8192, 6144, 4096, 2048, 1280, 768, 512, 384, 320, 288, 256];

/// Why a value was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetError {
    /// There is no parameter of this id.
    UnknownId,
    /// The value is outside the range in the table.
    OutOfRange,
}

/// The line of the table that an id belongs to.
#[must_use]
pub fn lookup(id: u16) -> Option<&'static Parameter> {
    match place(id) {
        Place::Scalar(index) => TABLE.get(index).filter(|parameter| parameter.id == id),
        Place::Profile(index) => TABLE.last().filter(|profile| index < usize::from(profile.len)),
    }
}

/// The line of an id, for constants.
///
/// # Panics
/// When there is none: the constant is not made then.
#[must_use]
pub const fn line(id: u16) -> Parameter {
    if id == id::GAIN_PROFILE { GAIN_PROFILE } else { TABLE[id as usize - 1] }
}

/// The line of the table with a name.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Parameter> {
    TABLE.iter().find(|p| p.name == name)
}

/// The values of all parameters; each within its range, not yet checked against each other
/// ([`Config::new`](crate::Config::new) does that).
///
/// ```
/// use pneudrive_controller::config::ConfigError;
/// use pneudrive_controller::parameters::{SetError, id, lookup};
/// use pneudrive_controller::{Config, Parameters};
///
/// let mut parameters = Parameters::default();
/// parameters.set(id::PERIOD_US, 1000)?;
/// assert_eq!(lookup(id::PERIOD_US).map(|line| line.unit), Some("us"));
/// assert_eq!(parameters.set(id::PERIOD_US, 0), Err(SetError::OutOfRange));
///
/// // Each value may be in its range and still not go with the others.
/// parameters.set(id::DELAY_US, 1000)?;
/// assert_eq!(Config::new(&parameters), Err(ConfigError::DelayNotBelowPeriod));
/// # Ok::<(), SetError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameters {
    scalars: [i32; SCALARS],
    pub(crate) gain_profile: [u16; PROFILE_LEN],
}

impl Default for Parameters {
    fn default() -> Self {
        let mut scalars = [0; SCALARS];
        for (value, range) in scalars.iter_mut().zip(&RANGES) {
            *value = range.default;
        }
        let mut gain_profile = [256; PROFILE_LEN];
        for (gain, default) in gain_profile.iter_mut().zip(DEFAULT_PROFILE) {
            *gain = default;
        }
        Parameters { scalars, gain_profile }
    }
}

fn range(id: u16) -> Option<&'static Range> {
    match place(id) {
        Place::Scalar(index) => RANGES[..SCALARS].get(index),
        Place::Profile(index) => RANGES.last().filter(|_| index < PROFILE_LEN),
    }
}

/// Where the value of an id stands.
enum Place {
    Scalar(usize),
    Profile(usize),
}

fn place(id: u16) -> Place {
    match id.checked_sub(id::GAIN_PROFILE) {
        Some(entry) => Place::Profile(usize::from(entry)),
        None => Place::Scalar(usize::from(id).wrapping_sub(1)),
    }
}

impl Parameters {
    /// The value of a parameter.
    #[must_use]
    pub fn get(&self, id: u16) -> Option<i32> {
        match place(id) {
            Place::Scalar(index) => self.scalars.get(index).copied(),
            Place::Profile(index) => self.gain_profile.get(index).map(|&gain| i32::from(gain)),
        }
    }

    /// Changes a parameter.
    ///
    /// # Errors
    /// For an unknown id, and for a value outside the range in the table; nothing is changed then.
    pub fn set(&mut self, id: u16, value: i32) -> Result<(), SetError> {
        let range = range(id).ok_or(SetError::UnknownId)?;
        if value < range.min || value > range.max {
            return Err(SetError::OutOfRange);
        }
        match place(id) {
            Place::Scalar(index) => {
                *self.scalars.get_mut(index).ok_or(SetError::UnknownId)? = value;
            }
            Place::Profile(index) => {
                let gain = u16::try_from(value).map_err(|_| SetError::OutOfRange)?;
                *self.gain_profile.get_mut(index).ok_or(SetError::UnknownId)? = gain;
            }
        }
        Ok(())
    }

    /// The position at count 0 of the encoder, if that is absolute.
    #[must_use]
    pub fn absolute_zero(&self) -> Option<i32> {
        let encoder = EncoderKind::of(self.scalar(id::ENCODER_MODEL));
        encoder.is_absolute().then(|| self.scalar(id::ENCODER_ZERO_COUNTS))
    }

    /// The value of a scalar the table holds: 0 for an id that it does not.
    pub(crate) fn scalar(&self, id: u16) -> i32 {
        self.get(id).unwrap_or(0)
    }

    /// All (id, value) pairs in the order of the table: the form in which they are stored.
    pub fn iter(&self) -> impl Iterator<Item = (u16, i32)> + '_ {
        let profile = id::GAIN_PROFILE..id::GAIN_PROFILE + PROFILE_LEN as u16;
        (1..=SCALARS as u16).chain(profile).map(|id| (id, self.scalar(id)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_of_a_scalar_is_its_id_less_one() {
        for (index, parameter) in TABLE[..SCALARS].iter().enumerate() {
            assert_eq!(usize::from(parameter.id), index + 1, "{}", parameter.name);
            assert_eq!(parameter.len, 1);
        }
        assert_eq!(TABLE[SCALARS].id, id::GAIN_PROFILE);
    }

    #[test]
    fn names_are_unique_and_defaults_lie_in_their_ranges() {
        for (index, parameter) in TABLE.iter().enumerate() {
            assert!(TABLE[..index].iter().all(|other| other.name != parameter.name), "{}", parameter.name);
            assert!((parameter.min..=parameter.max).contains(&parameter.default), "{}", parameter.name);
            assert!(parameter.meaning.ends_with('.'), "{}", parameter.name);
        }
    }

    #[test]
    fn a_choice_has_as_many_values_as_words_and_a_key_of_the_same_unit_the_same_name() {
        for parameter in &TABLE {
            let Some(RigKey { path, form }) = parameter.key else { continue };
            match form {
                Form::Words(words) => {
                    assert_eq!((parameter.min, parameter.max), (0, words.len() as i32 - 1), "{path}");
                }
                Form::Whole if ["controller.", "safety."].iter().any(|table| path.starts_with(table)) => {
                    assert_eq!(path.split_once('.').map(|(_, name)| name), Some(parameter.name));
                }
                Form::Whole | Form::Scaled(_) => {}
            }
        }
    }

    #[test]
    fn a_name_leads_to_its_line_and_no_name_to_none() {
        for parameter in &TABLE {
            assert_eq!(by_name(parameter.name).map(|found| found.id), Some(parameter.id));
        }
        assert!(by_name("velocity").is_none());
    }

    #[test]
    fn every_parameter_takes_the_ends_of_its_range_and_nothing_beyond() {
        for parameter in &TABLE {
            for id in [parameter.id, parameter.id + parameter.len - 1] {
                let mut values = Parameters::default();
                for value in [parameter.min, parameter.max] {
                    assert_eq!(values.set(id, value), Ok(()), "{}", parameter.name);
                    assert_eq!(values.get(id), Some(value), "{}", parameter.name);
                }
                for beyond in
                    [parameter.min.checked_sub(1), parameter.max.checked_add(1)].into_iter().flatten()
                {
                    assert_eq!(values.set(id, beyond), Err(SetError::OutOfRange), "{}", parameter.name);
                }
                assert_eq!(values.get(id), Some(parameter.max), "a refused value changes nothing");
            }
        }
    }

    #[test]
    fn ids_that_are_not_in_the_table_are_unknown() {
        for id in [0, SCALARS as u16 + 1, 255, 512, u16::MAX] {
            assert_eq!(lookup(id), None);
            assert_eq!(Parameters::default().get(id), None);
            assert_eq!(Parameters::default().set(id, 1), Err(SetError::UnknownId));
        }
    }

    #[test]
    fn the_default_profile_is_that_of_appendix_ix() {
        let values = Parameters::default();
        let first: [i32; 11] = core::array::from_fn(|i| values.scalar(id::GAIN_PROFILE + i as u16));
        assert_eq!(first, [8192, 6144, 4096, 2048, 1280, 768, 512, 384, 320, 288, 256]);
        assert_eq!(values.get(id::GAIN_PROFILE + 255), Some(256));
    }

    #[test]
    fn pairs_come_in_the_order_of_the_table_and_make_the_same_values_again() {
        let mut changed = Parameters::default();
        changed.set(id::VELOCITY_GAIN, 1000).expect("in range");
        changed.set(id::GAIN_PROFILE + 7, 99).expect("in range");
        let mut copy = Parameters::default();
        for (id, value) in changed.iter() {
            copy.set(id, value).expect("a value it had");
        }
        assert_eq!(copy, changed);
        assert_eq!(changed.iter().count(), SCALARS + PROFILE_LEN);
    }
}
