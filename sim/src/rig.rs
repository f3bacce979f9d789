//! A rig: the list of its keys, how they are explained, the values that follow from others, and the constraints
//! between them.
//!
//! The components list their keys. A [`Rig`] that exists is valid: every value is in its range, there is no division
//! by zero, nothing unphysical, and nothing that is not implemented. It returns values in the unit of their key.
//! [`crate::rigfile`] reads one from a file.

mod change;
mod check;
mod explain;
mod lagging;
mod names;
mod parameters;
mod problem;
mod spread;
mod suit;
mod table;
pub mod thesis;
mod used;

pub use explain::{explain, preset_in_words, range_in_words};
pub(crate) use names::{did_you_mean, key_of_stem, unknown_key};
pub use names::{key_of, nearest};
pub use parameters::OF_SEVERAL;
pub use problem::{Problem, Problems};
pub use spread::SpreadError;
pub use table::{all_keys, chooser, find_key};
pub(crate) use table::{preset_value, presets};

pub use crate::component::valve::MAX_DISCHARGE;
pub use crate::key::{Key, Kind, Preset, unit};
pub use crate::random::unit_interval;
pub use crate::values::{Fields, Origin, Rig, Source, Value};

#[cfg(test)]
pub(crate) mod tests;
