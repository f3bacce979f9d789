//! Arguments of the command line.

mod choices;
mod commission;
mod design;
mod device;
mod experiments;
mod fmu;
mod link;
mod logs;
mod percent;
mod shell;
mod transients;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use pneudrive_link::port::address;
use pneudrive_rigs::wiring::WiringFault;
use pneudrive_sim::trace::{EXTRAS, Extra};

pub use choices::{EnsembleChoice, Integration, MethodName, Pages, RigChoice};
pub use commission::Commission;
pub use design::NewRig;
pub use device::{BringUp, ConfigAction, Device, DeviceAction, Position, RecordsAction, ValveAction};
pub use experiments::{ALL, Characterise, LIST, Ladder, Merge, Study, Sweep, Thesis, Tune};
pub use fmu::Fmu;
pub use link::{Monitor, PortChoice, Record, Run};
pub use logs::{Export, Import};
pub use shell::{Completions, Man};
pub use transients::{Align, Channel, Eval, Identify, Interval, Overlay, Spectrum, Window};

use crate::{exit, version};
use percent::percent;

/// Servo-pneumatic drives: simulate, run, record, compare.
#[derive(Debug, Parser)]
#[command(version, long_version = version::long(), about, arg_required_else_help = true, after_help = exit::help())]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the whole job without hardware: step test on a virtual rig, record, simulate, overlay
    Demo(Demo),
    /// Make, list, show, check, compare and explain rig files
    #[command(subcommand)]
    Rig(Rig),
    /// Simulate the test of a rig: trace.csv, run.json, report.html
    Simulate(Simulate),
    /// Design a drive in the browser, with sliders that simulate while dragged; with --port, commission a rig
    Studio(Studio),
    /// Serve a virtual rig that behaves like the board on a serial port
    Virtual(Virtual),
    /// Talk to a rig: identity, status, arm, disarm, stop, parameters
    Device(Device),
    /// Download a test to a rig, arm, start and follow it
    Run(Run),
    /// Download the recorded transient to the next free TARGETxx.DAT; resumes an interrupted download
    Record(Record),
    /// Show live values in the terminal
    Monitor(Monitor),
    /// Run recorded inputs through the controller on the PC and compare its outputs, bit for bit
    Replay(Replay),
    /// Show a transient in engineering units: figures of its moves, graphs of its channels
    Eval(Eval),
    /// Plot TARGET files and simulated runs on the same graphs, with their deviations
    Overlay(Overlay),
    /// Commission a drive that is wired, homed and near mid-stroke: tests, fit, the parameters of what was found, and trial moves beside its twin
    ///
    /// The drive gets the parameters of the rig file first and those of the fit in the end; where a step fails or Ctrl-C ends it, those
    /// that it had. It is disabled between the steps.
    Commission(Commission),
    /// Identify parameters of a rig from recorded transients, with their uncertainties
    Identify(Identify),
    /// Show the spectrum of a channel as a graph and a table of its peaks
    Spectrum(Spectrum),
    /// Write a transient for other programs: CSV, MATLAB, MCAP (PlotJuggler, Foxglove), Parquet
    Export(Export),
    /// Turn the log of another recorder, CSV or MCAP, into a TARGET file for overlay, eval, spectrum and identify
    Import(Import),
    /// Write a rig as an FMU for other simulators (co-simulation, FMI 3.0 or 2.0): plant, controller, or both
    Fmu(Fmu),
    /// Run the component tests of the thesis on a rig's valve, operator and tubes
    Characterise(Characterise),
    /// Run the application studies of the thesis, and say where the model agrees with it
    Study(Study),
    /// Reproduce the thesis: its numbers beside those of the model, section by section on one page
    Thesis(Thesis),
    /// Run a rig many times on all cores: keys vary, figures of the moves are collected; resumes after a kill
    Sweep(Sweep),
    /// Join the shards of a sweep
    Merge(Merge),
    /// Compare the models of each component: their cost, and their effect on the transient
    Ladder(Ladder),
    /// Find gains for a rig that hold over a spread of loads, friction and supply
    Tune(Tune),
    /// Print the completions for a shell: commands, options, values
    Completions(Completions),
    /// Write the manual pages
    Man(Man),
}

