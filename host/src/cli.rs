//! Arguments of the command line.

mod choices;
mod device;
mod experiments;
mod link;
mod percent;
mod transients;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use pneudrive_sim::trace::{EXTRAS, Extra};

pub use choices::{Integration, MethodName, Neighbours, RigChoice};
pub use device::{ConfigAction, Device, DeviceAction, Place, ValveAction};
pub use experiments::{ALL, Characterise, LIST, Ladder, Merge, Study, Sweep, Thesis, Tune};
pub use link::{Monitor, PortChoice, Record, Run};
pub use transients::{Align, Channel, Eval, Identify, Overlay, Spectrum, Stretch, Window};

use crate::exit;
use percent::percent;

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

/// Arguments of `replay`.
#[derive(Debug, Args)]
pub struct Replay {
    /// A TARGET file that was recorded with test.decimation=1, or a run that was streamed with --every 1
    pub file: PathBuf,
}
