//! Arguments of the command line.

mod device;
mod experiments;
mod transients;

use std::num::NonZeroU16;
use std::path::PathBuf;
use std::time::Duration;

pub use device::{ConfigAction, Device, DeviceAction, Place};
pub use experiments::{ALL, Characterise, LIST, Ladder, Merge, Study, Sweep, Thesis, Tune};
pub use transients::{Align, Channel, Eval, Identify, Overlay, Spectrum, Stretch, Window};

use clap::{Args, Parser, Subcommand, ValueEnum};
use pneudrive_sim::trace::{EXTRAS, Extra};
use pneudrive_sim::{Accuracy, Method};

use crate::ensemble::Spacing;
use crate::exit;

/// Servo-pneumatic drives: simulate, run, record, compare.
#[derive(Debug, Parser)]
#[command(version, about, arg_required_else_help = true, after_help = exit::help())]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// The whole job with no hardware: step test on a virtual rig, record, simulate, overlay
    Demo(Demo),
    /// Rig files: list, show, check, explain
    #[command(subcommand)]
    Rig(Rig),
    /// Simulate the test of a rig: trace.csv, run.json, report.html
    Simulate(Simulate),
    /// A virtual rig that behaves like the board on a serial port
    Virtual(Virtual),
    /// Talk to a rig: who and how it is, arm, disarm, stop, parameters
    Device(Device),
    /// Download a test to a rig, arm, start and follow it
    Run(Run),
    /// Pull the recorded transient into the next free TARGETxx.DAT; goes on where it was interrupted
    Record(Record),
    /// Live values in the terminal
    Monitor(Monitor),
    /// Recorded inputs through the controller on the PC; its outputs compared, bit for bit
    Replay(Replay),
    /// A transient in engineering units: its moves in figures, its channels as graphs
    Eval(Eval),
    /// TARGET files and simulated runs on the same graphs, with their deviations
    Overlay(Overlay),
    /// Parameters of a rig from recorded transients, with their uncertainties
    Identify(Identify),
    /// What frequencies a channel holds, as a graph and a table of its peaks
    Spectrum(Spectrum),
    /// The component tests of the thesis on a rig's valve, operator and tubes
    Characterise(Characterise),
    /// The application studies of the thesis: what it says, and what the model shows
    Study(Study),
    /// The thesis, reproduced: its numbers beside those of the model, section by section on one page
    Thesis(Thesis),
    /// Many runs of a rig on all cores: keys vary, figures of the moves are collected; goes on where it was killed
    Sweep(Sweep),
    /// Put the shards of a sweep together
    Merge(Merge),
    /// What each model of a component costs, and what it changes
    Ladder(Ladder),
    /// Find gains for a rig that hold over a spread of loads, friction and supply
    Tune(Tune),
}

/// Which rig, and what to change in it.
#[derive(Debug, Args)]
pub struct RigChoice {
    /// A built-in rig (`pneudrive rig list`) or a rig file
    #[arg(value_name = "RIG")]
    pub rig: String,
    /// Change a key of the rig, such as load.mass_kg=2.5; may be given again
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = setting)]
    pub settings: Vec<String>,
}

/// `key=value` with something on both sides.
fn setting(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => Ok(text.to_owned()),
        _ => Err("write KEY=VALUE, such as load.mass_kg=2.5".to_owned()),
    }
}

/// How a run is integrated.
#[derive(Debug, Args)]
pub struct Integration {
    /// Method of integration
    #[arg(long, value_enum, default_value_t = MethodName::DormandPrince)]
    pub method: MethodName,
    /// Allowed error of a step, relative to what counts as large in each state [default: what the drive needs: 1e-11 in
    /// closed loop, else 1e-9, or 3e-8 with a stepper]
    #[arg(long, value_name = "X", value_parser = tolerance)]
    pub tolerance: Option<f64>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (1e-13..=1e-2).contains(&value) { Ok(value) } else { Err("must be between 1e-13 and 1e-2".to_owned()) }
}

impl Integration {
    /// What the library takes.
    #[must_use]
    pub fn accuracy(&self, rig: &pneudrive_sim::Rig) -> Accuracy {
        let method = match self.method {
            MethodName::DormandPrince => Method::DormandPrince,
            MethodName::Merson => Method::Merson,
        };
        Accuracy { method, tolerance: self.tolerance.unwrap_or(Accuracy::of(rig).tolerance) }
    }
}

/// Names of the methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MethodName {
    /// Dormand-Prince 5(4)
    DormandPrince,
    /// Runge-Kutta-Merson 4(3), as in the thesis
    Merson,
}

