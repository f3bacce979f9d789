//! Texts and tables of numbers as other programs write them.
//!
//! | module | holds |
//! |---|---|
//! | [`text`] | bytes as text: UTF-8 with or without a byte order mark, UTF-16; others are refused by their name |
//! | [`table`] | rows and columns: delimiters, quotes, heads, units, lines before and after the table |
//! | `number` | the decimal sign of a column, from all of its cells |
//! | `instant` | times with a date |
//!
//! A table is read as it was written, or refused with its line, its column, its cell and the remedy. An ambiguous
//! table is refused, too.

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod dialect;
mod instant;
mod number;
pub mod table;
pub mod text;

pub use number::Sign;
pub use table::{Column, Table};

/// Why a file is not a text or not a table: the problem, its place, and the remedy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem(String);

impl Problem {
    pub(crate) fn new(message: impl Into<String>) -> Problem {
        Problem(message.into())
    }
}

impl std::fmt::Display for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Problem {}
