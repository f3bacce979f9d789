//! The subcommands, one thin file each.

mod characterise;
mod demo;
mod device;
mod eval;
mod firmware_notes;
mod identify;
mod interrupts;
mod ladder;
mod long_work;
mod merge;
mod monitor;
mod overlay;
mod progress;
pub mod record;
mod replay;
mod rig;
mod rig_source;
mod run;
mod simulate;
mod spectrum;
mod streaming;
mod study;
mod sweep;
mod thesis;
mod threads;
mod tune;
mod virtual_rig;
mod wording;

use anyhow::Result;
use clap::{Arg, CommandFactory, FromArgMatches};

use crate::cli::{Cli, Command};
use crate::exit::Exit;
use crate::output::{self, Stream};

/// The program: reads the command line, does what it asks for, tells what went wrong.
#[must_use]
pub fn main() -> Exit {
    let _ = hear_of_limits();
    output::report_notes();
    let parsed = taking_negative_numbers(Cli::command())
        .try_get_matches()
        .and_then(|matches| Cli::from_arg_matches(&matches));
    let cli = match parsed {
        Ok(cli) => cli,
        Err(answer) => {
            let stream = if answer.use_stderr() { Stream::Errors } else { Stream::Output };
            stream.note(answer.print());
            return output::end(if answer.use_stderr() { Exit::Usage } else { Exit::Done });
        }
    };
    output::end(match execute(cli) {
        Ok(()) => Exit::Done,
        Err(error) => {
            tell!("error: {error:#}");
            Exit::after(&error)
        }
    })
}

/// A value that begins with a minus is a number, and judged as one: `--tolerance -1` is no unknown argument `-1`.
fn taking_negative_numbers(command: clap::Command) -> clap::Command {
    let numbers = |argument: Arg| {
        let takes_values = argument.get_action().takes_values();
        argument.allow_negative_numbers(takes_values)
    };
    command.mut_args(numbers).mut_subcommands(taking_negative_numbers)
}

/// Has a file that reaches the limit of its size (`ulimit -f`) fail as one on a full disk does. The signal that the
/// system sends as well would end the program with no word, and leave a drive that moves.
#[cfg(unix)]
fn hear_of_limits() -> std::io::Result<()> {
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default()).map(drop)
}

#[cfg(not(unix))]
fn hear_of_limits() -> std::io::Result<()> {
    Ok(())
}

/// Does what the command line asks for.
///
/// # Errors
/// When the rig or the data says no.
pub fn execute(cli: Cli) -> Result<()> {
    match cli.command {
        Command::Demo(arguments) => demo::execute(&arguments),
        Command::Rig(arguments) => rig::execute(&arguments),
        Command::Simulate(arguments) => simulate::execute(&arguments),
        Command::Virtual(arguments) => virtual_rig::execute(&arguments),
        Command::Device(arguments) => device::execute(&arguments),
        Command::Run(arguments) => run::execute(&arguments),
        Command::Record(arguments) => record::execute(&arguments),
        Command::Monitor(arguments) => monitor::execute(&arguments),
        Command::Replay(arguments) => replay::execute(&arguments),
        Command::Eval(arguments) => eval::execute(&arguments),
        Command::Overlay(arguments) => overlay::execute(&arguments),
        Command::Identify(arguments) => identify::execute(&arguments),
        Command::Spectrum(arguments) => spectrum::execute(&arguments),
        Command::Characterise(arguments) => characterise::execute(&arguments),
        Command::Study(arguments) => study::execute(&arguments),
        Command::Thesis(arguments) => thesis::execute(&arguments),
        Command::Sweep(arguments) => sweep::execute(&arguments),
        Command::Ladder(arguments) => ladder::execute(&arguments),
        Command::Tune(arguments) => tune::execute(&arguments),
        Command::Merge(arguments) => merge::execute(&arguments),
    }
}
