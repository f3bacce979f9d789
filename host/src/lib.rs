//! The `pneudrive` command.
//!
//! | module | holds |
//! |---|---|
//! | [`cli`], [`command`] | arguments, and one thin file a subcommand |
//! | [`mod@output`], [`exit`] | what the program says, and how it ends |
//!
//! What the subcommands do, the crates below it can do for others: `pneudrive_records` reads and writes the files,
//! `pneudrive_link` talks to rigs, `pneudrive_rigs` has rigs that are not there, `pneudrive_analysis` tells what
//! transients mean.

// Whoever prints by these panics when nobody reads it: `say!` and `tell!` do not.
#![deny(clippy::print_stdout, clippy::print_stderr)]

#[macro_use]
pub mod output;

pub mod cli;
pub mod command;
pub mod exit;
