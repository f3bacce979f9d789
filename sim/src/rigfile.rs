//! Reads rig files: one drive and one test, in TOML.
//!
//! [`Rig::read`] reads a file by the lists of keys in [`crate::rig`], and reports every problem with file, line and key.
//! Numbers may have units of their own (`pressure = "6 bar(g)"`), and values say where they come from. No other module
//! knows what form a file has.

mod builtin;
mod events;
mod origin;
mod quantity;
mod read;
mod reader;
mod syntax;
mod toml_file;
mod value;

pub use builtin::{BUILTIN, builtin};
pub use quantity::{Reading, read as read_quantity};
pub use read::{RigFile, value_of_setting};
pub use toml_file::TomlFile;

#[cfg(doc)]
use crate::values::Rig;

#[cfg(test)]
mod tests;
#[cfg(test)]
mod units_tests;
