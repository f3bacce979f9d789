//! Rig files: one drive and one test, in TOML.
//!
//! The components list their keys. [`Rig::read`] reads a file by these lists and reports every problem with file,
//! line and key. A [`Rig`] that exists is valid: every value is in its range, there is no division by zero, nothing
//! unphysical, and nothing that is not built. It returns values in the unit of their key.

mod builtin;
mod change;
mod check;
mod events;
mod explain;
mod names;
mod origin;
mod parameters;
mod problem;
mod quantity;
mod read;
mod reader;
mod spread;
mod table;
pub mod thesis;
mod toml_file;
mod used;
mod value;

pub use builtin::{BUILTIN, builtin};
pub use explain::{explain, preset_in_words, range_in_words};
pub use names::{key_of, nearest};
pub use parameters::OF_SEVERAL;
pub use problem::{Problem, Problems};
pub use quantity::{Reading, read as read_quantity};
pub use read::{RigFile, value_of_setting};
pub use spread::SpreadError;
pub use table::{all_keys, chooser, find_key};
pub use toml_file::TomlFile;

pub use crate::component::valve::MAX_DISCHARGE;
pub use crate::key::{Key, Kind, Preset, unit};
pub use crate::random::unit_interval;
pub use crate::values::{Fields, Origin, Rig, Source, Value};

#[cfg(test)]
mod tests;
#[cfg(test)]
mod units_tests;
