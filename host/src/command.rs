//! The subcommands, one thin file each.

mod characterise;
mod commission;
mod demo;
mod device;
mod eval;
mod export;
mod figures;
mod fmu;
mod identify;
mod import;
mod interrupts;
mod ladder;
mod long_work;
mod merge;
mod monitor;
mod overlay;
mod progress;
mod record;
mod reference;
mod replay;
mod rig;
mod rig_source;
mod run;
mod shell;
mod simulate;
mod spectrum;
mod studio;
mod study;
mod sweep;
mod thesis;
mod threads;
mod tune;
mod virtual_rig;

use anyhow::Result;
use clap::{Arg, CommandFactory, FromArgMatches};

use crate::cli::{Cli, Command};
use crate::exit::Exit;
use crate::json;
use crate::output::{self, Stream};

/// The program: parses the command line, runs the subcommand, and reports its error.
#[must_use]
pub fn main() -> Exit {
    let _ = hear_of_limits();
    output::report_notes();
    let parsed = whole_command().try_get_matches().and_then(|matches| {
        json::begin(&matches);
        Cli::from_arg_matches(&matches)
    });
    let cli = match parsed {
        Ok(cli) => cli,
        Err(answer) => {
            let stream = if answer.use_stderr() { Stream::Errors } else { Stream::Output };
            stream.note(answer.print());
            return output::end(if answer.use_stderr() { Exit::Usage } else { Exit::Done });
        }
    };
    output::end(match execute(cli) {
        Ok(()) => {
            json::end(Exit::Done, None);
            Exit::Done
        }
        Err(error) => {
            let (exit, text) = (Exit::after(&error), format!("{error:#}"));
            tell!("error: {text}");
            json::end(exit, Some(&text));
            exit
        }
    })
}

/// The command line with all its subcommands.
#[must_use]
pub fn whole_command() -> clap::Command {
    taking_negative_numbers(json::with_option(Cli::command()))
}

/// Takes a value that begins with a minus as a number: `--tolerance -1` is a value out of range, not an unknown
/// argument `-1`.
fn taking_negative_numbers(command: clap::Command) -> clap::Command {
    let numbers = |argument: Arg| {
        let takes_values = argument.get_action().takes_values();
        argument.allow_negative_numbers(takes_values)
    };
    command.mut_args(numbers).mut_subcommands(taking_negative_numbers)
}

/// Makes a write beyond the file size limit (`ulimit -f`) fail like one on a full disk. The signal that the system also
/// sends would otherwise end the program without a message and leave the drive moving.
#[cfg(unix)]
fn hear_of_limits() -> std::io::Result<()> {
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default()).map(drop)
}

#[cfg(not(unix))]
fn hear_of_limits() -> std::io::Result<()> {
    Ok(())
}

/// Runs the subcommand.
///
/// # Errors
/// When the subcommand fails.
pub fn execute(cli: Cli) -> Result<()> {
    match cli.command {
        Command::Demo(arguments) => demo::execute(&arguments),
        Command::Rig(arguments) => rig::execute(&arguments),
        Command::Simulate(arguments) => simulate::execute(&arguments),
        Command::Studio(arguments) => studio::execute(&arguments),
        Command::Virtual(arguments) => virtual_rig::execute(&arguments),
        Command::Device(arguments) => device::execute(&arguments),
        Command::Run(arguments) => run::execute(&arguments),
        Command::Record(arguments) => record::execute(&arguments),
        Command::Monitor(arguments) => monitor::execute(&arguments),
        Command::Replay(arguments) => replay::execute(&arguments),
        Command::Eval(arguments) => eval::execute(&arguments),
        Command::Overlay(arguments) => overlay::execute(&arguments),
        Command::Commission(arguments) => commission::execute(&arguments),
        Command::Identify(arguments) => identify::execute(&arguments),
        Command::Spectrum(arguments) => spectrum::execute(&arguments),
        Command::Export(arguments) => export::execute(&arguments),
        Command::Import(arguments) => import::execute(&arguments),
        Command::Fmu(arguments) => fmu::execute(&arguments),
        Command::Characterise(arguments) => characterise::execute(&arguments),
        Command::Study(arguments) => study::execute(&arguments),
        Command::Thesis(arguments) => thesis::execute(&arguments),
        Command::Sweep(arguments) => sweep::execute(&arguments),
        Command::Ladder(arguments) => ladder::execute(&arguments),
        Command::Tune(arguments) => tune::execute(&arguments),
        Command::Merge(arguments) => merge::execute(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments, whole_command()),
        Command::Man(arguments) => shell::man(&arguments, whole_command()),
    }
}
