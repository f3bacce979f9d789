//! The `pneudrive` command.
//!
//! | module | holds |
//! |---|---|
//! | [`cli`], [`command`] | arguments, and one thin file a subcommand |
//! | [`mod@output`], [`json`], [`exit`], `version` | the program's output, as text and as JSON, its end, and what it understands |
//!
//! The work is done by crates that other programs can use, too: `pneudrive_records` reads and writes the files,
//! `pneudrive_link` talks to rigs, `pneudrive_rigs` simulates rigs, `pneudrive_evaluate` says what transients tell.

// The standard macros panic when nobody reads the output; `say!` and `tell!` do not.
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[macro_use]
pub mod output;

pub mod cli;
pub mod command;
pub mod exit;
pub mod json;
mod version;
