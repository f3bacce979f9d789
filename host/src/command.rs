//! The subcommands, one thin file each.

mod characterise;
mod demo;
mod device;
mod eval;
mod identify;
mod interrupts;
mod ladder;
mod long_work;
mod merge;
mod monitor;
mod overlay;
pub mod record;
mod replay;
mod rig;
mod run;
mod simulate;
mod spectrum;
mod streaming;
mod study;
mod sweep;
mod thesis;
mod tune;
mod virtual_rig;

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::time::Duration;

use anyhow::{Context, Result, bail};
use clap::{Arg, CommandFactory, FromArgMatches};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use pneudrive_sim::rig::{BUILTIN, builtin};
use pneudrive_sim::{Accuracy, Method, Rig};

use crate::cli::{Cli, Command, Integration, MethodName, RigChoice};
use crate::client::{Client, RigParameters};
use crate::exit::Exit;
use crate::output::{self, Stream};
use crate::parameter_names::names_of;
use crate::words;

/// The program: reads the command line, does what it asks for, tells what went wrong.
#[must_use]
pub fn main() -> Exit {
    let _ = hear_of_limits();
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

/// Name for messages and text of a built-in rig or a rig file.
fn rig_text(rig: &str) -> Result<(String, String)> {
    if let Some(text) = builtin(rig) {
        return Ok((rig.to_owned(), text.to_owned()));
    }
    let path = Path::new(rig);
    if !path.exists() {
        let names: Vec<&str> = BUILTIN.iter().map(|(name, _)| *name).collect();
        return Err(Exit::NotThere.error(format!(
            "there is no rig file {rig}, and no built-in rig of that name (built in: {})",
            names.join(", ")
        )));
    }
    let text = text_of(path).with_context(|| format!("cannot read {rig}"))?;
    Ok((rig.to_owned(), text))
}

/// Bytes: no rig file has more.
const LONGEST_RIG: u64 = 1 << 20;

/// The text of a file, or of a pipe, as far as a rig may go.
fn text_of(path: &Path) -> Result<String> {
    let mut text = String::new();
    File::open(path)?.take(LONGEST_RIG + 1).read_to_string(&mut text)?;
    if text.len() as u64 > LONGEST_RIG {
        bail!("it is longer than {LONGEST_RIG} bytes, and no rig file");
    }
    Ok(text)
}

/// A rig with its settings applied.
fn load_rig(rig: &str, settings: &[String]) -> Result<Rig> {
    let (source, text) = rig_text(rig)?;
    Ok(Rig::read_with(&source, &text, settings)?)
}

fn load_choice(choice: &RigChoice) -> Result<Rig> {
    load_rig(&choice.rig, &choice.settings)
}

fn accuracy(integration: &Integration, rig: &Rig) -> Accuracy {
    let method = match integration.method {
        MethodName::DormandPrince => Method::DormandPrince,
        MethodName::Merson => Method::Merson,
    };
    Accuracy { method, tolerance: integration.tolerance.unwrap_or(Accuracy::of(rig).tolerance) }
}

/// Names for a message: the first few of many.
fn few(names: &[&str]) -> String {
    match names {
        [first, second, third, _, more @ ..] => {
            format!("{first}, {second}, {third} and {} more", more.len() + 1)
        }
        names => names.join(", "),
    }
}

/// Says so where a rig does not tell its boots apart, before it is armed or moved.
fn tell_of_boots(client: &Client) {
    if !client.names_its_boot() {
        tell!("note: {}", words::no_boots(client.speaks(6)));
    }
}

/// Says which parameters the rig's firmware does not have.
fn tell_lacking(parameters: &RigParameters) {
    let names = names_of(&parameters.lacking_names());
    if !names.is_empty() {
        tell!(
            "note: the rig's firmware is older than this program; it has no {}, and does as with their defaults",
            few(&names)
        );
    }
}

/// A bar on a terminal; elsewhere a line now and then.
struct Progress {
    bar: ProgressBar,
    what: String,
    /// What is counted.
    of: &'static str,
    said: u64,
}

impl Progress {
    fn new(what: &str) -> Progress {
        Progress::of(what, "samples")
    }

    /// Of something else than samples.
    fn of(what: &str, of: &'static str) -> Progress {
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr_with_hz(10));
        let style = ProgressStyle::with_template("{msg:<12} [{bar:40}] {pos}/{len} ({per_sec}, {eta} left)");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(what.to_owned());
        bar.enable_steady_tick(Duration::from_millis(200));
        Progress { bar, what: what.to_owned(), of, said: 0 }
    }

    /// Of samples whose end nobody knows.
    fn endless(what: &str, advice: &str) -> Progress {
        let progress = Progress::new(what);
        let style = ProgressStyle::with_template(&format!(
            "{{msg:<12}} {{spinner}} {{human_pos}} samples in {{elapsed}} ({advice})"
        ));
        progress.bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        if progress.bar.is_hidden() {
            tell!("{what}: {advice}");
        }
        Progress { said: u64::MAX, ..progress }
    }

    /// What was done before does not count for the rate.
    fn begin_at(&mut self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done);
        self.bar.reset_eta();
        self.said = (4 * done).checked_div(all).unwrap_or(0);
    }

    fn at(&mut self, done: u64, all: u64) {
        self.bar.set_length(all);
        self.bar.set_position(done.min(all));
        let quarter = (4 * done.min(all)).checked_div(all).unwrap_or(0);
        if self.bar.is_hidden() && quarter > self.said {
            self.said = quarter;
            tell!("{}: {done} of {all} {}", self.what, self.of);
        }
    }

    /// Does something that may write to the terminal, too.
    fn aside<T>(&self, act: impl FnOnce() -> T) -> T {
        self.bar.suspend(act)
    }

    fn done(self) {
        self.bar.finish_and_clear();
    }
}