/// Arguments of `demo`.
#[derive(Debug, Args)]
pub struct Demo {
    /// Folder for TARGETxx.DAT, trace.csv, run.json and report.html
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
    /// The rig
    #[arg(long, default_value = "press")]
    pub rig: String,
    /// Greatest deviation of the virtual rig's true parameters from the rig file's
    #[arg(long, value_name = "PERCENT", default_value = "10%", value_parser = percent)]
    pub spread: f64,
    /// Replace the run in DIR even if it is of another rig
    #[arg(long)]
    pub overwrite: bool,
    /// Seed of the random draw of the virtual rig
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// Subcommands of `rig`.
#[derive(Debug, Subcommand)]
pub enum Rig {
    /// Write a rig file for your own drive from its data sheets
    New(Box<NewRig>),
    /// List the catalogue: cylinders, valves, tubes and sensors, each figure with its source
    Parts {
        /// Show this part in full
        part: Option<String>,
    },
    /// List the built-in rigs
    List,
    /// Print a rig in full, with the source of every value
    Show {
        /// Name of a built-in rig, or a file
        name: String,
        /// Show every value in SI units with its origin: given, computed, typical, unknown or default
        #[arg(long)]
        resolved: bool,
        /// Change a key of the rig first, such as load.mass_kg=2.5; may be repeated
        #[arg(long = "set", value_name = "KEY=VALUE")]
        settings: Vec<String>,
    },
    /// Compare two rigs, key by key
    Diff {
        /// Name of a built-in rig, or a file
        one: String,
        /// The other one
        other: String,
    },
    /// Check a rig file: report errors by file, line and key, and rank the values that nobody has measured by how far they
    /// move the piston
    Check {
        /// The file, or a built-in rig
        file: String,
        /// Only look for errors
        #[arg(long)]
        quick: bool,
    },
    /// Explain a key: unit, range, default, thesis name; or find the key of a number of the thesis
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
    /// Take moves, gains and initial state from a TARGET file or a streamed run, or continue from the end of a run folder
    #[arg(long, value_name = "FILE|RUN")]
    pub from: Option<PathBuf>,
    /// Move through the points of a CSV table with the columns time_s and position_mm, in straight lines; within
    /// test.velocity_mm_s and test.acceleration_mm_s2
    #[arg(long, value_name = "FILE", conflicts_with_all = ["test", "from"])]
    pub points: Option<PathBuf>,
    /// A move has settled within this distance of its setpoint [default: test.tolerance_mm of the rig]
    #[arg(long, value_name = "MM")]
    pub tolerance_mm: Option<f64>,
    /// Folder for trace.csv, run.json and report.html
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Add columns to trace.csv and graphs to the page: names as below, separated by commas, or valve for all of them
    #[arg(long, value_name = "NAMES", value_parser = columns)]
    pub columns: Option<Columns>,
    /// Replace the run in DIR even if it is of another rig
    #[arg(long)]
    pub overwrite: bool,
    /// Skip report.html, which takes longer than most runs
    #[arg(long)]
    pub no_report: bool,
    /// End with exit code 6 if the drive trips, and with 9 if the run has not converged; all files are written as usual
    #[arg(long)]
    pub strict: bool,
    /// How to integrate.
    #[command(flatten)]
    pub integration: Integration,
    /// Its perturbed runs.
    #[command(flatten)]
    pub members: EnsembleChoice,
    /// How its pages are written.
    #[command(flatten)]
    pub pages: Pages,
}

/// Columns of a trace that not every trace has.
#[derive(Clone, Debug, Default)]
pub struct Columns(pub Vec<&'static Extra>);

/// The name that selects all of them.
const OF_VALVE: &str = "valve";

/// The columns of the air inside the valve; those of receiver and law are there anyway.
fn of_valve() -> impl Iterator<Item = &'static Extra> {
    EXTRAS.iter().filter(|extra| extra.is_of_valve())
}

fn columns(text: &str) -> Result<Columns, String> {
    if text == OF_VALVE {
        return Ok(Columns(of_valve().collect()));
    }
    let unknown = |name: &str| format!("there is no column {name}; `pneudrive simulate --help` lists them");
    let of_name = |name: &str| of_valve().find(|extra| extra.name == name);
    let named = text.split(',').map(|name| of_name(name).ok_or_else(|| unknown(name)));
    let mut found: Vec<&'static Extra> = Vec::new();
    for extra in named {
        let extra = extra?;
        if found.iter().any(|other| other.name == extra.name) {
            return Err(format!("{} is named twice", extra.name));
        }
        found.push(extra);
    }
    Ok(Columns(found))
}

/// The columns for the help text.
fn column_list() -> String {
    let line = |extra: &Extra| format!("  {:<28}{}\n", extra.name, extra.help);
    let [of_receiver, of_law]: [String; 2] = [false, true].map(|of_law| {
        let has = |extra: &&Extra| !extra.is_of_valve() && extra.is_of_law() == of_law;
        EXTRAS.iter().filter(has).map(line).collect()
    });
    format!(
        "Columns:\n{}  {OF_VALVE:<28}all of these\n\nWith supply.model = \"receiver\" or \"regulator\" a trace has these anyway:\n{of_receiver}\nand with controller.law = \"cascade\" these:\n{of_law}",
        of_valve().map(line).collect::<String>(),
    )
}

/// Arguments of `studio`.
#[derive(Debug, Args)]
pub struct Studio {
    /// The rig to begin with: a built-in rig (`pneudrive rig list`) or a rig file
    #[arg(value_name = "RIG", default_value = "press")]
    pub rig: String,
    /// Port of a rig to commission: a serial device, pty:PATH or tcp://HOST:PORT
    #[arg(long, value_name = "P")]
    pub port: Option<String>,
    /// Where to serve the page. An address that can be reached from a network needs PNEUDRIVE_TOKEN
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:8787")]
    pub listen: String,
}

/// Arguments of `virtual`.
#[derive(Debug, Args)]
pub struct Virtual {
    /// The rig.
    #[command(flatten)]
    pub rig: RigChoice,
    /// Where to listen: pty, or tcp:HOST:PORT (port 0 for any free port)
    #[arg(long, value_name = "pty|tcp:ADDR", value_parser = listen_address)]
    pub listen: String,
    /// Run tests as fast as possible instead of in real time
    #[arg(long)]
    pub fast: bool,
    /// Keep the plant running between runs: it creeps and settles, and a start does not reset it
    #[arg(long)]
    pub live: bool,
    /// Draw the true parameters within this much of the rig file's, with noise on the sensors
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    pub spread: Option<f64>,
    /// Seed of the random draw of the rig and of the sensor noise of its runs; the same seed repeats both
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Wire something wrongly, to try `device bring-up`: valve-inverted, tubes-swapped, encoder-swapped,
    /// encoder-pull-up, pressures-swapped, pressure-floats, enable-open or watchdog-dead (of the board); may be repeated
    #[arg(long, value_name = "FAULT")]
    pub wiring: Vec<WiringFault>,
    /// Have a hand push the slide out by 20 mm and back whenever the drive has been disabled for 3 s
    #[arg(long)]
    pub hand: bool,
}

/// Where a virtual rig can listen.
fn listen_address(text: &str) -> Result<String, String> {
    match address(text) {
        Some(address) if address.contains(':') => Ok(format!("tcp:{address}")),
        None if text == "pty" => Ok(text.to_owned()),
        _ => Err("write pty or tcp:HOST:PORT, such as tcp:127.0.0.1:4000".to_owned()),
    }
}

/// Arguments of `replay`.
#[derive(Debug, Args)]
pub struct Replay {
    /// A TARGET file recorded with test.decimation=1, or a run streamed with --every 1
    pub file: PathBuf,
    /// The rig that was recorded, for what its law knew: a built-in rig or a rig file, with controller.law = "cascade"
    #[arg(long, value_name = "RIG", requires = "out")]
    pub rig: Option<String>,
    /// Change a key of that rig, such as load.mass_kg=2.5; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "rig")]
    pub settings: Vec<String>,
    /// Write what the law knew at each sample to this table (CSV)
    #[arg(long, value_name = "FILE", requires = "rig")]
    pub out: Option<PathBuf>,
}