/// Arguments of `demo`.
#[derive(Debug, Args)]
pub struct Demo {
    /// Where to leave TARGETxx.DAT, trace.csv, run.json and report.html
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// The rig
    #[arg(long, default_value = "servo-b-tuned")]
    pub rig: String,
    /// How far the virtual rig's true parameters lie from the rig file's at most
    #[arg(long, value_name = "PERCENT", default_value = "10%", value_parser = percent)]
    pub spread: f64,
    /// Replace the run in DIR even if it is of another rig
    #[arg(long)]
    pub overwrite: bool,
    /// Which virtual rig is drawn
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// A fraction from "10%" or "10".
fn percent(text: &str) -> Result<f64, String> {
    let number = text.trim_end_matches('%').trim();
    let value: f64 = number.parse().map_err(|_| format!("{text:?} is not a percentage such as 10%"))?;
    if (0.0..=50.0).contains(&value) {
        Ok(value / 100.0)
    } else {
        Err("must be between 0% and 50%".to_owned())
    }
}

/// Subcommands of `rig`.
#[derive(Debug, Subcommand)]
pub enum Rig {
    /// The built-in rigs
    List,
    /// A rig in full, with the source of every value
    Show {
        /// Name of a built-in rig, or a file
        name: String,
    },
    /// Check a rig file: errors by file, line and key
    Check {
        /// The file, or a built-in rig
        file: String,
    },
    /// What a key means: unit, range, default, thesis name; and which key a number of the thesis has
    Explain {
        /// A key (load.mass_kg or mass_kg), a table (load), a number of the thesis ('C(46)', C46, or C and L for all), or nothing
        /// for all keys
        #[arg(default_value = "")]
        key: String,
    },
}

/// Arguments of `simulate`.
#[derive(Debug, Args)]
#[command(after_help = column_list())]
pub struct Simulate {
    /// The rig.
    #[command(flatten)]
    pub rig: RigChoice,
    /// Take [test] from this rig file instead
    #[arg(long, value_name = "FILE")]
    pub test: Option<String>,
    /// Take moves, gains and initial state from a TARGET file or a streamed run; or go on from the end of a run folder
    #[arg(long, value_name = "FILE|RUN", conflicts_with = "test")]
    pub from: Option<PathBuf>,
    /// Where to leave trace.csv, run.json and report.html
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// More columns of trace.csv and graphs of the page: names as below, with commas between them, or valve for all of them
    #[arg(long, value_name = "NAMES", value_parser = columns)]
    pub columns: Option<Columns>,
    /// Replace the run in DIR even if it is of another rig
    #[arg(long)]
    pub overwrite: bool,
    /// Leave no report.html, which takes longer than most runs
    #[arg(long)]
    pub no_report: bool,
    /// End with exit code 6 if the drive trips, and with 9 if the run is not decided; all files are left as they would be
    #[arg(long)]
    pub strict: bool,
    /// How to integrate.
    #[command(flatten)]
    pub integration: Integration,
    /// Its neighbours.
    #[command(flatten)]
    pub neighbours: Neighbours,
}

/// Columns of a trace that not every trace has.
#[derive(Clone, Debug, Default)]
pub struct Columns(pub Vec<&'static Extra>);

/// Stands for all of them.
const OF_VALVE: &str = "valve";

fn columns(text: &str) -> Result<Columns, String> {
    if text == OF_VALVE {
        return Ok(Columns(EXTRAS.iter().collect()));
    }
    let unknown = |name: &str| format!("there is no column {name}; `pneudrive simulate --help` lists them");
    let named = text.split(',').map(|name| Extra::named(name).ok_or_else(|| unknown(name)));
    let mut found: Vec<&'static Extra> = Vec::new();
    for extra in named {
        let extra = extra?;
        if found.iter().any(|other| other.name == extra.name) {
            return Err(format!("{} is there twice", extra.name));
        }
        found.push(extra);
    }
    Ok(Columns(found))
}

/// The columns for the help text.
fn column_list() -> String {
    let lines = EXTRAS.iter().map(|extra| format!("  {:<24}{}\n", extra.name, extra.help));
    format!("Columns:\n{}  {OF_VALVE:<24}all of these\n", lines.collect::<String>())
}

/// Runs beside the nominal one.
#[derive(Clone, Copy, Debug, Args)]
pub struct Neighbours {
    /// Runs in all: the rig as it is, and neighbours whose mass and starting position differ by next to nothing; figures
    /// are ranges over all of them. 1: the rig as it is alone
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub ensemble: u16,
    /// How far away the neighbours are: relative change of the mass, and of the starting position over the stroke
    #[arg(long, value_name = "X", default_value_t = 1e-5, value_parser = change)]
    pub change: f64,
}

fn change(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (1e-12..=0.1).contains(&value) { Ok(value) } else { Err("must be between 1e-12 and 0.1".to_owned()) }
}

impl Neighbours {
    /// What the library takes.
    #[must_use]
    pub fn spacing(&self) -> Spacing {
        Spacing { runs: usize::from(self.ensemble), relative: self.change }
    }
}

/// Arguments of `virtual`.
#[derive(Debug, Args)]
pub struct Virtual {
    /// The rig.
    #[command(flatten)]
    pub rig: RigChoice,
    /// Where to listen: pty, or tcp:HOST:PORT (port 0 for any free one)
    #[arg(long, value_name = "pty|tcp:ADDR", value_parser = door)]
    pub listen: String,
    /// Run tests as fast as they go instead of in real time
    #[arg(long)]
    pub fast: bool,
    /// Keep the plant alive between runs: it creeps and settles, and a start does not reset it
    #[arg(long)]
    pub live: bool,
    /// Draw the true parameters within this much of the rig file's, with noise on the sensors
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub spread: Option<f64>,
    /// Which rig is drawn, and the sensor noise of its runs: run after run the same for the same seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// Where a virtual rig can listen.
fn door(text: &str) -> Result<String, String> {
    match text.strip_prefix("tcp:") {
        Some(address) if address.trim_start_matches('/').contains(':') => Ok(text.to_owned()),
        None if text == "pty" => Ok(text.to_owned()),
        _ => Err("write pty or tcp:HOST:PORT, such as tcp:127.0.0.1:4000".to_owned()),
    }
}

/// The name of a port, brought into the form that `port::open` takes.
fn port(text: &str) -> Result<String, String> {
    let address = text.strip_prefix("tcp:").map(|address| address.trim_start_matches('/'));
    match address {
        Some(address) => match address.rsplit_once(':') {
            Some((_, number)) if number.parse::<NonZeroU16>().is_ok() => Ok(format!("tcp://{address}")),
            Some((_, number)) => Err(format!("{number:?} is not a port number, 1 to 65535")),
            None => Err("the port number is missing; write tcp://HOST:PORT".to_owned()),
        },
        None if text.is_empty() || text == "pty:" => {
            Err("the name is empty; write pty:PATH or a device".to_owned())
        }
        None => Ok(text.to_owned()),
    }
}

/// The port of a rig.
#[derive(Debug, Args)]
pub struct PortChoice {
    /// A device (/dev/ttyACM0, COM3), pty:PATH or tcp://HOST:PORT
    #[arg(long, short, value_name = "PORT", value_parser = port)]
    pub port: String,
}

/// Arguments of `run`.
#[derive(Debug, Args)]
pub struct Run {
    /// The rig whose [test] to run: a built-in rig or a rig file
    #[arg(value_name = "TEST")]
    pub rig: String,
    /// The port.
    #[command(flatten)]
    pub port: PortChoice,
    /// Change a key of the test, such as test.duration_s=2; may be given again
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub settings: Vec<String>,
    /// Also download the controller's parameters of the rig
    #[arg(long)]
    pub config: bool,
    /// Let the test last this long instead, such as 90s, 20min, 8h or 3d
    #[arg(long = "for", value_name = "TIME", value_parser = lasting, conflicts_with = "until_stopped")]
    pub lasting: Option<Duration>,
    /// Let the test run until Ctrl-C, which disarms the drive
    #[arg(long)]
    pub until_stopped: bool,
    /// Write the run to this file while it is on, however long it is
    #[arg(long, value_name = "FILE")]
    pub stream: Option<PathBuf>,
    /// Every how manyth sample is streamed
    #[arg(long, value_name = "N", default_value_t = 1, requires = "stream", value_parser = clap::value_parser!(u16).range(1..))]
    pub every: u16,
}

/// A time such as 90s, 20min, 8h or 3d.
fn lasting(text: &str) -> Result<Duration, String> {
    let (number, unit) = text.split_at(text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len()));
    let seconds = match unit {
        "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        "d" => 86_400.0,
        _ => return Err("write a number and s, min, h or d, such as 90s or 8h".to_owned()),
    };
    let number: f64 = number.trim().parse().map_err(|_| format!("{number:?} is not a number"))?;
    if number > 0.0 && number * seconds < 1e8 {
        Ok(Duration::from_secs_f64(number * seconds))
    } else {
        Err("must be above 0 and below 3 years".to_owned())
    }
}

/// Arguments of `record`.
#[derive(Debug, Args)]
pub struct Record {
    /// The port.
    #[command(flatten)]
    pub port: PortChoice,
    /// Where to put the file
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub dir: PathBuf,
}

/// Arguments of `monitor`.
#[derive(Debug, Args)]
pub struct Monitor {
    /// The port.
    #[command(flatten)]
    pub port: PortChoice,
    /// Also write the values to this file
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Figures as the rig sends them, in counts and samples, not in mm, kPa and s
    #[arg(long)]
    pub counts: bool,
    /// Seconds from one value to the next
    #[arg(long = "every", value_name = "S", default_value_t = 0.2, value_parser = interval)]
    pub every_s: f64,
    /// End after so many
    #[arg(long, value_name = "N")]
    pub count: Option<u32>,
}

fn interval(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if (0.01..=3600.0).contains(&value) {
        Ok(value)
    } else {
        Err("must be between 0.01 and 3600 seconds".to_owned())
    }
}

/// Arguments of `replay`.
#[derive(Debug, Args)]
pub struct Replay {
    /// A TARGET file that was recorded with test.decimation=1, or a run that was streamed with --every 1
    pub file: PathBuf,
}
