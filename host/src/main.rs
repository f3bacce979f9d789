//! The `pneudrive` command.

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    match pneudrive::command::execute(pneudrive::cli::Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(1)
        }
    }
}
