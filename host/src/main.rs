//! The `pneudrive` command.

#![deny(clippy::print_stdout, clippy::print_stderr)]

use std::process::ExitCode;

fn main() -> ExitCode {
    pneudrive::command::main().into()
}
